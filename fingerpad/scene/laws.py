"""Laws that a scene is given from Python, in the place of those that its keys describe; no finite elements here.

A closure, a material, a friction law or a mesh of your own is an object, which no file can hold. It becomes part of the
scene, so that folders and kept tables tell scenes apart, and :func:`used` names every law of a run for its reader.
"""

import hashlib
import math
from collections.abc import Mapping
from dataclasses import dataclass, field, fields, is_dataclass, replace
from functools import partial
from numbers import Real
from pathlib import Path
from types import FunctionType, MethodType
from typing import TYPE_CHECKING, Any

import numpy as np

from fingerpad.scene.law_source import digest
from fingerpad.scene.messages import SceneError, clip, show
from geometry import tags
from variational import files
from variational.contact.friction import Coulomb, Friction, law_of
from variational.roughness import closure as closures
from variational.roughness.closure import Closure

if TYPE_CHECKING:
    from fingerpad.scene import Scene
    from variational.materials.material import Material

LAYERS = {name.replace(" ", "_"): tag for name, tag in tags.LAYERS.items()}
"""Tag of each layer by its key in the scene."""
_SAME = 1e-6  # relative difference of thicknesses that are the same


@dataclass(frozen=True, eq=False)
class Laws:
    """Laws in the place of the scene's own; what is None or not there stays the scene's.

    Laws are equal where their :meth:`parameters` are.

    Raises:
        SceneError: an object that is no law, or a layer that does not exist.
    """

    closure: Closure | None = None
    """The microscale, in the place of the bearing area model of ``roughness``."""
    materials: Mapping[str, "Material"] = field(default_factory=dict)
    """Solids by the layer's key or name, in the place of those of ``materials``."""
    friction: Friction | None = None
    """Law of friction, in the place of Coulomb's."""
    mesh: Path | str | None = None
    """File of a mesh, in the place of that of ``geometry`` and ``mesh``; kept as an absolute path."""
    mesh_sha256: str = field(default="", init=False, repr=False)
    """Hash of that file, as it was when it was given."""
    kept: Mapping[str, Any] = field(default_factory=dict)
    """Laws of a scene that was read from a run's files, as :meth:`parameters` has them: names and numbers, but no code.
    A scene with any of them is not run; a law that is given takes the place of its name."""

    def __post_init__(self) -> None:
        """Check every law; a mesh becomes an absolute path."""
        try:
            if self.closure is not None:
                closures.check(self.closure)
            if self.friction is not None and law_of(self.friction) is not self.friction:
                raise ValueError(f"friction is {show(self.friction)}; a number is no law but the scene's key friction")
        except ValueError as error:
            raise SceneError(str(error)) from None
        if not isinstance(self.materials, Mapping):
            raise SceneError(f"materials is {show(self.materials)}; it must be a table of materials by layer")
        solids: dict[str, Material] = {}
        for name, solid in self.materials.items():
            layer = name.replace(" ", "_") if isinstance(name, str) else name
            if layer in solids:
                raise SceneError(
                    f"materials has the layer {show(layer)} twice, by its key and by its name; give it once"
                )
            _check_solid(layer, solid)
            solids[layer] = solid
        object.__setattr__(self, "materials", solids)
        object.__setattr__(self, "kept", self._not_given())
        if self.mesh is not None:
            if not isinstance(self.mesh, str | Path):
                raise SceneError(f"mesh is {show(self.mesh)}; it must be the path of a file")
            try:
                content = files.read(self.mesh)
            except FileNotFoundError:
                raise SceneError(f"mesh is {show(str(self.mesh))}, and there is no such file") from None
            except OSError as error:
                raise SceneError(f"mesh is {show(str(self.mesh))}, which cannot be read: {error.strerror}") from None
            object.__setattr__(self, "mesh", Path(self.mesh).absolute())
            object.__setattr__(self, "mesh_sha256", hashlib.sha256(content).hexdigest())
        self.parameters()  # reads the sources of the user's code, which may be edited while a run is on

    def _not_given(self) -> dict[str, Any]:
        """Return the kept laws in whose place none is given."""
        solids = {layer: law for layer, law in self.kept.get("materials", {}).items() if layer not in self.materials}
        given = {name for name in ("closure", "friction", "mesh") if getattr(self, name) is not None}
        kept = {name: law for name, law in self.kept.items() if name != "materials" and name not in given}
        return kept | ({"materials": solids} if solids else {})

    def refuse_kept(self, name: str | None = None) -> None:
        """Refuse laws that are known by name alone.

        Args:
            name: of the one law that is asked for; None for any.

        Raises:
            SceneError: which they are.
        """
        if not self.kept or (name is not None and name not in self.kept):
            return
        names = [name for name in self.kept if name != "materials"]
        names += [f"materials.{layer}" for layer in self.kept.get("materials", {})]
        raise SceneError(
            f"the scene was read from a run with laws of its own ({', '.join(names)}), of which its files have "
            "the names and numbers alone; give them again, as arguments of run or by with_laws"
        )

    def with_file(self, file: str | None) -> "Laws":
        """Return the laws with the mesh that the key ``geometry.file`` names, or without one.

        Raises:
            SceneError: there is no such file, or it cannot be read.
        """
        try:
            return self if file is None and self.mesh is None else replace(self, mesh=file)
        except SceneError as error:
            raise SceneError(f"geometry.file: {error}") from None

    def __eq__(self, other: object) -> bool:
        """Return whether other laws are described alike; laws may hold arrays, which have no one truth value."""
        return self.parameters() == other.parameters() if isinstance(other, Laws) else NotImplemented

    __hash__ = None  # type: ignore[assignment]

    def __bool__(self) -> bool:
        """Return whether there is a law."""
        given = (self.closure, self.friction, self.mesh)
        return bool(self.materials or self.kept) or any(law is not None for law in given)

    def parameters(self) -> dict[str, Any]:
        """Return the laws that are given, ready for JSON; equal laws give equal text."""
        found = dict(self.kept)
        if self.closure is not None:
            found["closure"] = _described(self.closure)
        if self.materials:
            solids = found.get("materials", {}) | {layer: _described(law) for layer, law in self.materials.items()}
            found["materials"] = {layer: solids[layer] for layer in sorted(solids)}
        if self.friction is not None:
            found["friction"] = _described(self.friction)
        if self.mesh is not None:
            found["mesh"] = {"path": str(self.mesh), "sha256": self.mesh_sha256}
        return found


