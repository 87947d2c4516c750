"""Spikes of mechanoreceptive afferents: laws of classes of units by name, and thresholds over the frequency.

import fingerpad as fp

times = fp.afferents.SA1().spikes(stress, 1e-3)  # stress in Pa at equal times, 1 ms apart
fp.afferents.threshold("RA", 40.0)  # m

A law of one's own is registered in :data:`LAWS`. This package imports NumPy and SciPy, and nothing of fingerpad.
"""

import reprlib

from fingerpad.afferents.afferent import Afferent, History
from fingerpad.afferents.linear import ALIASES, threshold
from fingerpad.afferents.pc import PC
from fingerpad.afferents.ra1 import RA1
from fingerpad.afferents.sa1 import SA1

__all__ = ["LAWS", "PC", "RA1", "SA1", "Afferent", "History", "find", "threshold"]

LAWS: dict[str, Afferent] = {
    "SA1": SA1(),
    "SA1 sed": SA1("sed"),
    "RA1": RA1(),
    "RA1 strain": RA1("strain"),
    "PC": PC(),
}
"""The laws by name."""
DEFAULT = ("SA1", "RA1", "PC")
"""Those of a result where none is named."""


def find(law: str | Afferent) -> Afferent:
    """Return a law by its name, or itself.

    Raises:
        ValueError: there is none of that name.
    """
    if isinstance(law, Afferent):
        return law
    name = ALIASES.get(law, law) if isinstance(law, str) else law
    if not (isinstance(name, str) and name in LAWS):
        words = " or ".join(map(repr, LAWS))
        raise ValueError(f"the class is {reprlib.repr(law)}; it must be {words}, or an Afferent")
    return LAWS[name]
