r"""A finger's press without voltage: what its closed form has of geometry, layers and contact.

A :class:`Press` has the length in contact, the ridges in contact and the indentation over the external force. It does
not depend on voltage, coating, roughness or friction. So the closed form of :mod:`fingerpad.reduced.cylinders` answers
for every scene whose finger has one, whatever its shape and layers are.

Those of the default finger and of the fingers by name are data of the package (``presses.json``); others are made once
(:mod:`fingerpad.runs.press`) and kept in the user's cache folder, ``FINGERPAD_CACHE``, under a hash of the scene's
tables ``geometry``, ``materials`` and ``contact``.

The default finger's is of full runs on facets of 10 µm up to 150 N/m, at full slip with a friction coefficient of 0.25
(docs/models.json), and beyond by ratios of states on a coarser mesh (docs/loads.json); ``benchmarks.models`` and
``benchmarks.loads`` print the numbers. Other presses have no full slip.

A person drawn from the spreads (:mod:`fingerpad.scene.people`) has the press of the finger by name: with lengths s and
moduli m times its own, :math:`L(f) = s\,L_1(f / (s m))`. *Assumption*: the nail, of one modulus, is rigid.

**Rolling.** Friction shears a finger, its bone rises, and ridges leave the screen, while those in contact keep their
length. The part of the contact that is left is even in the friction force. In full runs of two flat fingers, over
forces, voltages and laws of friction, it is about

.. math:: 1 - \frac{f_T^2}{f_{ext} F}, \qquad F = 270 \text{ N/m}.

*Assumption*: so for other fingers without a full slip. F (:data:`ROLL`) is a fit (docs/closed_form.md).
"""

import json
import math
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import asdict, dataclass, replace
from functools import cache
from hashlib import sha256
from importlib.resources import files
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import ArrayLike, NDArray

from fingerpad.results.files import replace_json
from fingerpad.scene.messages import SceneError, show
from fingerpad.scene.people import PLACES, with_factors
from fingerpad.scene.scene import Scene
from variational.roughness import gaps
from variational.state import ContactState

Array = NDArray[np.float64]
FORCES = (2.0, 3.86, 7.45, 14.4, 27.8, 53.6, 104.0, 200.0)
"""External forces (N/m) of presses that are made."""
MESH = {"contact": 1 / 24, "receptor": 1 / 8, "interface": 1 / 4}
"""Element sizes of the path over the wavelength of the ridges."""
FINE = 1 / 12
"""Facets in contact of the states, on which they are solved again, over the wavelength; a sixteenth where it ends."""
ROLL = 270.0
"""F (N/m)."""
KNOWN = 0.25
"""Friction coefficient whose shear the contact at full slip has."""
_ROLLS, _LEAST_LEFT = 20, 0.4  # iterations, and the least part of the contact that may be left
_TABLES = ("geometry", "materials", "contact")
_SITES = ("merkel_offset", "meissner_offset", "file", "file_sha256")  # of the geometry, without effect on a press
_VERSION = 1


@dataclass(frozen=True)
class Press:
    """The contact of a finger without voltage over growing external forces.

    By state, which is ``charged``, normal contact, and ``full_slip`` where that is known.
    """

    forces: tuple[float, ...]
    """External forces (N/m)."""
    lengths: Mapping[str, tuple[float, ...]]
    """Length in contact (m)."""
    ridges: Mapping[str, tuple[int, ...]]
    """Ridges in contact."""
    indentations: Mapping[str, tuple[float, ...]]
    """How far the bone is lowered (m)."""
    roll: float | Array = ROLL
    """F (N/m); of similar fingers that are solved for together one of each."""

    @classmethod
    def of(cls, kept: Mapping[str, Any]) -> "Press":
        """Return a press from its file."""
        columns: Any = ({state: tuple(values) for state, values in kept[name].items()} for name in _COLUMNS)
        return cls(tuple(kept["forces"]), *columns)

    @classmethod
    def of_states(cls, states: Sequence[ContactState]) -> "Press":
        """Return a press of normal contact under growing forces."""
        lengths, ridges, depths = zip(
            *((float(f"{x.contact_length:.6g}"), x.ridges_in_contact, float(f"{-x.bone_height:.6g}")) for x in states),
            strict=True,
        )
        forces = tuple(round(x.f_ext, 6) for x in states)
        return cls(forces, {"charged": lengths}, {"charged": ridges}, {"charged": depths})

    @property
    def slid(self) -> bool:
        """Whether it has full slip, of runs; elsewhere it has normal contact alone."""
        return "full_slip" in self.lengths

    def length(self, f_ext: ArrayLike, state: str) -> Array:
        """Return the contact length (m) under external forces (N/m) in a state."""
        return self._at(f_ext, self.lengths, state)

    def ridge_count(self, f_ext: ArrayLike, state: str, left: ArrayLike = 1.0) -> NDArray[np.int_]:
        """Return the number of ridges in contact, of which a part is left; arguments of :meth:`length`."""
        return np.maximum(np.rint(np.asarray(left) * self._at(f_ext, self.ridges, state)).astype(int), 1)

    def indentation(self, f_ext: ArrayLike, state: str) -> Array:
        """Return how far the bone is lowered (m), without voltage: with 200 V, at full slip, by up to 6 % more."""
        return self._at(f_ext, self.indentations, state)

    def lowered(self, states: Iterable[ContactState], state: str) -> list[ContactState]:
        """Return states of one kind with the indentations without voltage."""
        states = list(states)
        depths = self.indentation([each.f_ext for each in states], state)
        return [replace(each, bone_height=-float(depth)) for each, depth in zip(states, depths, strict=True)]

    def _at(self, f_ext: ArrayLike, by_state: Mapping[str, Sequence[float]], state: str) -> Array:
        """Return power laws through the two neighbours, at the ends through the last two; shape of the forces."""
        x, y, at = np.log(self.forces), np.log(by_state.get(state, by_state["charged"])), np.log(f_ext)
        k = np.clip(np.searchsorted(x, at) - 1, 0, len(x) - 2)
        return np.exp(y[k] + (y[k + 1] - y[k]) * (at - x[k]) / (x[k + 1] - x[k]))

    def left(self, limit: Callable[[Array], Array], force: Array, attraction: Any, length: Array) -> Array:
        """Return the part of the contact without friction that is left at full slip.

        Args:
            limit: of friction (Pa), at contact pressures (Pa).
            force: external forces (N/m).
            attraction: of the whole contact (N/m), which grows with the part that is left.
            length: of the whole contact (m), likewise.
        """
        part = np.ones_like(force)
        for _ in range(_ROLLS):
            f_t = limit(force / (part * length) + attraction / length) * part * length
            part = np.maximum(1 - f_t**2 / (force * self.roll), _LEAST_LEFT)
        return part


