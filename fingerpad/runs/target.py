"""What a scene is to reach, read from a text: ``"mu_app=2x"``, ``"F_T=0.3 N"``, ``"contrast=10 %"``.

A target is a quantity of the state of full slip and its value. Quantities are those of
:data:`fingerpad.results.quantities.FINGER`, of the whole finger, and :data:`~variational.state.EXTREMES`, of
the section at its centre. They have their names or symbols. ``2x`` is twice the value without voltage. *Contrast* is
the relative rise of µ_app by the voltage: 10 % is 1.1 times µ_app without voltage.
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass

from fingerpad.results.quantities import EXTREMES, FINGER, QUANTITIES, Output
from fingerpad.scene.messages import SceneError, clip, show
from geometry.units import finite, to_si

CONTRAST = "contrast"
_NUMBER = re.compile(r"([-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d{1,3})?)\s*(.*)")
_CONDITION = "f_ext"
"""The one of :data:`FINGER` that is no answer."""
_EXAMPLES = 'write it as "mu_app=2x", "F_T=0.3 N" or "contrast=10 %"'


@dataclass(frozen=True)
class Target:
    """A quantity at full slip and the value that it is to have."""

    name: str
    """As it was written."""
    quantity: Output
    whole: bool
    """Whether it is of the whole finger, else of the section at its centre."""
    value: float
    """In SI, or relative to the value without voltage."""
    relative: bool

    def shown(self, value: float, unit: bool = True) -> str:
        """Return a value of the kind of :attr:`value` in the unit of tables."""
        if self.name == CONTRAST:
            return f"{100 * (value - 1):.4g}" + " %" * unit
        if self.relative:
            return f"{value:.4g}" + " times its value without voltage" * unit
        return f"{value * self.quantity.scale:.4g}" + f" {self.quantity.unit}" * (unit and self.quantity.unit != "")

    def __str__(self) -> str:
        """Return the target as a text."""
        if self.relative and self.name != CONTRAST:
            return f"{self.name} = {self.value:g}x"
        return f"{self.name} = {self.shown(self.value)}"


def read(text: str, newtons: bool) -> Target:
    """Return the target that a text means.

    Args:
        text: ``QUANTITY=VALUE``; the value is a number in SI, with a unit, or followed by ``x``, a contrast also in
            per cent.
        newtons: whether a force on the whole finger is given: a name of both is then that of the whole finger.

    Raises:
        SceneError: no such quantity, no number, or a unit that does not fit, in one sentence.
    """
    if not isinstance(text, str):
        raise SceneError(f"target is {show(text)}; {_EXAMPLES}")
    name, equals, given = (part.strip() for part in text.partition("="))
    if not (name and equals):
        raise SceneError(f"target is {show(text)}; {_EXAMPLES}")
    found = list(_named("mu_app" if name == CONTRAST else name))
    if not found:
        known = ", ".join(dict.fromkeys([CONTRAST, *EXTREMES, *(key for key in FINGER if key != _CONDITION)]))
        raise SceneError(f"{clip(name)} is not a quantity of a target; it must be one of {known}")
    parts = _NUMBER.fullmatch(given)
    if parts is None:
        raise SceneError(f"target {clip(name)} is {show(given)}; it must have a number: {_EXAMPLES}")
    try:
        number, unit = finite(parts[1]), parts[2]
    except ValueError as error:
        raise SceneError(f"target {clip(name)} is {show(given)}; {error}") from None
    found.sort(key=lambda each: each[1] != newtons)
    if unit in ("x", "×") and name != CONTRAST:
        return Target(name, *found[0], number, True)
    if not found[0][0].unit:
        if unit != "" and (unit != "%" or name != CONTRAST):
            less = f"; for a rise by the voltage it is contrast={parts[1]} %" if unit == "%" else ""
            allowed = "a number or in %" if name == CONTRAST else f'a number, or a multiple such as "2x"{less}'
            raise SceneError(f"target {clip(name)} is {show(given)}; it must be {allowed}")
        number = number / 100 if unit else number
        return Target(name, *found[0], number + (name == CONTRAST), name == CONTRAST)
    refusals = list[ValueError]()
    for quantity, whole in found:  # f_t may be N/m or N
        try:
            return Target(name, quantity, whole, to_si(given, quantity.si) if unit else number, False)
        except ValueError as error:
            refusals.append(error)
    raise SceneError(f"target {clip(name)} is {show(given)}; {refusals[0]}") from None


def _named(name: str) -> Iterator[tuple[Output, bool]]:
    """Yield the quantities of a name or a symbol, and whether they are of the whole finger."""
    name = name.replace("µ", "mu").replace("μ", "mu")
    tables = (({key: QUANTITIES[key] for key in EXTREMES}, False), (FINGER, True))
    for table, whole in tables:
        for key, quantity in table.items():
            if name in (key, quantity.symbol) and key != _CONDITION:
                yield quantity, whole
