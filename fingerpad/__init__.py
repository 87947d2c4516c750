"""fingerpad: how a fingertip sticks, slides and feels on a touchscreen under electroadhesion.

    import fingerpad as fp

    result = fp.run(fp.Scene(f_ext=75.0, voltage=200.0, friction=0.25))
    print(result)

Importing this package imports nothing heavy; what needs finite elements is imported when it is used.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    import geometry as geometry
    from fingerpad.io.quantities import Output as Output
    from fingerpad.io.result import Result as Result
    from fingerpad.measurements.compare import compare as compare
    from fingerpad.model.body import Body as Body
    from fingerpad.runs.solve import run as run
    from fingerpad.runs.sweep import sweep as sweep
    from fingerpad.runs.sweep_results import Sweep as Sweep
    from fingerpad.scene import Scene as Scene
    from fingerpad.scene import SceneError as SceneError
    from variational.contact.augmented import AugmentedLagrangian as AugmentedLagrangian
    from variational.contact.friction import Coulomb as Coulomb
    from variational.contact.friction import Derjaguin as Derjaguin
    from variational.contact.friction import Friction as Friction
    from variational.contact.nitsche import Nitsche as Nitsche
    from variational.contact.penalty import Penalty as Penalty
    from variational.materials.material import Material as Material
    from variational.materials.neo_hooke import NeoHooke as NeoHooke
    from variational.materials.ogden import Ogden as Ogden
    from variational.materials.saint_venant import SaintVenant as SaintVenant
    from variational.roughness.bam import BearingArea as BearingArea
    from variational.roughness.closure import AirGap as AirGap
    from variational.roughness.closure import Closure as Closure
    from variational.state import ContactState as ContactState

_HOMES = {
    "Scene": "fingerpad.scene",
    "SceneError": "fingerpad.scene",
    "run": "fingerpad.runs.solve",
    "sweep": "fingerpad.runs.sweep",
    "Sweep": "fingerpad.runs.sweep_results",
    "compare": "fingerpad.measurements.compare",
    "Result": "fingerpad.io.result",
    "Output": "fingerpad.io.quantities",
    "ContactState": "variational.state",
    "Body": "fingerpad.model.body",
    "Material": "variational.materials.material",
    "Ogden": "variational.materials.ogden",
    "NeoHooke": "variational.materials.neo_hooke",
    "SaintVenant": "variational.materials.saint_venant",
    "Penalty": "variational.contact.penalty",
    "Nitsche": "variational.contact.nitsche",
    "AugmentedLagrangian": "variational.contact.augmented",
    "Friction": "variational.contact.friction",
    "Coulomb": "variational.contact.friction",
    "Derjaguin": "variational.contact.friction",
    "Closure": "variational.roughness.closure",
    "AirGap": "variational.roughness.closure",
    "BearingArea": "variational.roughness.bam",
}
_LIGHT = "variational.roughness", "variational.state", "variational.contact.friction"
_FINITE_ELEMENTS = [
    name for name, home in _HOMES.items() if home.startswith("variational") and not home.startswith(_LIGHT)
] + ["Body"]
__all__ = [*_HOMES, "geometry"]


def __getattr__(name: str) -> Any:
    """Import what is asked for."""
    from fingerpad.installed import needed_by, version

    if name == "__version__":
        return version()
    if name == "geometry":
        return import_module("geometry")
    if name not in _HOMES:
        raise AttributeError(f"module 'fingerpad' has no attribute {name!r}; it has {', '.join(__all__)}")
    with needed_by(f"fingerpad.{name}"):
        if name in _FINITE_ELEMENTS:  # with the configuration of the user alone, before any other import
            import_module("fingerpad.startup")
        return getattr(import_module(_HOMES[name]), name)


def __dir__() -> list[str]:
    return __all__
