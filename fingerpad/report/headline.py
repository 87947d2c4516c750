"""The headline of the report of a run: the number that was asked for, its conditions, and whether to rely on it."""

import math

from fingerpad.report import page as html
from fingerpad.report import trust
from fingerpad.results.quantities import cell
from fingerpad.results.result import Result
from fingerpad.results.states import LoadResult, called
from fingerpad.scene.remarks import coefficient

MARKS = {trust.GOOD: "✓ holds", trust.CARE: "! care", trust.BAD: "✗ fails"}
"""Verdicts as they are shown."""


def conditions(result: Result) -> str:
    """Return force and voltage of a run in words."""
    if result.whole and result.finger is not None:
        return f"{result.finger.f_ext:.4g} N on the whole finger, {result.scene.voltage:.4g} V"
    last = result.full_slip or result.charged or result.last
    if last is None:
        return "a run without a result"
    return f"{last.f_ext:.4g} N/m, {last.voltage:.4g} V"


def head(result: Result) -> str:
    """Return the finding: the largest number of the page, and whether to rely on it."""
    slip, charged = result.full_slip, result.charged
    whole = result.finger if result.whole else None
    if whole is not None and "full_slip" in whole.states:
        number = f"µ<sub>app</sub> = {html.text(whole.shown('full_slip', 'mu_app'))}"
        force = f"friction force {whole.shown('full_slip', 'f_t')} N"
        said = f"apparent friction coefficient of the whole finger at full slip, {force}; {conditions(result)}"
    elif whole is not None:
        name = list(whole.states)[-1]
        number = f"{html.text(whole.shown(name, 'contact_area'))} mm²"
        said = f"ridge contact area of the whole finger in {whole.heads()[-1]}; {conditions(result)}"
    elif (timed := _timed(result)) is not None:
        ends = timed.extremes["mu_app"]
        number = f"µ<sub>app</sub> from {cell('mu_app', ends.min)} to {cell('mu_app', ends.max)}"
        number += ", without full slip" if timed.full_slip_part == 0 else ""
        said = f"apparent friction coefficient in the load {timed.name}, over time"
        said += f": {timed.sticking}" if timed.sticking else ""
        if slip is not None:
            said += f"; {cell('mu_app', slip.mu_app, slip.error.mu_app)} at full slip, {conditions(result)}"
    elif slip is not None and math.isnan(slip.mu_app):
        number = f"f<sub>T</sub> = {html.text(cell('f_t', slip.f_t, slip.error.f_t))} N/m"
        said = f"friction force at full slip, where no force presses the finger; {conditions(result)}"
    elif slip is not None:
        value = cell("mu_app", slip.mu_app, slip.error.mu_app)
        number = f"µ<sub>app</sub> = {html.text(value)}"
        friction = coefficient(result.scene)
        factor = f", {abs(slip.mu_app) / friction:.2f} times the {friction:.3g} without attraction" if friction else ""
        of = "of the section at the centre of the finger " if result.finger is not None else ""
        said = f"apparent friction coefficient {of}at full slip{factor}; {conditions(result)}"
    elif charged is not None:
        value = cell("contact_length", charged.contact_length, charged.error.contact_length)
        number = f"L<sub>R</sub> = {html.text(value)} mm"
        said = f"contact length in {called('charged', charged.voltage)}; {conditions(result)}"
    else:
        number, said = "No contact state was kept", conditions(result)
    kind, words = trust.verdict(trust.findings(result), number.partition(" ± ")[2])
    more = ' <a href="#trust">What is not in it</a>' if kind == trust.GOOD else ""
    where = "" if result.folder is None else f" · {html.text(result.folder.resolve().name)}"
    return (
        f'<header><p class="kind">fingerpad · report of a run{where}</p><h1>{number}</h1>'
        f'<p class="said">{html.text(said)}</p>'
        f'<p class="verdict {kind}"><b>{MARKS[kind]}</b> {html.text(words)}{more}</p></header>'
    )


def _timed(result: Result) -> LoadResult | None:
    """Return the last load with a waveform, where a force presses the finger all the time and it rubs."""
    least = result.record.get("force_error") or 0.0
    waves = {load.name for load in result.scene.loads() if load.wave is not None}
    timed = [load for load in result.loads if load.name in waves and load.over_time is not None]
    timed = [load for load in timed if load.rubs(least)]
    whole = [load for load in timed if not math.isnan(load.over_time.mean["mu_app"])]  # type: ignore[union-attr]
    return whole[-1] if whole else None
