"""Laws that a scene is given from Python, in the place of those that its keys describe; no finite elements here.

A closure, a material, a friction law or a mesh of your own is an object, which no file can hold. It becomes part of the
scene, so that folders and kept tables tell scenes apart, and :func:`used` names every law of a run for its reader.
"""

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fingerpad.sentences import SceneError, clip, show
from geometry import tags
from variational.friction import Coulomb, Friction, law_of
from variational.roughness import closure as closures
from variational.roughness.closure import Closure

if TYPE_CHECKING:
    from fingerpad.scene import Scene
    from variational.material import Material

LAYERS = {name.replace(" ", "_"): tag for name, tag in tags.LAYERS.items()}
"""Tag of each layer by its key in the scene."""


@dataclass(frozen=True)
class Laws:
    """Laws in the place of the scene's own; what is None or not there stays the scene's.

    Raises:
        SceneError: what is no law, or a layer that there is not; in one sentence.
    """

    closure: Closure | None = None
    """The microscale, in the place of the bearing area model of ``roughness``."""
    materials: Mapping[str, "Material"] = field(default_factory=dict)
    """Solids by the layer's key, in the place of those of ``materials``."""
    friction: Friction | float | None = None
    """Law of friction, in the place of Coulomb's; a number is Coulomb's friction coefficient, zero is no friction."""
    mesh: Path | str | None = None
    """File of a mesh, in the place of that of ``geometry`` and ``mesh``."""

    def __post_init__(self) -> None:
        """Check every law; a mesh becomes a path."""
        try:
            if self.closure is not None:
                closures.check(self.closure)
            if self.friction is not None:
                law_of(self.friction)
        except ValueError as error:
            raise SceneError(str(error)) from None
        if not isinstance(self.materials, Mapping):
            raise SceneError(f"materials is {show(self.materials)}; it must be a table of materials by layer")
        object.__setattr__(self, "materials", dict(self.materials))
        for layer, solid in self.materials.items():
            _check_solid(layer, solid)
        if self.mesh is not None:
            if not isinstance(self.mesh, str | Path):
                raise SceneError(f"mesh is {show(self.mesh)}; it must be the path of a file")
            if not Path(self.mesh).is_file():
                raise SceneError(f"mesh is {show(str(self.mesh))}, and there is no such file")
            object.__setattr__(self, "mesh", Path(self.mesh))

    def __bool__(self) -> bool:
        """Return whether there is a law."""
        return self != Laws()

    def parameters(self) -> dict[str, Any]:
        """Return the laws that are given, ready for JSON; equal laws give equal text."""
        found: dict[str, Any] = {}
        if self.closure is not None:
            found["closure"] = _described(self.closure)
        if self.materials:
            found["materials"] = {layer: _described(self.materials[layer]) for layer in sorted(self.materials)}
        if self.friction is not None:
            found["friction"] = _described(law_of(self.friction))
        if self.mesh is not None:
            content = Path(self.mesh).read_bytes()
            found["mesh"] = {"path": str(self.mesh), "sha256": hashlib.sha256(content).hexdigest()}
        return found


def _check_solid(layer: str, solid: Any) -> None:
    """Refuse what is no solid of a layer."""
    from variational.material import Material  # UFL: not for those who give none

    if layer not in LAYERS:
        raise SceneError(f"materials has {show(layer)}, which is no layer; layers are {', '.join(LAYERS)}")
    if not isinstance(solid, Material):
        raise SceneError(f"materials[{layer!r}] is {show(solid)}; it must be a Material")
    try:
        solid.check()
    except ValueError as error:
        raise SceneError(f"materials[{layer!r}]: {error}") from None


def coefficient(scene: "Scene") -> float | None:
    """Return the friction coefficient of Coulomb's law; None where the scene has another one."""
    law = scene.friction_law()
    if law is None:
        return 0.0
    return law.mu_f if isinstance(law, Coulomb) else None


def skin_modulus(scene: "Scene") -> float:
    """Return the plane strain modulus of the stratum corneum, E* = 2 G / (1 - nu) (Pa), unloaded."""
    mine, horny = scene.laws.materials.get("stratum_corneum"), scene.materials.stratum_corneum
    return 2 * horny.shear_modulus / (1 - horny.poisson) if mine is None else mine.plane_modulus


# -- in words ------------------------------------------------------------------------------------------
def used(scene: "Scene") -> dict[str, str]:
    """Return every law of a scene in words, with its numbers in SI units.

    Keys are the layers, ``contact``, ``friction``, ``attraction`` and ``closure``, and ``mesh`` where one was given.
    """
    laws, m = scene.laws, scene.materials
    found = {}
    for layer in LAYERS:
        mine = laws.materials.get(layer)
        if mine is not None:
            found[layer] = _words(mine)
        elif layer.startswith("nail"):
            found[layer] = _sentence("SaintVenant", getattr(m, layer).model_dump())
        else:
            found[layer] = _sentence("Ogden", getattr(m, layer).model_dump() | {"convention": m.exponent})
    contact = scene.contact
    numbers = contact.model_dump(exclude=contact.unread() | {"formulation", "length"})
    found["contact"] = _sentence(_FORMULATIONS[contact.formulation], numbers)
    friction = scene.friction_law()
    found["friction"] = "none" if friction is None else _words(friction)
    charged = any(load.voltage for load in scene.loads())
    found["attraction"] = _sentence("electrostatic", {"h_0": scene.h_0}) if charged else "none"
    found["closure"] = _words(scene.closure()) if charged else "none"
    return found | ({} if laws.mesh is None else {"mesh": str(laws.mesh)})


_FORMULATIONS = {"penalty": "Penalty", "nitsche": "Nitsche", "augmented": "AugmentedLagrangian"}


def _sentence(name: str, numbers: Mapping[str, Any]) -> str:
    return f"{name}({', '.join(f'{key}={_shown(value)}' for key, value in numbers.items())})"


def _words(law: Any) -> str:
    return _sentence(type(law).__name__, _numbers(law))


def _shown(value: Any) -> str:
    return show(value) if isinstance(value, int | float | str | None) else clip(str(_plain(value)))


def _numbers(law: Any) -> dict[str, Any]:
    """Return what a law was made of: a dataclass's fields, or the attributes of another object."""
    if is_dataclass(law):
        return {f.name: getattr(law, f.name) for f in fields(law)}
    return dict(sorted(vars(law).items())) if hasattr(law, "__dict__") else {}


def _described(law: Any) -> Any:
    """Return a law as its class and what it was made of, ready for JSON."""
    if law is None:
        return 0.0
    kind = type(law)
    numbers = {name: _plain(value) for name, value in _numbers(law).items()}
    return {"law": f"{kind.__module__}.{kind.__qualname__}"} | numbers


def _plain(value: Any) -> Any:
    """Return a value of a law as JSON holds it; of an object its class and what that is made of."""
    if value is None or isinstance(value, bool | str):
        return value
    if isinstance(value, int | float):
        return float(value)  # 1 and 1.0 are equal, and so must be what is written of them
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist())
    if isinstance(value, Path):
        return str(value)
    if isinstance(value, Mapping):
        return {str(key): _plain(inner) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner) for inner in value]
    if callable(value) and hasattr(value, "__qualname__"):
        return f"{value.__module__}.{value.__qualname__}"
    return _described(value)
