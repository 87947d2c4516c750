"""What a scene does not need is left out, with a reason; the numbers stay those of the whole model."""

import json
from dataclasses import replace

import numpy as np
import pytest
from mpi4py import MPI

from fingerpad.model import options
from fingerpad.model.options import plan
from fingerpad.runs import full as run_module
from fingerpad.scene import from_data
from geometry import tags
from geometry.bodies import ridge
from geometry.mesh import load
from tests.runs import run
from variational.attraction.electroadhesion import ELECTROSTATIC
from variational.body import Body
from variational.contact.interface import Interface
from variational.contact.nitsche import Nitsche
from variational.contact.penalty import Penalty
from variational.materials.ogden import Ogden
from variational.resultants import RidgeLoads
from variational.roughness.bam import BearingArea
from variational.solvers.continuation import Target

pytestmark = pytest.mark.slow
H_0, FORCE = 0.514e-6, 5.0
MESH = {"contact": 30e-6, "receptor": 80e-6, "interface": 150e-6, "growth": 0.8, "touching_half_arc": 1.3e-3}
PRESS = {"name": "press", "f_ext": 2.0}


# -- the plan ----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("data", "part", "reason"),
    [
        ({"voltage": 0.0}, "voltage", "no load has a voltage"),
        ({"history": [PRESS, {"name": "off", "voltage": 0.0}]}, "voltage", "no load has a voltage"),
        ({"friction": 0.0}, "friction", "the friction coefficient is 0"),
        ({"output": {"receptors": False}}, "receptors", "output.receptors is false"),
    ],
)
def test_what_cannot_matter_is_left_out_with_its_reason(data, part, reason):
    needed = plan(from_data(data))
    assert getattr(needed, part) is False
    assert reason in [omission.reason for omission in needed.omitted]


# -- forms -------------------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def body():
    return load(MPI.COMM_WORLD, ridge(20e-6))


class Path:
    """A ridge pressed and slid without voltage; what it ended in and what that took."""

    def __init__(self, body, interface: Interface) -> None:
        skin = {tags.STRATUM_CORNEUM: Ogden(86.76e3, -14.53, 0.48)}
        closure = BearingArea(H_0) if interface.attraction else None
        made = Body(body, skin, interface, closure, force_scale=FORCE)
        self.problem, self.solver, self.path = made.problem, made.solver, made.continuation
        self.path.run(Target("press", f_ext=FORCE))
        self.path.run(Target("slide", bone_x=20e-6))

    @property
    def loads(self) -> RidgeLoads:
        return self.path.observer.ridge_loads(self.path.surface_state)

    @property
    def compiled(self) -> tuple[int, int]:
        """Constants and fields that the compiled tangent reads."""
        form = self.problem.jacobian.ufcx_form
        return form.num_constants, form.num_coefficients


@pytest.mark.parametrize("law", [Penalty(1.5e12, 5e10), Nitsche(10.0)], ids=["penalty", "nitsche"])
def test_forms_without_voltage(body, law):
    """To the last bit the state at 0 V of the forms with attraction; they read two constants and one field less."""
    whole, less = Path(body, Interface(law, 0.25, H_0, ELECTROSTATIC)), Path(body, Interface(law, 0.25, H_0, None))
    assert np.array_equal(whole.problem.w.x.array, less.problem.w.x.array)
    assert less.solver.counts == whole.solver.counts
    assert [a - b for a, b in zip(whole.compiled, less.compiled, strict=True)] == [2, 1]
    assert np.isnan(less.path.coupling.d_eq).all() and not np.isnan(whole.path.coupling.d_eq).any()


@pytest.mark.parametrize("law", [Penalty(1.5e12, 5e10), Nitsche(10.0)], ids=["penalty", "nitsche"])
def test_forms_without_friction(body, law):
    """The limit of vanishing friction, but for 1e-9 of it times some ten steps; fewer fields, no more work."""
    whole, less = Path(body, Interface(law, 1e-9, H_0, None)), Path(body, Interface(law, 0.0, H_0, None))
    largest = np.abs(less.problem.w.x.array).max()
    np.testing.assert_allclose(less.problem.w.x.array, whole.problem.w.x.array, rtol=0, atol=1e-7 * largest)
    assert less.loads.length == pytest.approx(whole.loads.length, rel=1e-6)
    assert not less.path.surface_state.t_t.any()
    assert less.problem.anchor is None
    assert less.compiled[0] < whole.compiled[0] and less.compiled[1] == whole.compiled[1] - 1
    assert less.solver.counts.factorisations <= whole.solver.counts.factorisations


# -- runs --------------------------------------------------------------------------------------------------
def summary_of(data, folder, monkeypatch=None, **parts) -> dict:
    """Run a scene, with parts of the model that the plan would leave out if ``parts`` say so."""
    output = {"errors": False} | data.get("output", {})
    scene = from_data({"mesh": MESH, "geometry": {"ridge_count": 9}} | data | {"output": output})
    if monkeypatch is not None:
        monkeypatch.setattr(run_module, "plan", lambda scene: replace(options.plan(scene), **parts))
    summary = run(scene, folder, MPI.COMM_WORLD)
    assert "failure" not in summary
    return summary


RESULTS = ["bone_height", "f_contact", "contact_length", "ridges_in_contact"]


@pytest.fixture(scope="module")
def pressed(tmp_path_factory):
    folder = tmp_path_factory.mktemp("pressed")
    return folder, summary_of({"history": [{"name": "press", "bone_height": -60e-6}]}, folder)


def test_run_without_voltage(pressed, tmp_path, monkeypatch):
    """The same numbers to the last bit as with attraction and closure; what was left out is said in three places."""
    folder, less = pressed
    history = {"history": [{"name": "press", "bone_height": -60e-6}]}
    whole = summary_of(history, tmp_path, monkeypatch, voltage=True)
    assert [less[f"charged_{name}"] for name in RESULTS] == [whole[f"charged_{name}"] for name in RESULTS]
    assert less["factorisations"] == whole["factorisations"]
    assert {"what": "attraction and the air gaps of the ridges", "reason": "no load has a voltage"} in less["omitted"]
    assert json.loads((folder / "summary.json").read_text(encoding="utf-8"))["omitted"] == less["omitted"]
    assert "left out: no load has a voltage" in (folder / "run.log").read_text(encoding="utf-8")


@pytest.mark.parametrize(
    ("data", "reason"),
    [
        ({"output": {"errors": False}}, "output.errors is false"),
        ({"numerics": {"element": "P2-P1"}}, None),
        ({}, None),
        ({"output": {"errors": False}, "accuracy": {"mu_app": 0.01}}, None),
    ],
)
def test_errors_are_estimated_where_they_can_be(data, reason):
    found = plan(from_data(data))
    reasons = [o.reason for o in found.omitted if o.what == "discretisation errors"]
    assert reasons == ([reason] if reason else [])
    assert found.errors == (reason is None)
