"""Laws of one's own in runs, in the reduced models and in the rule of thumb; limits of friction, and closures."""

from dataclasses import dataclass

import numpy as np
import pytest
import ufl

import fingerpad as fp
from fingerpad.model.simulation import Simulation
from fingerpad.reduced import cylinders
from fingerpad.scene import Scene, from_data
from tests.runs import followed
from tests.small_finger import NINE, small
from tests.test_laws import DERJAGUIN, OWN, Held
from variational.contact.friction import CONE_ROUNDOFF, Coulomb, Friction
from variational.roughness.closure import AirGap, check
from variational.solvers.coupling import Coupling

SMALL = NINE | {"f_ext": 1.0, "voltage": 100.0, "slide_length": 1e-3, "output": {"errors": False, "receptors": False}}


# -- limits ----------------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Cap(Friction):
    """A sharp limit, by the type of p as docs/laws.md has it."""

    mu_f: float = 0.5
    tau: float = 20e3

    def limit(self, p):
        least = ufl.min_value if isinstance(p, ufl.core.expr.Expr) else np.minimum
        return least(self.mu_f * p, self.tau)


@pytest.mark.slow
@pytest.mark.parametrize(("f_ext", "ratio"), [(200.0, 1.11), (2000.0, 1.03)])
def test_limit_with_other_functions_than_arithmetic(f_ext, ratio):
    """A cap that bears all along the contact: its strength is per reference area, which docs/laws.md compares."""
    scene = small(f_ext=f_ext, voltage=0.0, output={"receptors": False, "errors": False})
    slip = fp.run(scene.replace(friction=Cap(10.0, 1e3))).full_slip
    assert slip.f_t / (1e3 * slip.contact_length) == pytest.approx(ratio, abs=0.01)


# -- laws of one's own in the reduced models, and in the rule of thumb -----------------------------------------------
def test_cylinders_take_any_friction_law():
    """f_T is the limit at each state's mean pressure over its length. Tolerance: roundoff."""
    for law in (DERJAGUIN, OWN["friction"], Coulomb(0.25)):
        slip = cylinders.solve(Scene(friction=law)).full_slip
        length = slip.contact_length
        assert slip.f_t == pytest.approx(law.limit(slip.f_contact / length) * length, rel=1e-14)
        assert slip.mu_app == pytest.approx(slip.f_t / 75.0, rel=1e-14)


def test_cylinders_take_any_closure():
    """Each ridge is Maugis's cylinder at the closure's own gap."""
    found = cylinders.solve(Scene(roughness=Held()))
    assert found.record["full_slip_d_eq"] == 2e-6
    assert found.full_slip.f_electrostatic != cylinders.solve(Scene()).full_slip.f_electrostatic


# -- closures --------------------------------------------------------------------------------------------------------
class Shape(Held):
    def __call__(self, p_c):
        return AirGap(np.array([1e-6, 1e-6]))


class Failing(Held):
    def __call__(self, p_c):
        raise KeyError("no such pressure")


@pytest.mark.parametrize(
    ("closure", "sentence"),
    [
        (Shape(), r"closure Shape returns air gaps of shape \(2,\) for pressures of shape"),
        (Failing(), "closure Failing cannot be evaluated: .*no such pressure"),
        (lambda p_c: p_c, "it must be a Closure, with p_c in and an AirGap out"),
        (Held(0.0), "an air gap of 0 m at a pressure of 0 Pa; it must be finite and greater than 0"),
    ],
)
def test_what_is_no_closure_is_refused(closure, sentence):
    with pytest.raises(ValueError, match=sentence):
        check(closure)
    with pytest.raises(ValueError, match=sentence):
        Coupling(None, None, closure)


@pytest.fixture(scope="module")
def slid() -> Simulation:
    """A small finger with a closure, a dermis and a friction law of one's own, pressed, charged and slid."""
    scene = from_data(SMALL | OWN)
    simulation = followed(scene)
    return simulation


@pytest.mark.slow
@pytest.mark.mpi
def test_finger_of_own_laws_reaches_full_slip(slid):
    """f_T is the sum of the limits of its points. Tolerance: forces left at nodes, roundoff of the limit."""
    state, limit = slid.states[-1], float(slid.finger.ridge_loads().f_limit.sum())
    assert state.all_slip
    assert state.f_t == pytest.approx(limit, abs=slid.finger.force_error + CONE_ROUNDOFF * limit)
    assert state.f_contact - state.f_electrostatic == pytest.approx(1.0, abs=slid.finger.force_error)


@pytest.mark.slow
@pytest.mark.mpi
def test_energies_of_own_laws_balance(slid):
    """What friction spends is positive, and steps that do not jump release little of it."""
    sliding = [state.record for state in slid.states if state.load == "slide" and not state.record.jump]
    spent = sum(record.dissipation for record in sliding)
    assert spent > 0
    assert sum(abs(record.energy_released) for record in sliding) < 0.1 * spent
