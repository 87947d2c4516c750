"""Scenes: everything a run needs, checked, from Python, TOML or the command line."""

from fingerpad.scene.changes import start
from fingerpad.scene.loads import Load
from fingerpad.scene.materials import CLOSURES, FRICTION_LAWS, MATERIALS
from fingerpad.scene.messages import SceneError
from fingerpad.scene.parameters import CONTACT, Accuracy, Contact, Numerics, Output
from fingerpad.scene.reading import override
from fingerpad.scene.scene import Scene, as_kept, changed_keys, from_data, load


def law_name(law: object) -> str:
    """Return the name of a law, or its import path where it is one of a user's own."""
    kinds = (MATERIALS, FRICTION_LAWS, CLOSURES, CONTACT.kind)
    return next(kind.name(type(law)) for kind in kinds if isinstance(law, kind.base))


def laws_by_name() -> dict[str, type]:
    """Return the laws of the package by the names of their classes."""
    kinds = (MATERIALS, FRICTION_LAWS, CLOSURES, CONTACT.kind)
    return {law.__name__: law for kind in kinds for law in kind.laws.values()}


__all__ = [
    "Accuracy",
    "Contact",
    "Load",
    "Numerics",
    "Output",
    "Scene",
    "SceneError",
    "from_data",
    "laws_by_name",
    "as_kept",
    "changed_keys",
    "load",
    "override",
    "start",
]
