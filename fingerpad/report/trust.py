"""The headline of the report of a run, and whether to rely on it: one finding for each thing that can be wrong."""

import math
from collections.abc import Iterator
from typing import TYPE_CHECKING, NamedTuple

from fingerpad.reduced.cylinder_errors import in_words
from fingerpad.reduced.registry import follows_path
from fingerpad.report import page as html
from fingerpad.report.known import bars
from fingerpad.report.page import BAD, CARE, GOOD
from fingerpad.results.closures import KNOWN, known_in_words
from fingerpad.results.quantities import cell
from fingerpad.results.states import LoadResult, called
from fingerpad.scene.remarks import coefficient
from variational.state import ContactState

if TYPE_CHECKING:
    from fingerpad.results.result import Result

_SMALL, _LARGE = 0.02, 0.1
"""Relative errors below which an error is small, and above which the mesh is too coarse for more than a trend."""

_MIN_FACETS = 4
"""Facets in contact on a ridge below which the effect of a rigid screen is doubtful: at two or three,
a few Gauss points bear the contact, and their number changes with the stiffness."""


class Finding(NamedTuple):
    """One thing that was looked at."""

    what: str
    verdict: str
    """One of :data:`GOOD`, :data:`CARE` and :data:`BAD`."""
    words: str


def findings(result: "Result") -> list[Finding]:
    """Return what was looked at, in the order in which a reader needs it."""
    found = [_end(result)]
    found += _full_slip(result)
    if not follows_path(result.model):
        words = f"The model is {result.model!r}, a cheaper one; {in_words(result.record.get('model_error', {}))}."
        return [*found, Finding("model", CARE, words), *_cautions(result)]
    for examined in (_cautions, _mesh, _balance, _stability, _jumps, _restarts):
        found += examined(result)
    return found


def verdict(found: list[Finding], error: str = "", band: str = "") -> tuple[str, str]:
    """Return the worst verdict and a sentence for the head of a page, and a second one where friction has a band.

    Args:
        found: what was looked at.
        error: estimated discretisation error of the number in the head, with its unit; empty where it has none.
        band: how far friction is known, in words; empty where that is not known.
    """
    more = f" {band[0].upper()}{band[1:]}." if band else ""
    bad, care = ([each for each in found if each.verdict == kind] for kind in (BAD, CARE))
    for kind, worst, first in ((BAD, bad, "Do not use these numbers as they are"), (CARE, care, "Use with care")):
        if worst:
            return kind, f"{first}: {' and '.join(each.what for each in worst)}. {worst[0].words}{more}"
    solved = f"solved to ± {error}, the error of the mesh alone" if error else "solved"
    return GOOD, f"All that was examined holds: {solved}; what the finger and the model assume is not in it.{more}"


def _cautions(result: "Result") -> Iterator[Finding]:
    for text in result.cautions:
        yield Finding("limit of validity", CARE, f"{text[0].upper()}{text[1:].removesuffix('.')}.")


def _end(result: "Result") -> Finding:
    if result.failure:
        words = result.failure[0].upper() + result.failure[1:] + "." if result.interrupted else result.failure
        return Finding("the run did not finish", BAD, words)
    return Finding("end of the run", GOOD, "Every load was reached.")


def _full_slip(result: "Result") -> Iterator[Finding]:
    if result.full_slip is not None and follows_path(result.model):
        words = "Every point in contact slips one way, and the forces stayed the same over a further 0.2 mm."
        yield Finding("full slip", GOOD, words)
    elif result.full_slip is None and any(load.until_full_slip or load.moves for load in result.scene.loads()):
        reached = any(load.full_slip_reached for load in result.loads)
        how = "not held over a further 0.2 mm" if reached else "not reached"
        words = f"Full slip was {how}, so there is no friction of full slip."
        yield Finding("full slip was not reached", BAD if result.failure else CARE, words)
    for load in result.loads:
        if load.full_slip_part == 0 and load.rubs(result.record.get("force_error") or 0.0):
            yield Finding("no full slip under a waveform", CARE, f"In the load {load.name} {load.sticking}.")


def _mesh(result: "Result") -> Iterator[Finding]:
    """Judge the errors of friction and contact length, and tell the larger one."""
    state = result.full_slip or result.charged
    if state is None:
        return
    shares = _shares(result, state)
    if any(math.isnan(share) for share in shares.values()):
        yield Finding("errors are not estimated", CARE, "This run has no estimate of its discretisation error.")
        return
    yield from _facets(result, state)
    name = max(shares, key=lambda each: shares[each])
    share = shares[name]
    words = f"The estimated discretisation error of {name} is {100 * share:.2g} % of its value."
    if share <= _SMALL:
        yield Finding("mesh", GOOD, words)
    else:
        more = "good for trends" if share <= _LARGE else "too coarse for more than a trend"
        yield Finding("the mesh is coarse", CARE, f"{words} The mesh is {more}; a smaller mesh.contact reduces it.")


def _shares(result: "Result", state: ContactState) -> dict[str, float]:
    """Return the relative errors of friction and contact length by name; NaN of one that is not estimated.

    A friction whose error is below the roundoff of the forces does not depend on the mesh, and is left out.
    """
    found = {"the contact length": _share(state.error.contact_length, state.contact_length)}
    if result.full_slip:
        error, value, name = state.error.mu_app * abs(state.f_ext), state.mu_app * abs(state.f_ext), "µ_app"
        if math.isnan(state.mu_app):
            error, value, name = state.error.f_t, state.f_t, "f_T"
        if not error <= result.record.get("force_error", 0.0):
            found[name] = _share(error, value)
    return found


