"""How long the contact of charged cylinders is, and on how many ridges: as given, or that of a full run."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fingerpad.reduced.model import STATES
from fingerpad.results.files import read_object
from fingerpad.scene.messages import SceneError, show
from fingerpad.scene.reading import DEFAULT_MODEL
from fingerpad.scene.scene import Scene


@dataclass(frozen=True)
class Footprint:
    """How long the contact is, and on how many ridges, by state: ``charged`` and ``full_slip``."""

    length: dict[str, float]
    """Contact length (m)."""
    ridges: dict[str, int]
    charged: bool
    """Whether the lengths are those at the scene's voltage, or those without."""
    source: str
    """Where they come from, for a reader."""


def given(length: float, ridges: int) -> Footprint:
    """Return a contact length (m) at the scene's voltage, the same in both states.

    Raises:
        SceneError: a length or a number of ridges that is not positive.
    """
    if not 0 < length < np.inf or ridges < 1:
        raise SceneError(
            f"contact length is {length:g} m on {show(ridges)} ridges; it must be greater than 0, on at least 1"
        )
    return Footprint(dict.fromkeys(STATES, length), dict.fromkeys(STATES, ridges), True, "contact length as given")


def from_run(scene: Scene, folder: Path) -> Footprint:
    """Return the contact of a full run of the scene, perhaps with another mesh, friction or roughness.

    Raises:
        SceneError: there is no run, it did not reach full slip, or it is one of another finger, force or voltage.
    """
    try:
        return _of_summary(scene, folder, read_object(folder / "summary.json"))
    except SceneError:
        raise
    except (FileNotFoundError, NotADirectoryError):
        raise SceneError(f"{folder} is not a folder of a finished run") from None
    except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:  # JSON of other things
        raise SceneError(f"run {folder} cannot be read: {error}") from None


def _of_summary(scene: Scene, folder: Path, summary: Mapping[str, Any]) -> Footprint:
    if "parameters" not in summary:  # a point of a sweep that was refused
        raise SceneError(f"run {folder} has no results: {summary.get('failure', 'summary.json is of another kind')}")
    if (model := summary.get("model", DEFAULT_MODEL)) != DEFAULT_MODEL:
        raise SceneError(f"run {folder} is one of the model {show(model)}; give a full run")
    for name, own, unit in (("f_ext", scene.f_ext, "N/m"), ("voltage", scene.volts, "V")):
        if not np.isclose(abs(summary[name]), abs(own), rtol=1e-6, atol=1e-9):
            raise SceneError(
                f"run {folder} is one at {name} {summary[name]:g} {unit}, and the scene's is {own:g}; "
                "give a run of this scene"
            )
    from fingerpad.results.folder import difference  # of runs' folders, which the closed form itself does not read

    other = difference(_finger(summary["parameters"]), _finger(scene.parameters()))
    if other:
        raise SceneError(f"run {folder} is one of another finger ({other}); give a run of this scene's finger")
    length = {state: summary.get(f"{state}_contact_length") for state in STATES}
    ridges = {state: summary.get(f"{state}_ridges_in_contact") for state in STATES}
    if None in (*length.values(), *ridges.values()):
        raise SceneError(f"run {folder} did not reach full slip, so that its contact length there is not known")
    return Footprint(length, ridges, True, f"contact length of the run in {folder}")  # type: ignore[arg-type]


def _finger(parameters: Mapping[str, Any]) -> dict[str, Any]:
    """Return the parameters of a scene that make its finger, as a file holds them."""
    own = {name: law for name, law in parameters.get("laws", {}).items() if name in ("mesh", "materials")}
    shape = {name: parameters[name] for name in ("geometry", "materials")}
    return dict(json.loads(json.dumps(shape | {"laws": own})))
