"""The fingers of the page, by the names that findings give, and their runs: shared by all rows, kept by their scenes.

A finger slides without voltage and then under 200 V, which falls in sliding, at each of :data:`FORCES` on two meshes.
It is also pressed under voltage and, where rows ask for it, softened, held and lifted. Whole fingers are sums of
slices.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from functools import cached_property
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from benchmarks.measured.findings import Finding
from benchmarks.runs import Run, Unfinished
from fingerpad.scene import Scene, SceneError, with_values
from fingerpad.scene.fingers import FINGERS
from fingerpad.scene.materials import LAYERS
from fingerpad.scene.viscosity import viscous_layers
from fingerpad.slices.total import Total, at_force, profile
from fingerpad.slices.trace import trace
from variational.state import ContactState

Array = NDArray[np.float64]
NAMES = ("fitted", "moist", "held", "paper")
FORCES = (5.0, 20.0, 75.0, 150.0)  # N/m
FORCE = 75.0  # N/m, of what is run at one force
VOLTAGES = (0.0, 50.0, 100.0, 150.0, 200.0)
HIGH = VOLTAGES[-1]
NEWTONS = (0.05, 0.1, 0.2, 0.3, 0.5, 0.75, 1.0, 1.25, 1.5, 2.0)  # N, as far as the traces go
SIZES = (60e-6, 30e-6)  # m, contact sizes; the difference of their numbers is the stated error
SOFTER = (2.0, 4.0)  # times, by which the stratum corneum is softened
ROUGHER = 1.0  # friction coefficient beside that of the finger
GROWS = 20.0  # s, for which the contact on glass was seen to grow
SOFT = [name for name in LAYERS if not name.startswith("nail")]
_LIFTED = 50e-6  # m above the first contact, to which a finger is lifted
_LEAST = 3  # forces of which a finger's rows are made


def _history(force: float, timed: bool) -> list[dict[str, Any]]:
    press: list[dict[str, Any]] = [{"name": "press", "f_ext": force}]
    hold = [{"name": "hold", "f_ext": force, "duration": GROWS}] if timed else []
    slides = [{"name": "slip 0", "bone_x_by": 3e-3, "until_full_slip": True}, {"name": "charge", "voltage": HIGH}]
    slides += [{"name": f"slip {HIGH:g}", "bone_x_by": 4e-3, "until_full_slip": True}]
    return press + hold + slides + [{"name": f"slip {u:g}", "voltage": u, "bone_x_by": 1e-4} for u in VOLTAGES[3:0:-1]]


def scenes(name: str) -> dict[str, Scene]:
    """Return the scenes of a finger by kind and contact size (µm): ``slide 75 20``, ``charge 20``, ``soft 2 20``."""
    one = with_values(Scene(), FINGERS[name].values)  # without its name: fingers of one kind share their runs
    friction, viscous = one.friction_law(), bool(viscous_layers(one.materials))
    timed = name == "held" and (viscous or bool(friction and friction.times))
    charged = [{"name": f"press {f:g}", "f_ext": f, "voltage": HIGH} for f in FORCES]
    press = [{"name": "press", "f_ext": FORCE}]
    kinds: dict[str, dict[str, Any]] = {f"slide {f:g}": {"history": _history(f, timed)} for f in FORCES}
    kinds["charge"] = {"history": charged}
    if name == "fitted":
        modulus = one.materials.stratum_corneum.shear_modulus  # type: ignore[union-attr]
        for softer in SOFTER:
            layers = {"stratum_corneum": {"shear_modulus": modulus / softer}}
            kinds[f"soft {softer:g}"] = {"materials": layers, "history": press}
        kinds["rough"] = {"friction": ROUGHER, "history": press}
    if name == "held":
        layers = {} if viscous else {each: {"viscosity": {"preset": "fingerpad"}} for each in SOFT}
        hold = {"name": "hold", "f_ext": FORCE, "duration": GROWS}
        kinds["hold"] = {"materials": layers, "history": [*press, hold]}
    if name in ("fitted", "moist") and adheres(one):
        kinds["lift"] = {"history": [*press, {"name": "lift", "bone_height": _LIFTED}]}
    mesh, output = {"receptor": 60e-6, "interface": 120e-6, "growth": 0.5}, {"receptors": False, "errors": False}
    return {
        f"{kind} {1e6 * size:g}": one.replace(mesh={"contact": size} | mesh, output=output, **more)
        for size in SIZES
        for kind, more in kinds.items()
    }


def adheres(scene: Scene) -> bool:
    """Return whether skin adheres without a voltage."""
    return getattr(getattr(scene, "adhesion", None), "work", 0.0) > 0


@dataclass(frozen=True)
class Finger:
    """A finger's runs that reached their ends, on one of the two meshes."""

    scene: Scene
    runs: Mapping[str, Run]
    size: float = SIZES[-1]

    @property
    def coarse(self) -> "Finger":
        """The same finger on the coarser mesh."""
        return replace(self, size=SIZES[0])

    def run(self, kind: str) -> Run:
        """Return a run; Unfinished where it is not there."""
        name = f"{kind} {1e6 * self.size:g}"
        if name not in self.runs:
            raise Unfinished(f"{name} did not reach its end")
        return self.runs[name]

    def path(self, kind: str, load: str) -> list[ContactState]:
        """Return the states of a load of a run."""
        return [state for state in self.run(kind).result.steps if state.load == load]

    @cached_property
    def forces(self) -> tuple[float, ...]:
        """Forces (N/m) whose slides reached full slip on both meshes.

        Raises:
            Unfinished: there are fewer than three.
        """
        found = tuple(f for f in FORCES if all(replace(self, size=size)._slips(f) for size in SIZES))
        if len(found) < _LEAST:
            raise Unfinished(f"full slip was reached at {len(found)} of {len(FORCES)} forces")
        return found

    def _slips(self, force: float) -> bool:
        try:
            return all(self.path(f"slide {force:g}", f"slip {u:g}")[-1].all_slip for u in (0.0, HIGH))
        except Unfinished:
            return False

    @property
    def pressed(self) -> list[ContactState]:
        """States of the press under the largest force."""
        return self.path(f"slide {max(self.forces):g}", "press")

    def rest(self, voltage: float = 0.0) -> list[ContactState]:
        """Return the states at rest, without voltage or under :data:`HIGH`, at each force; held as long as a slide."""
        if voltage:
            return [self.path("charge", f"press {f:g}")[-1] for f in self.forces]
        found = [[s for s in self.run(f"slide {f:g}").result.steps if s.load in ("press", "hold")] for f in self.forces]
        return [each[-1] for each in found]

    def slip(self, voltage: float = 0.0) -> list[ContactState]:
        """Return the states of full slip at each force."""
        return [self.path(f"slide {f:g}", f"slip {voltage:g}")[-1] for f in self.forces]

    def slips(self, key: str) -> Array:
        """Return a quantity of full slip, of shape (forces, voltages)."""
        return np.array([[getattr(state, key) for state in self.slip(u)] for u in VOLTAGES]).T

    @cached_property
    def mu(self) -> Array:
        """Friction coefficient without voltage at each force."""
        return self.slips("f_t")[:, 0] / np.array(self.forces)

    def whole(self, states: Sequence[ContactState]) -> dict[float, Total]:
        """Return the sums over the slices of the whole finger by force (N), as far as the states reach."""
        traced, along = trace(states, self.scene.geometry.ridge_wavelength), profile(self.scene.slices)
        found = {}
        for force in NEWTONS:
            try:
                found[force] = at_force(along, traced, force, self.scene.slices.count)
            except SceneError:  # beyond the trace
                break
        return found

    def sums(self, states: Sequence[ContactState], name: str, least: float = 0.0) -> tuple[Array, Array]:
        """Return forces (N) from a least one on, and a sum at each; Unfinished where there are fewer than three."""
        totals = {force: total for force, total in self.whole(states).items() if force >= least}
        if len(totals) < _LEAST:
            raise Unfinished(f"the traces reach {len(totals)} forces from {least:g} N on")
        return np.array(list(totals)), np.array([each.values[name] for each in totals.values()])

    def at(self, states: Sequence[ContactState], name: str, force: float) -> float:
        """Return a sum at a force (N); Unfinished where the states do not reach it."""
        totals = self.whole(states)
        if force not in totals:
            raise Unfinished(f"the traces end below {force:g} N")
        return float(totals[force].values[name])


class Case(NamedTuple):
    """A finding with the finger that it names, and all fingers."""

    row: Finding
    finger: Finger
    every: Mapping[str, Finger]


Row = tuple[dict[str, float], str]
"""Numbers of a finding by name, and its verdict."""
Computation = Callable[[Case], Row]


def fingers(names: Iterable[str], out: Path) -> dict[str, Finger]:
    """Return fingers with those of their runs that a folder has."""
    found = {}
    for name in names:
        every, runs = scenes(name), dict[str, Run]()
        for kind, scene in every.items():
            with suppress(Unfinished):
                runs[kind] = Run(scene, out)
        found[name] = Finger(next(iter(every.values())), runs)
    return found
