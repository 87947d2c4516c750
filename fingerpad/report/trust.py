"""Whether to rely on a run: one finding for each thing that can be wrong."""

import math
from collections.abc import Iterator
from typing import NamedTuple

from fingerpad.accuracy.richardson import FEW_FACETS
from fingerpad.reduced.cylinder_errors import in_words
from fingerpad.report.page import BAD, CARE, GOOD
from fingerpad.results.headline import why_not_known
from fingerpad.results.quantities import BAND
from fingerpad.results.result import Result
from fingerpad.results.states import called
from variational.state import ContactState

_SMALL, _LARGE = 0.02, 0.1
"""Relative errors below which an error is small, and above which the mesh is too coarse for more than a trend."""

_NO_ERROR = "The run did not estimate the error of its mesh. It is not in any ±."


class Finding(NamedTuple):
    """One thing that was looked at."""

    what: str
    verdict: str
    """One of :data:`GOOD`, :data:`CARE` and :data:`BAD`."""
    words: str


def findings(result: Result) -> list[Finding]:
    """Return what was looked at, in the order in which a reader needs it."""
    found = [_end(result), *_full_slip(result), *_not_known(result)]
    if not result.follows_path:
        words = f"The model is {result.model!r}, a cheaper one; {in_words(result.record.get('model_error', {}))}."
        return [*found, Finding("model", CARE, words), *_cautions(result)]
    for examined in (_cautions, _mesh, _over_time, _balance, _stability, _jumps, _restarts):
        found += examined(result)
    return found


def verdict(found: list[Finding]) -> tuple[str, str]:
    """Return the worst verdict and a sentence for the head of a page.

    Args:
        found: what was looked at.
    """
    bad, care = ([each for each in found if each.verdict == kind] for kind in (BAD, CARE))
    for kind, worst, first in ((BAD, bad, "Do not use these numbers as they are"), (CARE, care, "Use with care")):
        if worst:
            return kind, f"{first}: {' and '.join(dict.fromkeys(each.what for each in worst))}. {worst[0].words}"
    holds = "All that was examined holds: the equations are solved."
    return GOOD, f"{holds} What the finger and the model assume is not in it."


def _cautions(result: Result) -> Iterator[Finding]:
    for text in map(str, result.cautions):
        key = {".", "_"} & set(text.split(" ", 1)[0])  # a key of the scene begins the sentence, spelled as it is
        yield Finding("limit of validity", CARE, f"{text[0] if key else text[0].upper()}{text[1:].removesuffix('.')}.")


def _end(result: Result) -> Finding:
    if result.failure:
        words = result.failure[0].upper() + result.failure[1:] + "." if result.interrupted else result.failure
        return Finding("the run did not finish", BAD, words)
    return Finding("end of the run", GOOD, "Every load was reached.")


def _full_slip(result: Result) -> Iterator[Finding]:
    if result.full_slip is not None and result.follows_path:
        words = "Every point in contact slips one way, and the forces stayed the same over a further 0.2 mm."
        yield Finding("full slip", GOOD, words)
    elif how := result.missing_slip:
        words = f"Full slip was {how}, so there is no friction of full slip."
        yield Finding("full slip was not reached", BAD if result.failure else CARE, words)
    for load in result.loads:
        if load.full_slip_part == 0 and load.rubs(result.record.get("force_error") or 0.0):
            yield Finding("no full slip under a waveform", CARE, f"In the load {load.name} {load.sticking}.")


def _not_known(result: Result) -> Iterator[Finding]:
    if why := why_not_known(result.record.get(BAND, {})):
        yield Finding("friction is not known", BAD, f"{why[0].upper()}{why[1:]}.")


def _mesh(result: Result) -> Iterator[Finding]:
    """Judge the errors of friction and contact length, and tell the larger one."""
    state = result.full_slip or result.charged
    if state is None:
        return
    shares = _shares(result, state)
    if any(math.isnan(share) for share in shares.values()):
        yield Finding("errors are not estimated", CARE, _NO_ERROR)
        return
    yield from _facets(result, state)
    name = max(shares, key=lambda each: shares[each])
    share = shares[name]
    yield _of_share(share, f"The error of {name} by mesh and penalty is {100 * share:.2g} % of its value.")


def _over_time(result: Result) -> Iterator[Finding]:
    """Judge the error of friction over time, where it is estimated."""
    over_time = (result.record.get("accuracy") or {}).get("over_time", {})
    if "f_t" in over_time:
        share = over_time["f_t"]["error"]
        error = f"{100 * share:.2g} % of its largest value"
        words = f"The estimated discretisation error of friction over time is at most {error}."
        yield _of_share(share, words, " over time")


def _of_share(share: float, words: str, when: str = "") -> Finding:
    """Return the finding on a relative error, whose sentence is given."""
    if share <= _SMALL:
        return Finding(f"mesh{when}", GOOD, words)
    more = "good for trends" if share <= _LARGE else "too coarse for more than a trend"
    return Finding(f"the mesh is coarse{when}", CARE, f"{words} The mesh is {more}; a smaller mesh.contact reduces it.")


def _shares(result: Result, state: ContactState) -> dict[str, float]:
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


def _facets(result: Result, state: ContactState) -> Iterator[Finding]:
    """Find contacts of few facets, on which the effect of the penalty's springs is not resolved."""
    springs = result.scene.contact.law.over_stiffer_screen() is not None
    if not (springs and state.ridges_in_contact and state.mesh_contact):
        return
    facets = state.contact_length / state.ridges_in_contact / state.mesh_contact
    if facets < FEW_FACETS:
        words = f"A ridge touches with {facets:.1f} facets in the mean, fewer than {FEW_FACETS}."
        more = "What a rigid screen would change is not reliable there; a smaller mesh.contact resolves it."
        yield Finding("contacts of few facets", CARE, f"{words} {more}")


def _balance(result: Result) -> Iterator[Finding]:
    state, floor = result.full_slip or result.charged or result.uncharged, result.record.get("force_error")
    if state is None or math.isnan(state.f_contact):
        return
    left = state.f_contact - state.f_attraction - state.f_ext
    words = f"Contact force less attraction less external force leaves {left:.1g} N/m of {state.f_ext:.4g} N/m."
    if floor is None:
        yield Finding("balance of forces", GOOD if abs(left) < 1e-3 * abs(state.f_ext) else BAD, words)
        return
    words += f" The solver's tolerance allows {floor:.1g} N/m."
    holds = abs(left) <= floor
    yield Finding("balance of forces" if holds else "forces do not balance", GOOD if holds else BAD, words)


def _stability(result: Result) -> Iterator[Finding]:
    known = {name: state.stable for name, state in result.named.items() if state.stable is not None}
    if not known:
        yield Finding("stability is not examined", CARE, "A finger would leave an unstable state by itself.")
        return
    words_of = {name: called(name, result.named[name].voltage) for name in known}
    of = "" if result.finger is None or result.steps else " of the middle section, under its force or a tenth more"
    unstable = [words_of[name] for name, stable in known.items() if not stable]
    if unstable:
        words = f"Unstable: {', '.join(unstable)}{of}. A finger would leave such a state by itself."
        yield Finding("a state is unstable", BAD, words)
    else:
        words = f"Examined and stable: {', '.join(words_of.values())}{of}. A small disturbance dies out."
        yield Finding("stability", GOOD, words)


def _jumps(result: Result) -> Iterator[Finding]:
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


def _restarts(result: Result) -> Iterator[Finding]:
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
