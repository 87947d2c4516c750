"""The laws of a scene for computing and for reading: coefficient, modulus, and every law in words."""

from collections.abc import Mapping
from dataclasses import fields
from typing import TYPE_CHECKING, Any

from fingerpad.scene.law_keys import Kept
from fingerpad.scene.materials import LAYERS
from fingerpad.scene.messages import clip, show
from variational.contact.friction import Coulomb, Friction

if TYPE_CHECKING:
    from fingerpad.scene import Scene


def coefficient(scene: "Scene") -> float | None:
    """Return the friction coefficient of Coulomb's law; None where the scene has another one."""
    return None if isinstance(scene.friction, Kept | Friction) else scene.friction


def skin_modulus(scene: "Scene") -> float:
    """Return the plane strain modulus of the stratum corneum, E* = 2 G / (1 - nu) (Pa), unloaded."""
    return scene.solids()[LAYERS["stratum_corneum"]].plane_modulus


# -- in words ------------------------------------------------------------------------------------------
def used(scene: "Scene") -> dict[str, str]:
    """Return every law of a scene in words, with its numbers in SI units.

    Keys are the layers, ``contact``, ``friction``, ``attraction`` and ``closure``, and ``mesh`` where one was given.
    """
    found = {layer: _words(getattr(scene.materials, layer)) for layer in LAYERS}
    found["contact"] = _words(scene.contact.law)
    friction = Coulomb(scene.friction) if isinstance(scene.friction, float) else scene.friction
    found["friction"] = _words(friction) if scene.friction else "none"
    charged = any(load.voltage for load in scene.loads())
    found["attraction"] = _call("electrostatic", {"h_0": scene.h_0}) if charged else "none"
    found["closure"] = _words(scene.roughness) if charged else "none"
    return found | ({} if scene.geometry.file is None else {"mesh": scene.geometry.file})


def _call(name: str, numbers: Mapping[str, Any]) -> str:
    """Return a law as it would be made in Python: its name, and its numbers in brackets."""
    return f"{name}({', '.join(f'{key}={_shown(value)}' for key, value in numbers.items())})"


def _words(law: Any) -> str:
    if isinstance(law, Kept):
        return _call(str(law.table.get("law")), {k: v for k, v in law.table.items() if k not in ("law", "sha256")})
    return _call(type(law).__name__, {f.name: getattr(law, f.name) for f in fields(law)})


def _shown(value: Any) -> str:
    return show(value) if isinstance(value, int | float | str | None) else clip(str(value))