def refuse_thickness(closure: Any, h_0: float) -> None:
    """Refuse a closure of another insulator than the one whose voltage attracts.

    Args:
        closure: a closure; one without a number ``h_0`` has no insulator of its own.
        h_0: effective insulator thickness of the attraction (m).

    Raises:
        ValueError: the two differ by more than roundoff.
    """
    own = getattr(closure, "h_0", h_0)
    if isinstance(own, Real) and abs(float(own) - h_0) > _SAME * h_0:
        raise ValueError(
            f"the closure {type(closure).__name__} has h_0 = {float(own):.7g} m, and the attraction has an effective "
            f"insulator thickness h_0 of {h_0:.7g} m; the two must be the same"
        )


def refuse_beside_mesh(data: Mapping[str, Any]) -> None:
    """Refuse keys of a scene beside ``geometry.file`` that a run on that mesh does not read.

    Args:
        data: nested tables, as they were given.

    Raises:
        SceneError: the first of them.
    """
    shape = data.get("geometry")
    if not isinstance(shape, Mapping) or shape.get("file") is None:
        return
    sizes = data.get("mesh")
    given = [f"geometry.{key}" for key in shape if key not in ("file", "sc_thickness")]
    given += [f"mesh.{key}" for key in sizes] if isinstance(sizes, Mapping) else []
    given += ["accuracy"] if data.get("accuracy") is not None else []
    if given:
        raise SceneError(
            f"{clip(given[0])} is given and geometry.file too, whose mesh has its own shape and sizes and cannot be "
            "refined; leave one of the two out"
        )


def refuse_unread(before: "Scene", after: "Scene") -> None:
    """Refuse changed keys that a scene does not read, since it has laws in their place.

    Raises:
        SceneError: the roughness under a closure, or the material of a layer that was given one.
    """
    laws = after.laws
    if laws.closure is not None and after.roughness != before.roughness:
        raise SceneError(
            f"roughness is changed, and the scene has the closure {type(laws.closure).__name__} in its place; give "
            "with_laws another closure, or change a scene without one"
        )
    for layer, solid in laws.materials.items():
        if getattr(after.materials, layer) != getattr(before.materials, layer):
            raise SceneError(
                f"materials.{layer} is changed, and the scene has the material {type(solid).__name__} in its place; "
                "give with_laws another material, or change a scene without one"
            )


