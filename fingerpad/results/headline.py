r"""The headline of a result: a sentence, one number with the error of its solution, and what the number is of.

The friction coefficient of a result is that of the whole finger wherever slices can be summed over it, with or without
a force in newtons. The section at the centre, in plane strain and per metre of finger, is called the *middle section*.
It is the headline where there is no sum: of a history, of a finger from a file, and where a note has the reason.

Without attraction, friction at full slip is :math:`\mu_0 F` by Coulomb's law, whatever the finger. Under another law
it would be a result of its own, so that the sentence has the friction force alone.

Where the result's own closure has no number (:mod:`fingerpad.reduced.closure_band`), the headline has none either.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

from fingerpad.results.data import ResultData
from fingerpad.results.quantities import BAND, FINGER, MESH, MODEL, PEOPLE, QUANTITIES, Output
from fingerpad.results.states import LoadResult, called
from fingerpad.scene.fingers import FINGERS
from variational.state import ContactState

if TYPE_CHECKING:
    from fingerpad.slices.finger import WholeFinger

WHOLE, SECTION = "whole finger", "middle section"
"""What a headline is of."""
_DIGITS = (2, 3, 4)  # of the numbers in a sentence: as few as tell them apart
_ROUNDOFF = 1e-9  # by which a number is raised, so that one in the middle of two rounds up on every machine
_NO_FORCE = 1e-9  # N/m or N, below which a force is roundoff
_SAME_FORCE = 0.05  # relative: of two states whose forces differ by more, a change is not that of the voltage
_SMALL = 1e-3  # of the largest number in a sentence, below which another is shown without digits of its own


@dataclass(frozen=True)
class Headline:
    """What a result comes to."""

    sentence: str
    """The finding, a full sentence."""
    of: str
    """:data:`WHOLE` or :data:`SECTION`."""
    quantity: Output
    """Of the number."""
    value: float
    """The number (SI); NaN where it is a range, or where there is none."""
    at: str = ""
    """The state that the number is of, in words."""
    error: float = math.nan
    """Estimated error of the solution (SI); NaN where it is not estimated."""
    parts: tuple[str, ...] = ()
    """What the error is of."""
    ends: tuple[float, float] = (math.nan, math.nan)
    """Least and largest value (SI) over time, where the number is a range."""
    people: str = ""
    """Its likely range over people, a sentence; empty where there is none."""
    closures: str = ""
    """The number by the models of roughness, sentences; empty where there are none."""
    remark: str = ""
    """What a reader must know of the finger's name, a sentence; empty for none."""

    @property
    def symbol(self) -> str:
        """Symbol of the number, such as µ_app."""
        return self.quantity.symbol

    @property
    def number(self) -> str:
        """The number behind its symbol, with its error and its unit; empty without one."""
        unit = f" {self.quantity.unit}" if self.quantity.unit else ""
        if not math.isnan(self.ends[0]):
            low, high = (self.quantity.shown(end) for end in self.ends)
            return f"from {low} to {high}{unit}"
        return "" if math.isnan(self.value) else f"= {self.quantity.shown(self.value, self.error)}{unit}"

    @property
    def solved(self) -> str:
        """How far the number is solved, in words; empty where that is not estimated."""
        error, missing = self.quantity.shown(self.value, self.error).partition(" ± ")[2], ""
        if not math.isnan(self.value) and not any(part.startswith((MESH, MODEL)) for part in self.parts):
            missing = f"{SECTION}, whose error is not estimated"
        if not error and MODEL in self.parts and not math.isnan(self.value):
            return f"solved to an error that is not known here ({MODEL})"
        if not error:
            return "solved to an error that is not estimated" if missing else ""
        return f"solved to ± {error} ({', '.join(self.parts)}{missing and '; not in it: '}{missing})"

    def to_dict(self) -> dict[str, Any]:
        """Return the headline, ready for JSON; SI units."""
        found: dict[str, Any] = {"sentence": self.sentence, "of": self.of, "quantity": self.quantity.name}
        numbers = {"value": self.value, "error": self.error, "min": self.ends[0], "max": self.ends[1]}
        return found | {"state": self.at} | {key: value for key, value in numbers.items() if not math.isnan(value)}

    def __str__(self) -> str:
        """Return the first lines of a printed result: the sentence, the number, and how far it is known."""
        lines = [self.sentence]
        if self.number:
            lines.append(f"  {self.symbol} of the {self.of} {self.number}, {self.at}.")
        lines += [f"  {self.solved[0].upper()}{self.solved[1:]}."] if self.solved else []
        more = (self.people, self.closures, self.remark)
        return "\n".join([*lines, *(f"  {line}" for line in more if line)])


