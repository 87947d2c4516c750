"""A whole finger led by its half until the bone moves sideways: the same states, and where there is none."""

from dataclasses import dataclass, replace

import pytest
import ufl
from mpi4py import MPI

from fingerpad.model import simulation
from fingerpad.model.options import FingerModel, by_rule, plan
from fingerpad.model.simulation import Simulation
from fingerpad.scene import from_data
from tests.runs import followed
from tests.small_finger import NINE
from variational.materials.neo_hooke import NeoHooke

pytestmark = pytest.mark.slow
CLOSE = 1e-5  # relative: air gaps are within 1e-6
HISTORY = [
    {"name": "press", "f_ext": 1.0},
    {"name": "charge", "voltage": 100.0},
    {"name": "slide", "bone_x": 60e-6},
    {"name": "back", "bone_x": 0.0},
]


BRIEF = [HISTORY[0], {"name": "slide", "bone_x": 5e-6}]


def model(history, led: bool = True) -> FingerModel:
    """Return a small finger's model, led by its half or not."""
    scene = by_rule(from_data(NINE | {"history": history}))
    needed = plan(scene)
    assert needed.symmetric_start
    return FingerModel(scene, replace(needed, symmetric_start=led))


FOLLOWED: dict[str, Simulation] = {}


def follow(history, led: bool) -> Simulation:
    """Return a small finger's path, led by its half or not; each path is followed once."""
    key = str((history, led))
    if key not in FOLLOWED:
        path = Simulation(model(history, led), MPI.COMM_WORLD)
        assert path.run() is None
        FOLLOWED[key] = path
    return FOLLOWED[key]


@pytest.mark.parametrize(
    "history",
    [
        pytest.param(HISTORY, id="press, charge, slide"),
        pytest.param([{"name": "lower", "bone_height": -60e-6}, *HISTORY[2:]], id="bone height", marks=pytest.mark.mpi),
        pytest.param([HISTORY[0], {"name": "lift", "f_ext": 0.2}, HISTORY[1], BRIEF[1]], id="lift"),
    ],
)
def test_half_leads_to_the_states_of_the_whole(history):
    led, whole = (follow(history, half).states for half in (True, False))
    assert [state.load for state in led] == [state.load for state in whole]
    for mine, other in zip(led, whole, strict=True):
        for name in ("f_ext", "bone_height", "f_contact", "f_electrostatic", "contact_length", "slipping"):
            assert getattr(mine, name) == pytest.approx(getattr(other, name), rel=CLOSE, abs=1e-12), name
        assert mine.f_t == pytest.approx(other.f_t, rel=CLOSE, abs=1e-7)
        assert mine.ridges.d_eq == pytest.approx(other.ridges.d_eq, rel=CLOSE, nan_ok=True)


def test_stability_is_examined_on_the_whole_finger(monkeypatch):
    """Where the symmetric state is not stable the result says so; a whole finger's would be symmetric, too."""
    checks, examined = simulation.StabilityChecks.check, []

    def unstable(self, load):
        found = checks(self, load)
        assert self._finger.options.both_halves
        examined.append(load)
        return replace(found, frozen=replace(found.frozen, lambda_min=-1.0))

    monkeypatch.setattr(simulation.StabilityChecks, "check", unstable)
    path = Simulation(model(HISTORY[:3]), MPI.COMM_SELF)
    assert path.run() is None
    assert examined[:2] == ["press", "charge"]


@pytest.mark.mpi
def test_mixed_element_is_in_balance_on_the_whole_finger():
    """The pressure comes over with the displacement. Solved for again it left up to 5e-8, with a floor of 0."""
    layers = {layer: {"poisson": 0.4999} for layer in ("stratum_corneum", "viable_epidermis", "dermis")}
    scene = NINE | {"history": BRIEF, "numerics": {"element": "P2-P1"}, "materials": layers}
    scene = by_rule(from_data(scene))
    assert plan(scene).symmetric_start
    path = followed(scene)
    tolerance = scene.numerics.tolerance
    assert [state.record.imbalance for state in path.states if state.record.imbalance > tolerance] == []
    assert [state.record.floor for state in path.states] == [0.0] * len(path.states)


@dataclass(frozen=True)
class Fibres(NeoHooke):
    """Fibres at an angle, which the mirror turns round."""

    stiffness: float = 1e3

    def energy(self, F):
        along = F * ufl.as_vector([0.6, 0.8, 0.0])
        return super().energy(F) + self.stiffness / 2 * (ufl.inner(along, along) - 1) ** 2


@pytest.mark.parametrize(("history", "moves"), [(HISTORY, True), (HISTORY[:2], False)])
def test_no_half_where_the_finger_is_not_its_own_mirror_image(history, moves):
    """An own material may have fibres at an angle; one of the program's may not."""
    scene = from_data(NINE | {"history": history})
    straight, inclined = (
        plan(scene.replace(materials={"dermis": solid})) for solid in (NeoHooke(2.5e3), Fibres(2.5e3))
    )
    assert (straight.both_halves, straight.symmetric_start) == (moves, moves)
    assert (inclined.both_halves, inclined.symmetric_start) == (True, False)
