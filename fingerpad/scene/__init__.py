"""Scenes: everything a run needs, checked, from Python, TOML or the command line."""

from fingerpad.scene.changes import start
from fingerpad.scene.messages import SceneError
from fingerpad.scene.parameters import Accuracy, Contact, Load, Numerics, Output
from fingerpad.scene.reading import override
from fingerpad.scene.scene import Scene, as_kept, from_data, load

__all__ = [
    "Accuracy",
    "Contact",
    "Load",
    "Numerics",
    "Output",
    "Scene",
    "SceneError",
    "from_data",
    "as_kept",
    "load",
    "override",
    "start",
]
