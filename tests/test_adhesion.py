"""Adhesion without a voltage: its law, its weak form, pull-off by a closed form, energy, scenes and refusals."""

from dataclasses import dataclass, replace

import numpy as np
import pytest
from mpi4py import MPI
from scipy.integrate import trapezoid

import fingerpad as fp
from fingerpad.scene import SceneError
from fingerpad.slices.pull_off import PULL_OFF, with_pull_off
from geometry import tags
from geometry.bodies import block
from geometry.mesh import load
from tests.small_finger import NINE
from tests.test_problem import EPS_N, EPS_T, SKIN, direction, rates, taylor, wave
from variational.contact.interface import Interface
from variational.contact.nitsche import Nitsche
from variational.contact.penalty import Penalty
from variational.problem import Problem
from variational.surface import Surface

LAW = fp.Dugdale(3e3)
WIDTH = 1e-3  # m, of a block
LIFTED = {"name": "lift", "bone_height": 50e-6}


def test_work_is_the_integral_of_the_attraction():
    """Of p_0 to the distance, however it is smoothed. Tolerance: the trapezoidal rule's on a nanometre."""
    y = np.linspace(0, 5e-6, 5001)
    assert LAW.work == pytest.approx(6e-3, rel=1e-12)
    assert LAW.work == pytest.approx(float(trapezoid(LAW.pressure(y), y)), rel=1e-6)
    np.testing.assert_allclose(LAW.potential(np.array([-1e-6, 20e-3])), [-9e-3, 0.0], atol=1e-15)


@pytest.mark.parametrize("formulation", [Penalty(EPS_N, EPS_T), Nitsche(10.0, 1)], ids=["penalty", "nitsche"])
def test_jacobian(formulation):
    """The remainder of the residual falls with the square of the step, where skin touches, adheres and is beyond."""
    body = load(MPI.COMM_WORLD, block(WIDTH, 0.5e-3, 0.25e-3))
    surface = Surface(body.mesh, body.facet_tags, {0: tags.ridge(0)})
    interface = Interface(formulation, 0.25, 0.5e-6, None, adhesion=LAW)
    problem = Problem(body.mesh, body.cell_tags, surface, {tags.STRATUM_CORNEUM: SKIN}, interface)
    wave(problem)
    remainders, _ = taylor(problem, direction(problem))
    assert rates(remainders).min() > 1.9


@pytest.fixture(scope="module")
def bar():
    """A flat block that is pressed, slid, and lifted in steps of a tenth of the attraction at most."""
    body = fp.Body(fp.geometry.block(WIDTH, 0.5e-3, 0.25e-3), fp.Ogden(86.76e3, -14.53), friction=0.3, adhesion=LAW)
    body.press(2.0).slide(0.2e-3, until_full_slip=True)
    slid = body.state
    return slid, body.lift(30e-6)


def test_friction_of_load_and_adhesion(bar):
    """Coulomb's law takes what the screen bears, which adhesion is a part of (Derjaguin 1934).

    Tolerance of p_0 times the width: the load spreads the bottom by some tenths of a per cent.
    """
    slid, _ = bar
    assert slid.f_adhesion == pytest.approx(LAW.p_0 * WIDTH, rel=0.01)
    assert slid.f_t == pytest.approx(0.3 * (slid.f_ext + slid.f_adhesion), rel=1e-6)


def test_pull_off_of_a_flat_bar(bar):
    """p_0 times its width. Tolerance: steps of a quarter of the reach, 0.5 µm on a layer of 0.5 mm."""
    _, body = bar
    assert min(state.f_ext for state in body.states) == pytest.approx(-LAW.p_0 * WIDTH, rel=0.1)
    assert body.state.f_ext == pytest.approx(0.0, abs=1e-6)
    assert body.state.f_adhesion == pytest.approx(0.0, abs=1e-6)


