"""Estimated errors of runs with a requested accuracy against known errors.

environment/run python3 -m benchmarks.accuracy [--jobs 2] [--draw]     after benchmarks.errors; an hour of one core

Scenes with an ``[accuracy]``, ten of them drawn at random, against their limits on finer meshes (benchmarks/limits.py),
with the same penalty. Writes docs/accuracy.json and docs/errors.md. fingerpad/accuracy/richardson.py takes its
factors of safety from them; tests/test_calibration.py checks the coverage.
"""

import sys
from collections.abc import Iterable, Mapping
from dataclasses import asdict, dataclass
from operator import attrgetter
from pathlib import Path
from typing import Any

import numpy as np

from benchmarks import harness, limits
from benchmarks.errors import DEFAULT, LEVELS, STATES, parted
from benchmarks.limits import Limit
from fingerpad.accuracy.richardson import MORE, ONCE
from fingerpad.model.options import by_rule, check
from fingerpad.runs.batch import Summary
from fingerpad.scene import Scene, SceneError, load, start
from fingerpad.scene.parameters import Accuracy

_LIMIT = 7200.0  # s of processor time for one scene
_SHORT = {
    "mu_app": "µ_app",
    "f_t": "f_T",
    "contact_length": "contact length",
    "p_max": "highest pressure",
    "sed": "SED",
}
_TEN = ({"mu_app": 0.01, "contact_length": 0.03}, {"sed": 0.05})  # requested of each scene drawn
_DEFAULT = ({"mu_app": 0.01}, _TEN[0], {"contact_length": 0.01}, _TEN[1])  # of the default scene
_LEVELS = 3  # meshes of the limits of the scenes drawn; a fourth would take twice as long as all else on the page
SEED, COUNT = 2023, 10
_RANGES = {"f_ext": (10.0, 120.0), "voltage": (0.0, 200.0), "friction": (0.15, 0.5)}  # N/m, V
_QUARTER = (
    *("geometry.sc_thickness", "geometry.ridge_amplitude", "geometry.bone_width", "geometry.dermis_thickness"),
    *("materials.subcutis.shear_modulus", "materials.stratum_corneum.shear_modulus"),
    *("roughness.h_rms", "roughness.young", "electric.eps_sc"),
)
WANTED = 0.9  # of the cases of each kind
KINDS = {
    "friction": ("µ_app", "f_T"),
    "contact length": ("contact length",),
    "highest pressure": ("highest pressure",),
    "energy density": ("SED",),
}
WHOLE = "whole run"


# -- cases ---------------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Case:
    """An estimate whose error is known; numbers in per cent of the limit."""

    source: str  # WHOLE
    scene: str
    quantity: str
    once: bool  # every size was halved or doubled once
    estimate: float  # without a factor of safety
    error: float
    bar: float  # of the error
    allowed: float | None = None  # requested accuracy

    kind = property(lambda self: next(k for k, words in KINDS.items() if any(w in self.quantity for w in words)))
    clear = property(lambda self: self.error > self.bar, doc="Whether the error is larger than its uncertainty.")
    factor = property(lambda self: ONCE if self.once else MORE, doc="The smallest factor of safety of its sizes.")

    def covered(self, factor: float) -> bool:
        """Return whether the error is at most ``factor`` times the estimate."""
        return self.error <= factor * self.estimate


def kept(docs: Path = harness.DOCS) -> list[Case]:
    """Return the cases of docs/accuracy.json."""
    return [Case(**each) for each in harness.kept("accuracy", docs).numbers["cases"] if each["source"] == WHOLE]


def coverage(cases: Iterable[Case], kind: str | None = None, once: bool | None = None) -> tuple[int, int, int]:
    """Return the numbers of clear cases, all or some, of those covered by the estimate, and with its factor."""
    mine = [case for case in cases if case.clear and kind in (None, case.kind) and once in (None, case.once)]
    return len(mine), sum(case.covered(1.0) for case in mine), sum(case.covered(case.factor) for case in mine)