def _share(error: float, value: float) -> float:
    return error / abs(value) if value else math.nan


def _facets(result: "Result", state: ContactState) -> Iterator[Finding]:
    """Find contacts of few facets, on which the effect of the penalty's springs is not resolved."""
    springs = result.scene.contact.law.over_stiffer_screen() is not None
    if not (springs and state.ridges_in_contact and state.mesh_contact):
        return
    facets = state.contact_length / state.ridges_in_contact / state.mesh_contact
    if facets < _MIN_FACETS:
        words = f"A ridge touches with {facets:.1f} facets in the mean, fewer than {_MIN_FACETS}."
        more = "What a rigid screen would change is not reliable there; a smaller mesh.contact resolves it."
        yield Finding("contacts of few facets", CARE, f"{words} {more}")


def _balance(result: "Result") -> Iterator[Finding]:
    state, floor = result.full_slip or result.charged or result.uncharged, result.record.get("force_error")
    if state is None or math.isnan(state.f_contact):
        return
    left = state.f_contact - state.f_electrostatic - state.f_ext
    words = f"Contact force less attraction less external force leaves {left:.1g} N/m of {state.f_ext:.4g} N/m."
    if floor is None:
        yield Finding("balance of forces", GOOD if abs(left) < 1e-3 * abs(state.f_ext) else BAD, words)
        return
    words += f" The solver's tolerance allows {floor:.1g} N/m."
    holds = abs(left) <= floor
    yield Finding("balance of forces" if holds else "forces do not balance", GOOD if holds else BAD, words)


def _stability(result: "Result") -> Iterator[Finding]:
    known = {name: state.stable for name, state in result.named.items() if state.stable is not None}
    if not known:
        yield Finding("stability is not examined", CARE, "The stability of the named states was not examined.")
        return
    words_of = {name: called(name, result.named[name].voltage) for name in known}
    unstable = [words_of[name] for name, stable in known.items() if not stable]
    if unstable:
        words = f"Unstable: {', '.join(unstable)}. A finger would leave such a state by itself."
        yield Finding("a state is unstable", BAD, words)
    else:
        words = f"Examined and stable: {', '.join(words_of.values())}. A small disturbance dies out."
        yield Finding("stability", GOOD, words)


def _jumps(result: "Result") -> Iterator[Finding]:
    steps = [state for state in result.steps if jumped(state)]
    if not steps:
        if result.steps:
            yield Finding("jumps", GOOD, "No part of the skin jumped.")
        return
    places = ", ".join(f"{state.step} ({state.load})" for state in steps[:12]) + (" …" if len(steps) > 12 else "")
    energy, error = (
        sum(getattr(state.record, key) for state in steps) for key in ("energy_released", "released_error")
    )
    sure = f"They released {energy:.2g} J/m." if energy > error else f"They released {energy + error:.2g} J/m at most."
    words = f"Skin jumped without the loads in {len(steps)} of {len(result.steps)} steps: {places}. {sure} "
    yield Finding(
        "jumps", GOOD, f"{words}A jump is part of the model, as in stick-slip; states between steps are not known."
    )


def _restarts(result: "Result") -> Iterator[Finding]:
    restarts = result.record.get("restarts") or []
    if restarts:
        why = "; ".join(str(each.get("reason", "")) for each in restarts if isinstance(each, dict))
        again = f"The run started again {len(restarts)} times, with more in its model: {why}."
        words = f"{again} The numbers are of the last run."
        yield Finding("restarts", GOOD, words)
    else:
        yield Finding("restarts", GOOD, "None: no part that was left out turned out to matter.")
    cuts = sum(state.record.cutbacks for state in result.steps if state.record is not None)
    if cuts:
        words = f"{cuts} times a step found no equilibrium and was cut. Each accepted step is in equilibrium."
        yield Finding("cut steps", GOOD, words)


def jumped(state: ContactState) -> bool:
    """Return whether part of the skin jumped in the step of a state."""
    return state.record is not None and state.record.jump


# -- headline --------------------------------------------------------------------------------------------
def conditions(result: "Result") -> str:
    """Return force and voltage of a run in words."""
    if result.whole and result.finger is not None:
        return f"{result.finger.f_ext:.4g} N on the whole finger, {result.scene.volts:.4g} V"
    last = result.full_slip or result.charged or result.last
    if last is None:
        return "a run without a result"
    return f"{last.f_ext:.4g} N/m, {last.voltage:.4g} V"


def head(result: "Result") -> str:
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
    error, band = number.partition(" ± ")[2], result.record.get(KNOWN, {})
    kind, words = verdict(findings(result), error, known_in_words(band))
    more = ' <a href="#trust">What is not in it</a>' if kind == GOOD else ""
    return html.banner("report of a run", result.folder, number, said, kind, html.text(words) + more) + bars(result)


def _timed(result: "Result") -> LoadResult | None:
    """Return the last load with a waveform, where a force presses the finger all the time and it rubs."""
    least = result.record.get("force_error") or 0.0
    waves = {load.name for load in result.scene.loads() if load.wave is not None}
    timed = [load for load in result.loads if load.name in waves and load.over_time is not None]
    timed = [load for load in timed if load.rubs(least)]
    whole = [load for load in timed if not math.isnan(load.over_time.mean["mu_app"])]  # type: ignore[union-attr]
    return whole[-1] if whole else None
