"""Where the error of the model "cylinders" is known: of full runs of the default finger on the default screen."""

from fingerpad.scene import Scene

KNOWN_ERROR = {"mu_app": 0.0237, "contact_length": 0.0621}
"""Largest relative error at full slip; benchmarks/models.py keeps it in docs/models.json."""
KNOWN_RUNS, KNOWN_FORCES, KNOWN_VOLTAGES = 40, (5.0, 150.0), (0.0, 200.0)
"""Number of the runs, and the range of their external forces (N/m) and voltages (V)."""


def outside(f_ext: float, voltage: float) -> bool:
    """Return whether an external force (N/m) or a voltage (V) is beyond those runs."""
    ends = (KNOWN_FORCES, f_ext), (KNOWN_VOLTAGES, abs(voltage))
    return not all(low <= value <= high for (low, high), value in ends)


def changed(scene: Scene) -> list[str]:
    """Return the keys of a scene that those runs have at their defaults, and the scene has not."""
    default = Scene()
    found = [] if scene.friction_law() == default.friction_law() else ["friction"]
    found += [name for name in ("electric", "roughness") if getattr(scene, name) != getattr(default, name)]
    return found + ([] if scene.laws.closure is None else ["closure"])


def cautions(scene: Scene) -> list[str]:
    """Return why the error is not known, or may be larger, for the result of a scene."""
    (low, high), (none, most) = KNOWN_FORCES, KNOWN_VOLTAGES
    found = list[str]()
    if outside(scene.f_ext, scene.voltage):
        found.append(
            f"the error of this model is known of full runs at {low:g} to {high:g} N/m and {none:g} to {most:g} V, "
            "and not at this load"
        )
    if keys := changed(scene):
        found.append(f"the error of this model is known with the default {', '.join(keys)}; here it may be larger")
    return found