def test_energy():
    """A ridge that came and went: the work left over is what jumps released, none is made. Tolerance: of the steps."""
    ridge = fp.Body(fp.geometry.ridge(size=20e-6), fp.Ogden(86.76e3, -14.53), adhesion=LAW, step_scale=0.5)
    ridge.press(height=-10e-6).lift(20e-6)
    smooth = [s.record.energy_released for s in ridge.states if not s.record.jump]
    most = max(abs(s.record.stored) for s in ridge.states)
    assert abs(ridge.energy.stored) < 1e-6 * most
    assert ridge.energy.released > 0
    assert max(map(abs, smooth)) < 0.1 * most


# -- scenes --------------------------------------------------------------------------------------------
@pytest.mark.slow
def test_lifted_finger():
    """It hangs on the screen at f_ext 0 and below; the result has the pull-off force, also after reading it again."""
    press = {"name": "press", "f_ext": 1.0}
    adhesion = {"p_0": "3 kPa", "distance": "2 um"}
    scene = fp.Scene(**NINE, adhesion=adhesion, history=[press, LIFTED], output={"receptors": False, "errors": False})
    result = fp.run(scene)
    assert result.steps[-1].ridges_in_contact == 0
    least = min(result.steps, key=lambda state: state.f_ext)
    assert least.f_ext < 0 < least.f_adhesion
    assert least.f_contact - least.f_adhesion == pytest.approx(least.f_ext, abs=1e-6)
    assert result.record[PULL_OFF]["f_ext"] == least.f_ext
    assert -15e-3 < result.record[PULL_OFF]["finger"] < 0
    assert any("mN of the whole finger" in note for note in result.notes)
    again = fp.Result.from_xarray(result.to_xarray())
    assert [s.f_adhesion for s in again.steps] == [s.f_adhesion for s in result.steps]
    assert fp.Scene(**scene.parameters()).adhesion == scene.adhesion


def test_pull_off_of_a_sphere():
    """Of slices that pull evenly: with their scale cos φ the sum is R (φ + sin φ cos φ) at the deepest one."""
    radius, deep, pull = 14e-3, 2e-3, 3.0
    scene = fp.Scene(slices={"radius": radius, "length": 2 * radius, "shape": "ellipsoid"})
    result = fp.run(model="cylinders")
    path = [(deep + 1e-9, 1.0), (deep, -pull), (1e-9, -pull), (0.0, 0.0)]
    steps = tuple(replace(result.full_slip, bone_height=-depth, f_ext=force) for depth, force in path)
    found, phi = with_pull_off(replace(result, scene=scene, steps=steps)), np.arccos(1 - deep / radius)
    expected = -pull * radius * (phi + np.sin(phi) * np.cos(phi))
    assert found.record[PULL_OFF] == pytest.approx({"f_ext": -pull, "finger": expected}, rel=5e-3)


def test_scene():
    """A force of 0 is allowed with adhesion; the closed form has none, and a width beyond the distance is refused."""
    loads = [{"name": "press", "f_ext": 1.0}, {"name": "hang", "f_ext": 0.0}]
    fp.Scene(history=loads, adhesion={"p_0": "3 kPa"})
    with pytest.raises(SceneError, match="nothing holds the skin on the screen"):
        fp.Scene(history=loads)
    with pytest.raises(SceneError, match="adhesion is Dugdale.*'cylinders' does not have"):
        fp.run(fp.Scene(adhesion={"p_0": "3 kPa"}), model="cylinders")
    with pytest.raises(SceneError, match="adhesion.width is 3e-06 m; it must be at most the distance"):
        fp.Scene(adhesion={"p_0": "3 kPa", "width": "3 um"})


@dataclass(frozen=True)
class Wrong(fp.Adhesion):
    """A potential that is not the integral of the pressure."""

    p_0: float = 1e3

    def pressure(self, y):
        return self.p_0 / (1 + (y * 1e6) ** 2) ** 2

    def potential(self, y):
        return -self.p_0 * 1e-6 / (1 + (y * 1e6) ** 2) ** 2


def test_own_law_is_checked():
    with pytest.raises(SceneError, match="is not the integral of its pressure"):
        fp.Scene(adhesion=Wrong())