def _check_solid(layer: str, solid: Any) -> None:
    """Refuse what is no solid of a layer."""
    from variational.materials.material import Material  # UFL: not for those who give none

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
            found[layer] = _call("SaintVenant", getattr(m, layer).model_dump())
        else:
            found[layer] = _call("Ogden", getattr(m, layer).model_dump() | {"convention": m.exponent})
    found["contact"] = _words(scene.contact.law())
    friction = scene.friction_law()
    found["friction"] = "none" if friction is None else _words(friction)
    charged = any(load.voltage for load in scene.loads())
    found["attraction"] = _call("electrostatic", {"h_0": scene.h_0}) if charged else "none"
    found["closure"] = _words(scene.closure()) if charged else "none"
    return found | ({} if laws.mesh is None else {"mesh": str(laws.mesh)})


def _call(name: str, numbers: Mapping[str, Any]) -> str:
    """Return a law as it would be made in Python: its name, and its numbers in brackets."""
    return f"{name}({', '.join(f'{key}={_shown(value)}' for key, value in numbers.items())})"


def _words(law: Any) -> str:
    return _call(type(law).__name__, _numbers(law))


def _shown(value: Any) -> str:
    return show(value) if isinstance(value, int | float | str | None) else clip(str(_plain(value, keyed=False)))


def _numbers(law: Any) -> dict[str, Any]:
    """Return what a law was made of: a dataclass's fields, or the attributes of another object."""
    if is_dataclass(law):
        return {f.name: getattr(law, f.name) for f in fields(law)}
    return dict(sorted(vars(law).items())) if hasattr(law, "__dict__") else {}


def _described(law: Any, keyed: bool = True, inside: frozenset[int] = frozenset()) -> Any:
    """Return a law as its class and what it was made of, ready for JSON.

    Args:
        law: a law, or another object that one holds.
        keyed: whether to add a hash of the user's code, by which laws of one name are told apart.
        inside: the objects that hold it.
    """
    if law is None:
        return 0.0
    kind, inside = type(law), inside | {id(law)}
    found: dict[str, Any] = {"law": f"{kind.__module__}.{kind.__qualname__}"} | _code(kind, keyed)
    if isinstance(law, partial):
        numbers = {"function": law.func, "arguments": law.args, "keywords": law.keywords}
    elif isinstance(law, MethodType):
        numbers = {"function": law.__func__, "of": law.__self__}
    else:
        numbers = _numbers(law)
        if not numbers and not hasattr(law, "__dict__"):
            found["value"] = repr(law)
    return found | {name: _plain(value, keyed, inside) for name, value in numbers.items()}


def _code(thing: Any, keyed: bool) -> dict[str, str]:
    code = digest(thing) if keyed else ""
    return {"source code": code} if code else {}


def _plain(value: Any, keyed: bool = True, inside: frozenset[int] = frozenset()) -> Any:
    """Return a value of a law as JSON holds it; of an object its class and what that is made of."""
    if value is None or isinstance(value, bool | str):
        return value
    if isinstance(value, int | float):
        number = float(value)  # 1 and 1.0 are equal, and so must be what is written of them
        return number if math.isfinite(number) else str(number)
    if isinstance(value, np.ndarray | np.generic):
        return _plain(value.tolist(), keyed, inside)
    if isinstance(value, Path):
        return str(value)
    if id(value) in inside:
        return "itself"
    if isinstance(value, Mapping):
        return {str(key): _plain(inner, keyed, inside | {id(value)}) for key, inner in value.items()}
    if isinstance(value, list | tuple):
        return [_plain(inner, keyed, inside | {id(value)}) for inner in value]
    if isinstance(value, type) or (
        callable(value) and hasattr(value, "__qualname__") and not (keyed and isinstance(value, MethodType))
    ):
        name = f"{getattr(value, '__module__', '')}.{value.__qualname__}"
        code = _code(value, keyed) if isinstance(value, type | FunctionType) else {}
        return {"function": name} | code if code else name
    return _described(value, keyed, inside)
