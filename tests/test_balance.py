"""What every run is checked for: balance of forces, and the cone of friction at full slip."""

from contextlib import nullcontext
from types import SimpleNamespace

import numpy as np
import pytest

from fingerpad.model.state import broken, refuse_strained, refuse_unbalanced
from tests.measures import contact_state
from variational.contact.nitsche import Nitsche
from variational.contact.penalty import Penalty
from variational.solvers.continuation import StepFailed
from variational.state import ContactState, StepRecord

PENALTY = Penalty(1e12, 1e11)
LEFT = 1e-4  # N/m, what the solves leave of a sum of forces
SLIP = {"f_contact": 100.0, "f_electrostatic": 25.0, "f_ext": 75.0, "f_t": -25.0, "voltage": 200.0, "mu_app": 1 / 3}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({}, ""),
        ({"f_ext": 75.0 + 0.9 * LEFT}, ""),
        ({"f_ext": 75.0 + 1.1 * LEFT}, "out of balance by -0.00011 N/m"),
        ({"f_ext": 75.0 - 1.1 * LEFT}, "out of balance by 0.00011 N/m"),
        ({"f_t": 25.0 + 0.9 * LEFT}, ""),
        ({"f_t": 25.0 + 1.1 * LEFT}, "friction at full slip is 25.00011 N/m and its limit 25 N/m"),
        ({"f_t": 1.1 * LEFT - 25.0}, "friction at full slip is 24.99989 N/m and its limit 25 N/m"),
    ],
)
def test_balance_and_cone(change, words):
    """The limit is what the solves leave of a sum of forces; roundoff of the cone is 0.25 % of it."""
    slip = contact_state(**(SLIP | change))
    found = broken(slip, LEFT, 0.25)
    assert words in found and bool(found) == bool(words)
    assert broken(None, LEFT, 0.25) == ""


@pytest.mark.parametrize(
    ("floor", "words"), [(0.0, "try a numerics.tolerance below 1e-09"), (1e-7, "leaves 7.5e-06 N/m")]
)
def test_forces_left_at_a_node(floor, words):
    """Where the solve ended at its roundoff no tolerance helps, and none is named."""
    with pytest.raises(StepFailed, match=f"^here: a force of 0.00075 N/m is left at a node; .*{words}"):
        refuse_unbalanced("here", 1e-5, None, None, 75.0, 1e-9, floor)


@pytest.mark.parametrize(
    ("node", "sideways", "down", "words"),
    [
        (0.9, 0.9, -0.9, ""),
        (1.1, 0.0, 0.0, "is left at a node"),
        (0.0, -1.1, 0.0, "bears 25 N/m sideways and the screen 24.9999175 N/m"),
        (0.0, 0.0, 1.1, "bears 75 N/m downwards and the screen 75.0000825 N/m"),
    ],
)
def test_limit_of_what_is_left(node, sideways, down, words):
    """A millionth of 75 N/m, at a node and between the two ridges on the screen and the bone."""
    friction, contact, attraction = [20.0, 5.0 + sideways * 75e-6], [60.0, 40.0 + down * 75e-6], [15.0, 10.0]
    parts = {"f_friction": friction, "f_contact": contact, "f_attraction": attraction, "f_adhesion": [0.0, 0.0]}
    loads = SimpleNamespace(**{name: np.array(values) for name, values in parts.items()})
    refused = pytest.raises(StepFailed, match=f"^here: .*{words}") if words else nullcontext()
    with refused:
        refuse_unbalanced("here", node * 1e-6, loads, np.array([25.0, 75.0]), 75.0, 1e-9, 0.0)


def record(stored: float) -> StepRecord:
    return StepRecord(
        penetration=0.0, imbalance=0.0, floor=0.0, stored=stored, dissipation=0.0, energy_released=0.0,
        released_error=0.0, newton_iterations=1, factorisations=1, coupling_iterations=0, cutbacks=0, jump=False,
    )  # fmt: skip


def state(f_contact: float, stored: float) -> ContactState:
    return contact_state(**(SLIP | {"f_contact": f_contact, "record": record(stored)}))


class Own(Penalty):
    """A formulation with a remedy of its own."""

    unloaded_energy = "try a softer eps_n"


def test_body_without_loads_stores_nothing():
    """Nitsche's method may keep a tenth of the energy; less than a millionth is roundoff, as is all before a load.

    The unloaded skin is on the screen, and may bear roundoff there.
    """
    unloaded, pressed = state(1e-12, 1e-40), state(100.0, 1e-5)
    refuse_strained("step 3 (lift)", record(0.5e-11), [unloaded, pressed], 75.0, PENALTY)
    with pytest.raises(StepFailed, match="nothing loads"):
        refuse_strained("step 3 (lift)", record(2e-11), [unloaded, pressed], 75.0, PENALTY)
    refuse_strained("step 2 (lower)", record(1e-30), [unloaded], 75.0, PENALTY)
    remedies = {Nitsche(20.0, 1): "larger", PENALTY: "second state without stress", Own(1e12, 1e11): "softer eps_n"}
    for formulation, remedy in remedies.items():
        with pytest.raises(StepFailed, match=rf"^step 3 \(lift\): nothing loads .* stores 1e-06 J/m; .*{remedy}"):
            refuse_strained("step 3 (lift)", record(1e-6), [unloaded, pressed], 75.0, formulation)