# -- scenes --------------------------------------------------------------------------------------------------
def drawn() -> dict[str, Scene]:
    """Return :data:`COUNT` scenes by number, force, voltage and friction; a finger that cannot be built is redrawn."""
    random, found = np.random.default_rng(SEED), dict[str, Scene]()
    while len(found) < COUNT:
        values = {key: random.uniform(*span) for key, span in _RANGES.items()}
        values |= {key: attrgetter(key)(Scene()) * random.uniform(0.75, 1.25) for key in _QUARTER}
        scene = by_rule(load(None, {key: float(f"{value:.3g}") for key, value in values.items()}))
        try:
            check(scene)
        except SceneError:
            continue
        found[f"{len(found) + 1}: {scene.f_ext:g} N/m, {scene.voltage:g} V, friction {scene.friction:g}"] = scene
    return found


def with_accuracy(scene: Scene, **tolerances: float) -> Scene:
    """Return a scene with a requested accuracy, on the coarse mesh where its refinement starts."""
    mesh = scene.mesh.model_copy(update=start(tolerances))
    return scene.model_copy(update={"accuracy": Accuracy(**tolerances), "mesh": mesh})


def loops() -> dict[str, tuple[Scene, str]]:
    """Return by name the scenes with an accuracy, each with the name of the scene whose limit is its own."""
    pairs = [("default scene", DEFAULT, request) for request in _DEFAULT]
    pairs += [(name, scene, request) for request in _TEN for name, scene in drawn().items()]
    found = {"default scene as it is": (DEFAULT, "default scene")}
    for name, scene, request in pairs:
        words = ", ".join(f"{_SHORT[quantity]} {100 * value:g} %" for quantity, value in request.items())
        found[f"{name}; {words}"] = with_accuracy(scene, **request), name
    return found


# -- numbers -------------------------------------------------------------------------------------------------
def _title(name: str) -> str:
    state, quantity = parted(name)
    words = f"SED at ridge {quantity[4:]}" if quantity.startswith("sed_") else _SHORT[quantity]
    return f"{words}, {STATES[state]}"


def judged(scene: str, summary: Summary, ends: Mapping[str, Limit]) -> list[Case]:
    """Return the cases of a whole run: friction, contact lengths, and the worst energy density of each state."""
    quantities, found = summary["accuracy"]["quantities"], dict[str, Case]()
    request = any(q["allowed"] is not None for q in quantities.values())
    # Contact and bulk; steps, which lengths and energies of normal contact depend on; the sites.
    parameters = 2 + ("SED" in scene) + ("SED" in scene or "contact length" in scene)
    once = not request or len(summary["accuracy"]["solves"]) == 1 + parameters
    for name, q in quantities.items():
        sites = "_sed_" in name
        if name not in ends or name == "full_slip_f_t" or (sites and request and q["allowed"] is None):
            continue  # the last: the sites are coarse where an accuracy was requested of others alone
        end, of = ends[name], abs(ends[name].value)
        if sites:  # over the largest of the state
            state = name.split("sed_")[0]
            of = max(abs(each.value) for other, each in ends.items() if other.startswith(f"{state}sed_"))
        estimate, error, bar = (100 / of * v for v in (q["estimate"], abs(q["value"] - end.value), end.bar))
        allowed = None if q["allowed"] is None else 100 * q["allowed"] / of
        found[name] = Case(WHOLE, scene, _title(name), once, estimate, error, bar, allowed)
    worst = {parted(name)[0]: name for name in sorted(found, key=lambda n: found[n].error) if "_sed_" in name}
    return [case for name, case in found.items() if "_sed_" not in name or name in worst.values()]


def compute(args: Any) -> None:
    """Run what is missing and keep the numbers."""
    wanted = loops()
    summaries = harness.run({name: scene for name, (scene, _) in wanted.items()}, args, _LIMIT)
    ends = limits.solve_all({"default scene": DEFAULT}, LEVELS, args) | limits.solve_all(drawn(), _LEVELS, args)
    cases = list[Case]()
    for name, (_, plain) in wanted.items():
        if "failure" not in summaries[name] and "failure" not in ends[plain]:
            cases += judged(name, summaries[name], limits.limits(ends[plain]))
    numbers = {"cases": [asdict(case) for case in cases]}
    harness.keep("accuracy", numbers, harness.made(summaries.values()), args.docs)


# -- page ----------------------------------------------------------------------------------------------------
def draw(docs: Path) -> Path:
    """Draw the page from the kept numbers."""
    names = dict(zip(("n", "bare", "safe"), coverage(kept(docs)), strict=True))
    return harness.page(docs, "accuracy", "python3 -m benchmarks.accuracy", globals() | names)


if __name__ == "__main__":
    sys.exit(harness.main(__doc__, compute, draw))
