"""States solved for again where ridges adhere: what restarts, notes and cautions say of them."""

import pytest

import fingerpad as fp
from fingerpad.accuracy import solves
from fingerpad.accuracy.solves import StateSolver
from fingerpad.model.simulation import Simulation
from fingerpad.scene import from_data, load
from tests.small_finger import NINE, SMALL
from variational.solvers.continuation import StepFailed

pytestmark = pytest.mark.slow
LAW = {"law": "BoundaryElements"}
ADHERES = " without a load at 100 V: by the closure BoundaryElements ridges adhere without a load from 78.4 V on"


def adhering(**keys):
    """Return the small finger whose ridges adhere, at coarse elements."""
    return load(SMALL).replace(mesh={"contact": 40e-6}, roughness=LAW, **keys)


@pytest.mark.parametrize(("where", "method"), [(StateSolver, "_restored"), (Simulation, "run")])
def test_restart_names_the_ridge_that_adheres(monkeypatch, where, method):
    """Where a state is not found on the final mesh, and where the path is lost."""
    found, once = getattr(where, method), ["full slip found no equilibrium"]

    def failing(self, *args):
        restart = found(self, *args)
        if once and self.states[-1].voltage and (where is Simulation or args[1] == "full slip"):
            raise StepFailed(once.pop())
        return restart

    monkeypatch.setattr(where, method, failing)
    result = fp.run(adhering())
    (restart,) = result.record["restarts"]
    assert restart["reason"].startswith("full slip found no equilibrium; ridge ") and ADHERES in restart["reason"]
    assert not result.failure


def test_state_that_roundoff_may_choose_is_a_caution():
    """The finger has three states of full slip on its final mesh, 1 % apart: changes of 1e-12 lead to each of them."""
    words = "full slip, solved again with a contact size of 4e-05 m: skin jumped on the way, and roundoff"
    (said,) = [text for text in fp.run(adhering()).cautions if text.startswith(words)]
    assert ADHERES in said
    plain = fp.run(adhering().replace(roughness={"law": "BearingArea"}))
    assert not [text for text in plain.cautions if "skin jumped" in text.text]


def test_meshes_too_coarse_to_be_of_one_shape_are_noted(monkeypatch):
    """The run keeps its path's states, without errors; it ended in a traceback."""

    def refused(*_):
        raise ValueError("a node lies 1.08 triangles outside the state's mesh; it is of another body")

    monkeypatch.setattr(solves, "restore", refused)
    output = {"receptors": False, "each_load": False}
    result = fp.run(from_data(NINE | {"f_ext": 1.0, "voltage": 100.0, "output": output}))
    assert result.full_slip.f_t > 0 and not result.failure
    assert [text for text in result.notes if "could not be estimated" in text and "1.08 triangles" in text]