def headline(result: ResultData) -> Headline:
    """Return the headline of a result, with the remark of its finger's name."""
    return replace(_of_result(result), remark=FINGERS[result.scene.finger].remark)


def _of_result(result: ResultData) -> Headline:
    slip, finger = result.full_slip if result.scene.friction != 0 else None, result.finger
    if (load := _timed(result)) is not None:
        return _over_time(load, slip)
    whole = finger is not None and (slip is None or "full_slip" in finger.states)
    found = _of_states(result, finger if whole else None, slip)
    if slip is not None and (why := why_not_known(result.record.get(BAND, {}))):
        sentence = f"Friction {found.at}, is not known: {why}."
        return Headline(sentence, found.of, found.quantity, math.nan, found.at)
    return found


# -- what a number is of ---------------------------------------------------------------------------------------
def _of_states(result: ResultData, finger: "WholeFinger | None", slip: ContactState | None) -> Headline:
    """Return friction at full slip, else the size of the contact in the last named state.

    Args:
        result: of a scene.
        finger: the whole finger; None for the headline of the middle section.
        slip: full slip, where there is friction; None without.
    """
    whole, names = finger is not None, list(result.named if finger is None else finger.states)
    if not names:
        return Headline("No contact state was kept.", SECTION, QUANTITIES["contact_length"], math.nan)
    of, quantities, unit = (WHOLE, FINGER, "N") if whole else (SECTION, QUANTITIES, "N/m")
    slips = "full_slip" in names if whole else slip is not None
    name = "full_slip" if slips else names[-1]

    def value(key: str, state: str = name) -> float:
        return float(getattr(result.named[state], key) if finger is None else finger.values(state)[key])

    f_ext, what = value("f_ext") if finger is None else finger.f_ext, "" if whole else f" of the {SECTION}"
    f_ext = 0.0 if abs(f_ext) < _NO_FORCE else f_ext
    volts, charge = (value("voltage"),) * 2 if finger is None else (result.scene.volts, value("f_electrostatic"))
    load = force = f"{f_ext:.4g} {unit}"
    if whole and not result.whole:
        force = f"{f_ext * (1 + _ROUNDOFF):.2g} {unit}"
    if slips:
        key = "f_t" if math.isnan(value("mu_app")) else "mu_app"
        before, after = _without(result, f_ext), abs(value("f_t"))
        sentence, at = _change(result, force, volts, f"friction force{what}", before, after, unit), "at full slip"
    else:
        section, key = result.named.get(name), "contact_area" if whole else "contact_length"
        if whole and section is not None and not (section.voltage or charge):
            volts = 0.0  # a run can end before its voltage
        scale, attracts = quantities[key].scale, volts and name == "charged" and "uncharged" in names
        attracts = attracts and math.isclose(value("f_ext", "uncharged"), f_ext, rel_tol=_SAME_FORCE)
        before, after = scale * value(key, "uncharged") if attracts else None, scale * value(key)
        size = "ridge contact area" if whole else f"contact length{what}"
        sentence = _stuck(result, f"{force} and {volts:.4g} V") or _change(
            result, force, volts, size, before, after, quantities[key].unit
        )
        at = f"in {called(name, charge)}"
    number, error, parts = result.number(name, key, whole)
    at, models = f"{at}, {load} and {volts:.4g} V", ""
    if slip is not None and key == "mu_app":
        models = band_in_words(result.record.get(BAND, {}), number / slip.mu_app)
    range_over = result.record.get(PEOPLE, {})
    people = people_in_words(range_over) if name == "full_slip" and range_over.get("whole") == whole else ""
    return Headline(sentence, of, quantities[key], number, at, error, parts, people=people, closures=models)


def _over_time(load: LoadResult, slip: ContactState | None) -> Headline:
    """Return the range of the friction coefficient of the middle section in a load over time; at full slip second."""
    ends, force = load.extremes["mu_app"], load.extremes["f_t"]
    low, high = _numbers(force.min, force.max)
    sentence = f"In the load {load.name} the friction force of the {SECTION} goes from {low} to {high} N/m"
    sentence += ", without full slip." if load.full_slip_part == 0 else "."
    at = f"in the load {load.name}, over time"
    at += f": {load.sticking}" if load.sticking else ""
    if slip is not None:
        mu_app = QUANTITIES["mu_app"].shown(slip.mu_app, slip.error.mu_app)
        at += f"; {mu_app} at full slip, {slip.f_ext:.4g} N/m and {slip.voltage:.4g} V"
    return Headline(sentence, SECTION, QUANTITIES["mu_app"], math.nan, at, ends=(ends.min, ends.max))


