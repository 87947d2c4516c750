"""The quantities of a state in words and in the units of tables: N/m, mm, kPa."""

import math
from typing import NamedTuple

from fingerpad.io.states import PREFIXES, WORDS
from fingerpad.richardson import plus_minus

_NOTHING = 1e-6  # in the units of tables: below it all is roundoff


class Quantity(NamedTuple):
    """How a quantity is printed."""

    words: str
    unit: str
    scale: float
    """Factor from SI to the unit."""
    digits: int
    """Digits after the point, where no error is estimated."""

    @property
    def symbol(self) -> str:
        """The last of the words where it is a symbol, such as µ_app, else all words."""
        last = self.words.split()[-1]
        return last if len(last) == 1 or "_" in last else self.words

    @property
    def title(self) -> str:
        """Words and unit."""
        return f"{self.words} ({self.unit})" if self.unit else self.words

    def shown(self, value: float, error: float = math.nan) -> str:
        """Return a value in the unit of tables, with its error where the error reaches the digits shown.

        Args:
            value: value in SI; NaN where it is not computed.
            error: error in SI; NaN where it is not estimated.
        """
        if math.isnan(value):
            return "–"
        if not math.isnan(error) and error * self.scale >= 0.5 * 10.0**-self.digits:
            return plus_minus(value * self.scale, error * self.scale)
        shown = value * self.scale
        small = _NOTHING < abs(shown) < 0.5 * 10.0**-self.digits
        return f"{shown:.2g}" if small else f"{shown:z.{self.digits}f}"  # z: no minus before a zero


QUANTITIES = {
    "f_ext": Quantity("external force f_ext", "N/m", 1.0, 2),
    "voltage": Quantity("voltage U", "V", 1.0, 1),
    "mu_app": Quantity("apparent friction µ_app", "", 1.0, 4),
    "f_t": Quantity("friction force f_T", "N/m", 1.0, 3),
    "f_electrostatic": Quantity("attraction f_el", "N/m", 1.0, 3),
    "f_contact": Quantity("contact force f_c", "N/m", 1.0, 3),
    "contact_length": Quantity("contact length L_R", "mm", 1e3, 4),
    "ridges_in_contact": Quantity("ridges in contact", "", 1.0, 0),
    "bone_height": Quantity("height of the bone", "mm", 1e3, 4),
}
PER_LENGTH = (
    "N/m: force per metre of finger out of the plane of the cross-section; 75 N/m at the centre of the default finger "
    "are about 0.5 N in all."
)

PLUS_MINUS = (
    "±: estimated discretisation error; what the finger and the model assume is not in it (docs/assumptions.md)."
)


def cell(key: str, value: float, error: float = math.nan) -> str:
    """Return a quantity of :data:`QUANTITIES` as :meth:`Quantity.shown` does."""
    return QUANTITIES[key].shown(value, error)


def in_words(key: str) -> str:
    """Return a key such as ``slip_mu_app`` in words: quantity and state."""
    name = next((name for name, prefix in PREFIXES.items() if key.startswith(f"{prefix}_")), None)
    if name is None:
        return key
    quantity = key.removeprefix(f"{PREFIXES[name]}_")
    words = QUANTITIES[quantity].words if quantity in QUANTITIES else quantity
    return f"{words} at {WORDS[name]}"


def scaled(key: str, value: float) -> tuple[float, str]:
    """Return the value of a key such as ``slip_contact_length`` (in SI) in the unit of tables, and this unit."""
    known = [q for name, q in QUANTITIES.items() if key == name or key.endswith(f"_{name}")]
    return (value * known[0].scale, known[0].unit) if known else (value, "")
