"""The laws of afferents by name: where a law of one's own is registered."""

from fingerpad.afferents.afferent import Afferent
from fingerpad.afferents.linear import ALIASES
from fingerpad.afferents.pc import PC
from fingerpad.afferents.ra1 import RA1
from fingerpad.afferents.sa1 import SA1
from fingerpad.scene.messages import SceneError, show

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
        SceneError: there is none of that name.
    """
    if isinstance(law, Afferent):
        return law
    name = ALIASES.get(law, law) if isinstance(law, str) else law
    if not (isinstance(name, str) and name in LAWS):
        raise SceneError(f"the class is {show(law)}; it must be {' or '.join(map(repr, LAWS))}, or an Afferent")
    return LAWS[name]