def _timed(result: ResultData) -> LoadResult | None:
    """Return the last load with a waveform, where a force presses the finger all the time and it rubs."""
    least = result.record.get("force_error") or 0.0
    waves = {load.name for load in result.scene.loads() if load.wave is not None}
    timed = [load for load in result.loads if load.name in waves and load.over_time is not None and load.rubs(least)]
    whole = [load for load in timed if not math.isnan(load.over_time.mean["mu_app"])]  # type: ignore[union-attr]
    return whole[-1] if whole else None


# -- sentences -------------------------------------------------------------------------------------------------
def _without(result: ResultData, force: float) -> float | None:
    """Return the friction force without attraction under a force, in its unit; None where it is not known."""
    mu_0 = result.scene.friction
    return mu_0 * force if isinstance(mu_0, float) and force > 0 else None


def _change(
    result: ResultData, force: str, volts: float, what: str, before: float | None, after: float, unit: str
) -> str:
    """Return a sentence on what a voltage (V) changes; ``before`` is None where it is not known without the voltage."""
    drive = result.scene.drive is not None
    if before is None or not volts:
        under = "under the drive" if drive else f"and {volts:.4g} V"
        (shown,) = _numbers(after)
        return f"At {force} {under} the {what} is {shown} {unit}."
    subject, ending = ("the drive", "s") if drive else (f"{volts:.4g} V", "s" if abs(volts) == 1 else "")
    first, second = _numbers(before, after)
    if first == second:
        return f"At {force}, {subject} leave{ending} the {what} at {first} {unit}."
    verb = "raise" if after > before else "lower"
    return f"At {force}, {subject} {verb}{ending} the {what} from {first} to {second} {unit}."


def _stuck(result: ResultData, load: str) -> str:
    """Return a sentence that full slip is missing; empty where it is not."""
    how = result.missing_slip
    return f"At {load} full slip was {how}, so there is no friction force of sliding." if how else ""


def _numbers(*values: float) -> Sequence[str]:
    """Return numbers with as few digits as tell them apart, all with the same digits after the point.

    Those below a thousandth of the largest do not count for the digits.
    """
    most, found = max(map(abs, values), default=0.0), list[str]()
    least = min((abs(value) for value in values if abs(value) > _SMALL * most), default=1.0)
    for digits in _DIGITS:
        after = max(digits - 1 - math.floor(math.log10(least * (1 + _ROUNDOFF))), 0)
        found = [f"{round(value * (1 + _ROUNDOFF), after) + 0.0:.{after}f}" for value in values]  # no minus before 0
        if len(set(found)) == len(found):
            break
    return found


# -- ranges of friction ----------------------------------------------------------------------------------------
def band_in_words(kept: Mapping[str, Any], ratio: float = 1.0) -> str:
    """Return µ_app by models of roughness in sentences, ``ratio`` times that of the section; empty without one."""
    found = {words: ratio * value for words, value in kept.get("mu_app", {}).items() if value is not None}
    if not found:
        return ""
    low, high = (pick(found, key=lambda words: found[words]) for pick in (min, max))
    lines = [f"By models of rough contact {found[low]:.2f} ({low}) to {found[high]:.2f} ({high})."]
    reasons: dict[str, list[str]] = {}
    for words, why in kept["no_number"].items():
        reasons.setdefault(why, []).append(words)
    lines += [f"No number by {' and '.join(those)}: {why}." for why, those in reasons.items()]
    if high in kept["upper_bounds"]:
        share = 100 * min(kept["upper_bounds"][high], 1.0)
        lines += [f"The largest is an upper bound: attraction balances {share:.0f} % of the pressure in contact."]
    return " ".join(lines)


def people_in_words(kept: Mapping[str, Any]) -> str:
    """Return a kept range over people, a sentence; empty without a low end."""
    if kept.get("low") is None:
        return ""
    high = f"{kept['high']:.2f}" if kept["high"] is not None else "no upper end, since ridges of some adhere"
    return f"Likely range over people {kept['low']:.2f} to {high} (nine in ten)."


def why_not_known(kept: Mapping[str, Any]) -> str:
    """Return why the result's own closure has no number, of a kept band over closures; empty where it has."""
    if not kept or kept["mu_app"]:
        return ""
    return "; ".join(f"by {words} {why}" for words, why in kept["no_number"].items())