_COLUMNS = ("lengths", "ridges", "indentations")


def known(scene: Scene) -> Press | None:
    """Return the press of a scene's finger, None where it has not been made."""
    return _found(name(scene)) or _similar(scene)


def _similar(scene: Scene) -> Press | None:
    """Return the press of a person: that of the finger by name on other scales; None of any other finger."""
    middle, ends = Scene(finger=scene.finger), []
    for each in (scene, middle):
        ends.append((each.geometry.ridge_wavelength, getattr(each.materials.subcutis, "shear_modulus", math.nan)))
    size, stiffness = (round(mine / own, PLACES) for mine, own in zip(*ends, strict=True))
    try:
        if name(with_factors(middle, {"size": size, "stiffness": stiffness})) != name(scene):
            return None
    except SceneError:  # values that no finger has
        return None
    own, scale = of(middle), size * stiffness
    lengths, indentations = (
        {state: tuple(size * x for x in values) for state, values in by_state.items()}
        for by_state in (own.lengths, own.indentations)
    )
    return Press(tuple(scale * f_ext for f_ext in own.forces), lengths, own.ridges, indentations, scale * own.roll)


def of(scene: Scene) -> Press:
    """Return the press of a scene's finger.

    Raises:
        SceneError: it has not been made.
    """
    if (found := known(scene)) is not None:
        return found
    whose = f" {show(scene.finger)}" if "finger" in scene.model_fields_set else ""
    raise SceneError(
        f"the finger{whose} of this scene has no press yet, which its closed form needs; fp.press(scene) makes it, in "
        "about half a minute"
    )


def name(scene: Scene) -> str:
    """Return the name of the press of a scene's finger."""
    tables = scene.model_dump(mode="json", include=set(_TABLES))
    for site in _SITES:
        tables["geometry"].pop(site)
    made = [_VERSION, FORCES, MESH, FINE]
    return sha256(json.dumps([tables, made], sort_keys=True).encode()).hexdigest()[:16]


def file_of(scene: Scene) -> Path:
    """Return the file of a press of the user's cache."""
    return gaps.cache() / f"press_{name(scene)}.json"


def keep(scene: Scene, press: Press) -> None:
    """Write a press into the cache, in which later processes find it.

    Raises:
        SceneError: there is no room for it, or no permission.
    """
    file = file_of(scene)
    try:
        file.parent.mkdir(parents=True, exist_ok=True)
        replace_json(file, asdict(press))
    except OSError as error:
        raise SceneError(
            f"the press of this finger cannot be kept in {file.parent} ({error.strerror or error}); name another "
            "folder by FINGERPAD_CACHE"
        ) from None
    _found.cache_clear()


@cache
def shipped() -> Mapping[str, Any]:
    """Return the presses of the package by name."""
    return dict(json.loads((files("fingerpad.reduced") / "presses.json").read_text(encoding="utf-8")))


@cache
def _found(name: str) -> Press | None:
    if name in shipped():
        return Press.of(shipped()[name])
    try:
        return Press.of(json.loads((gaps.cache() / f"press_{name}.json").read_text(encoding="utf-8")))
    except (OSError, ValueError, KeyError, TypeError):
        return None
