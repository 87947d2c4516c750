"""Where the error of the model "cylinders" is known: of full runs of the default finger on the default screen.

It is the error of the model, beside that of a mesh: the largest difference from the full runs of ``docs/models.json``,
some of which are at forces that the model has no contact length of.
"""

from collections.abc import Mapping

from fingerpad.results.quantities import QUANTITIES
from fingerpad.results.states import WORDS
from fingerpad.scene.scene import Scene

Bands = Mapping[str, Mapping[str, float]]
"""Relative errors by state and quantity."""

KNOWN_ERROR: Bands = {
    "full_slip": {"mu_app": 0.024, "contact_length": 0.063, "f_electrostatic": 0.05},
    "charged": {"contact_length": 0.1, "f_electrostatic": 0.14},
}
"""Largest relative errors, rounded up to 0.1 %; tests/test_known_error.py derives them again."""
KNOWN_RUNS, KNOWN_FORCES, KNOWN_VOLTAGES = 44, (5.0, 150.0), (0.0, 200.0)
"""Number of the runs, and the range of their external forces (N/m) and voltages (V)."""
_TABLES = ("geometry", "materials", "contact", "electric", "roughness")


def where() -> str:
    """Return the range of the runs in words."""
    (low, high), (none, most) = KNOWN_FORCES, KNOWN_VOLTAGES
    return f"{low:g} to {high:g} N/m and {none:g} to {most:g} V"


def outside(f_ext: float, voltage: float) -> bool:
    """Return whether an external force (N/m) or a voltage (V) is beyond those runs."""
    ends = (KNOWN_FORCES, f_ext), (KNOWN_VOLTAGES, abs(voltage))
    return not all(low <= value <= high for (low, high), value in ends)


def changed(scene: Scene) -> list[str]:
    """Return the tables and keys of a scene that those runs have at their defaults, and the scene has not."""
    given, default = scene.parameters(), Scene().parameters()
    return [name for name in ("friction", *_TABLES) if given[name] != default[name]]


def errors(scene: Scene) -> Bands:
    """Return the known relative errors for a scene by state and quantity; empty where none is known."""
    return {} if outside(scene.f_ext, scene.volts) or changed(scene) else KNOWN_ERROR


def in_words(bands: Bands) -> str:
    """Return what is known of the error of a result in words."""
    if not bands:
        return "the error of this model is not known here"
    states = (
        f"in {WORDS[state]} " + ", ".join(f"{QUANTITIES[key].words} {100 * e:.1f} %" for key, e in each.items())
        for state, each in bands.items()
    )
    return f"largest error of this model in {KNOWN_RUNS} full runs at {where()}: {'; '.join(states)}"


def cautions(scene: Scene) -> list[str]:
    """Return why the error is not known for the result of a scene."""
    found = list[str]()
    if outside(scene.f_ext, scene.volts):
        found.append(f"the error of this model is known of full runs at {where()}, and not at this load")
    if keys := changed(scene):
        found.append(f"the error of this model is known with the default {', '.join(keys)}, and not here")
    return found
