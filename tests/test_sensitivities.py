"""Slopes of full slip by the numbers of a scene: those of whole solves, of UFL, on two ranks; refusals and doors."""

import io
from contextlib import redirect_stdout
from dataclasses import replace
from functools import cache

import numpy as np
import pytest
import ufl
from dolfinx import fem
from mpi4py import MPI

import fingerpad as fp
from fingerpad.cli import sensitivities
from fingerpad.model.options import FingerModel, by_rule, plan
from fingerpad.model.section import write
from fingerpad.model.simulation import Simulation
from fingerpad.model.slopes import state_slopes
from fingerpad.results.slopes import rows
from fingerpad.scene import SceneError, from_data
from tests.runs import no_pictures
from tests.small_finger import NINE
from variational import numbers, sensitivity
from variational.solvers.coupling import AcceptedState

pytestmark = pytest.mark.slow
LEAN = {"errors": False, "receptors": False, "sensitivities": True}
EXACT = {"tolerance": 1e-12, "coupling_tolerance": 1e-11}
SCENE = NINE | {"f_ext": 1.0, "output": LEAN, "numerics": EXACT}
DERJAGUIN = {"friction": {"law": "Derjaguin", "mu_f": 0.2, "tau_0": 1e3}}
LAYER = "materials.stratum_corneum"
KEYS = (
    "f_ext", "voltage", "friction.mu_f", "friction.tau_0", "roughness.young", "roughness.h_rms", "roughness.wavelength",
    "electric.d_i", "electric.eps_i", f"{LAYER}.shear_modulus", f"{LAYER}.alpha", f"{LAYER}.poisson",
    "materials.dermis.shear_modulus", "contact.eps_n", "geometry.sc_thickness", "geometry.ridge_amplitude",
    "geometry.ridge_wavelength", "geometry.intermediate_ridge_height",
)  # fmt: skip
OF = ("mu_app", "contact_length", "p_max", "bone_height")


class Solved:
    """A path's end with its slopes, from which other ends are solved for as wholes."""

    def __init__(self, changes, comm=MPI.COMM_WORLD):
        scene = by_rule(from_data(SCENE | changes))
        self.model = model = FingerModel(scene, plan(scene))
        simulation = Simulation(model, comm)
        assert simulation.run() is None
        self.finger, self.state, kept = simulation.finger, simulation.states[-1], {}

        class Spied(sensitivity.Linearised):
            def slopes(spied, varied):
                kept.update(varied=varied, measure=spied.measure, fixed=spied._fixed)
                return super().slopes(varied)

        with pytest.MonkeyPatch.context() as patch:
            patch.setattr("fingerpad.model.slopes.Linearised", Spied)
            self.found = state_slopes(model, self.finger, self.state.load_number)
        self.varied, self.measure, self.fixed = kept["varied"], kept["measure"], kept["fixed"]

    def at(self, key, part):
        """Return the quantities where a number is changed by a part of itself."""
        coupling, solver, history = self.finger.coupling, self.finger.solver, self.finger.problem.history
        place = AcceptedState.of(coupling)
        numbers.impose(coupling, self.varied[key](part))
        before = solver.problem.surface.length
        solver.problem.surface.follow()  # once more, which changes nothing
        assert (solver.problem.surface.length == before).all()
        history.accept({"anchor": history.accepted["anchor"] + np.sign(solver.reaction[0]) * 3e-3})  # m
        solver.new_load(replace(solver.control), float(solver.problem.voltage.value), slipping=True, on_cone=False)
        coupling.solve()
        skin = self.finger.observer.state()
        found = self.measure(skin, self.finger.observer.ridge_loads(skin), solver.bone)
        numbers.impose(coupling, self.varied[key](0.0))
        place.restore(coupling)
        return found

    def slope(self, quantity, key):
        """Return a slope at fixed points in contact, for one whole of the number."""
        return self.found.stairs[quantity][key] * abs(self.found.values[key])


@cache
def solved(voltage, changes=()):
    return Solved({"voltage": voltage} | DERJAGUIN | dict(changes))


# -- beside whole solves -----------------------------------------------------------------------------------
@pytest.mark.parametrize("key", KEYS)
@pytest.mark.parametrize("voltage", [0.0, 50.0, 100.0])
def test_slopes_are_those_of_whole_solves(voltage, key):
    """Central differences of whole solves, to 1e-6 of a slope, beside what the solves' tolerance leaves of them."""
    agree(solved(voltage), key, OF)


def agree(mine, key, quantities):
    """Assert slopes of whole solves, whose tolerance of 1e-11 of the air gaps leaves up to 2e-7 of a quantity."""
    h = 2e-5
    more, less = mine.at(key, h), mine.at(key, -h)
    for quantity in quantities:
        whole, left = (more[quantity] - less[quantity]) / (2 * h), 3e-7 * abs(more[quantity])
        assert whole == pytest.approx(mine.slope(quantity, key), rel=1e-6, abs=left), (key, quantity)


@pytest.mark.parametrize(
    "changes",
    [
        {"contact": {"formulation": "nitsche", "gamma_0": 1.0}},
        {"numerics": EXACT | {"element": "P2-P1"}},
        {"contact": {"length": "gap"}},
        {"history": ({"name": "press", "bone_height": -40e-6}, {"name": "charge", "voltage": 100.0},
                     {"name": "slide", "bone_x": 1e-3, "until_full_slip": True})},
    ],
    ids=["nitsche", "mixed", "gap", "height"],
)  # fmt: skip
def test_slopes_of_other_forms(changes):
    """Contact by Nitsche's method, a pressure of its own, lengths by the gap, and a bone held by its height."""
    data = ({} if "history" in changes else {"voltage": 100.0}) | changes
    scene = {key: x for key, x in SCENE.items() if key != "f_ext" or "history" not in changes}
    with pytest.MonkeyPatch.context() as patch:
        patch.setitem(globals(), "SCENE", scene)
        mine = Solved(data)
    assert not mine.found.why
    keys = ["roughness.h_rms", f"{LAYER}.shear_modulus", f"{LAYER}.poisson", "friction"]
    for key in [*keys, "history[0].bone_height"] if "history" in changes else [*keys, "f_ext"]:
        agree(mine, key, ("mu_app", "contact_length"))


@pytest.mark.parametrize("key", ["voltage", "f_ext", "roughness.h_rms"])
def test_remainder_is_of_second_order(key):
    """What the slope leaves of a change falls to a quarter with half of the change, within what third order adds."""
    mine, h = solved(100.0), 2e-3
    now = mine.at(key, 0.0)["mu_app"]
    left = [mine.at(key, part)["mu_app"] - now - part * mine.slope("mu_app", key) for part in (h, h / 2)]
    assert left[0] / left[1] == pytest.approx(4.0, abs=0.3)


def test_residual_is_derived_as_by_ufl():
    """The difference quotient of the nodal forces by the voltage, beside UFL's derivative of the weak form."""
    mine = solved(100.0)
    problem, solver = mine.finger.problem, mine.finger.solver
    u = ufl.variable(problem.voltage)
    form = ufl.replace(problem.weak[0], {problem.voltage: u})
    exact, vector = fem.form(ufl.diff(form, u)), solver.layout.create_vector()
    problem.guess.value = -0.5  # no point on the cone sticks
    solver.equations.forces(exact, vector)
    f = solver.layout.create_vector()

    def residual(part):
        numbers.impose(mine.finger.coupling, mine.varied["voltage"](part))
        solver.equations.residual(solver.x, f)
        return f.array_r.copy()

    step = sensitivity.STEP
    found = (residual(step) - residual(-step)) / (2 * step * mine.found.values["voltage"])
    residual(0.0)
    assert found == pytest.approx(vector.array_r, abs=1e-8 * np.abs(vector.array_r).max())


def test_number_without_effect_has_no_slope():
    """The tangential stiffness does not act where all points slip, and the roughness not without a voltage."""
    assert solved(100.0).found.slopes["mu_app"]["contact.eps_t"] == 0
    assert solved(0.0).found.slopes["mu_app"]["roughness.h_rms"] == 0
    assert solved(0.0).found.slopes["f_t"]["f_ext"] > 0


@pytest.mark.mpi
def test_slopes_do_not_depend_on_the_ranks():
    """Within what the solves' tolerance leaves of the states."""
    changes = {"voltage": 100.0}
    mine, alone = Solved(changes), Solved(changes, MPI.COMM_SELF)
    for quantity in OF:
        for key, slope in alone.found.slopes[quantity].items():
            size = abs(getattr(alone.state, quantity) / (alone.found.values[key] or 1.0))
            assert mine.found.slopes[quantity][key] == pytest.approx(slope, rel=1e-6, abs=1e-8 * size), (quantity, key)


# -- doors -------------------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def ran(tmp_path_factory):
    """A run with errors, whose slopes are those of the final mesh; its folder, and the result."""
    folder = tmp_path_factory.mktemp("slopes") / "run"
    with no_pictures():
        result = fp.run(
            from_data(NINE | {"f_ext": 1.0, "voltage": 100.0, "output": LEAN | {"errors": True}}), out=folder
        )
    return folder, result


def test_result_has_the_slopes_of_its_final_mesh(ran):
    """As a table of its folder too; friction goes with its coefficient, less what the contact shrinks."""
    folder, result = ran
    data = fp.Result.load(folder).sensitivities("mu_app")
    assert data.identical(result.sensitivities("mu_app"))
    found = dict(zip(data.number.values, data.elasticity.values, strict=True))
    assert found["friction"] == pytest.approx(1.0, abs=0.05)
    assert (np.diff(np.abs(data.elasticity)) <= 0).all()
    assert result.sensitivities("contact_length").scatter.max() > 0  # its ends move, else it is that of a stair
    assert all(low > 0 or low == -np.inf for low in data.lowest.sel(number=["electric.d_i", "electric.eps_i"]).values)
    assert data.lowest[0] < data.value[0] < data.highest[0]


def test_command_prints_them(ran, tmp_path):
    """The largest first, and numbers without effect too."""
    with redirect_stdout(io.StringIO()) as out:
        assert sensitivities.main([str(ran[0]), "--csv", str(tmp_path / "slopes.csv")]) == 0
    lines = [line.split() for line in out.getvalue().splitlines()]
    assert lines[4][0] == rows(ran[1])[0].key
    assert ["contact.eps_t", "5e+10", "Pa/m", "0", "0", "0"] in [line[:6] for line in lines]
    assert "adhesion.p_0 is left out: adhesion is" in out.getvalue()
    assert len((tmp_path / "slopes.csv").read_text().splitlines()) == 1 + len(rows(ran[1]))


def test_run_keeps_its_states_where_slopes_are_lost():
    """The state says why, and the anchors of friction are those of before."""
    before = (mine := solved(100.0)).finger.problem.history.accepted["anchor"]
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(np.linalg, "solve", lambda *_: np.linalg.inv(np.zeros((1, 1))))  # singular
        lost = state_slopes(mine.model, mine.finger, mine.state.load_number)
    assert lost.why == "Singular matrix"
    assert (mine.finger.problem.history.imposed["anchor"] == before).all()


def test_frictionless_contact_has_slopes():
    """Of uncharged normal contact on half a finger: the bone sinks as its force grows, and contact grows."""
    scene = from_data(NINE | {"f_ext": 1.0, "voltage": 0.0, "friction": 0.0, "output": LEAN, "numerics": EXACT})
    with no_pictures():
        result = fp.run(scene.replace(history=[{"name": "press", "f_ext": 1.0}]))
    found = result.sensitivities("bone_height").slope.sel(number="history[0].f_ext")
    assert found < 0 and result.sensitivities("contact_length").slope.sel(number="history[0].f_ext") > 0


def test_finger_of_a_file_has_slopes(tmp_path):
    """Those of the finger that was written, on another mesh of it, but by the shape, which a file does not tell."""
    write(from_data(NINE), tmp_path / "nine.msh")
    scene = {"geometry": {"file": str(tmp_path / "nine.msh")}, "f_ext": 1.0, "voltage": 100.0}
    with no_pictures():
        runs = (fp.run(from_data({**given, "output": LEAN})) for given in (scene, scene | NINE))
        mine, own = (run.sensitivities("mu_app").slope for run in runs)
    assert "geometry.ridge_amplitude" in own.number and "geometry.ridge_amplitude" not in mine.number
    mine, own = (each.sel(number=["voltage", f"{LAYER}.poisson", "electric.d_i"]).values for each in (mine, own))
    assert mine == pytest.approx(own, rel=1e-2)


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"f_ext": None, "force": "0.01 N"}, "force is 0.01 N, of slices under forces of their own; give f_ext"),
        ({"contact": {"formulation": "augmented"}}, "multipliers that depend on the path; take penalty"),
        ({"friction": {"law": "Occlusion", "mu_dry": 0.2, "mu_wet": 0.4}}, "friction has a memory"),
    ],
)  # fmt: skip
def test_scene_without_slopes_is_refused(changes, words):
    data = {key: x for key, x in (SCENE | changes).items() if x is not None}
    with pytest.raises(SceneError, match=words):
        from_data(data)


def test_what_has_no_slopes_is_refused(ran):
    result = ran[1]
    with pytest.raises(SceneError, match="area has no sensitivities; quantities are mu_app, f_t"):
        result.sensitivities("area")
    with pytest.raises(SceneError, match="charged normal contact has no sensitivities: points stick"):
        result.sensitivities("mu_app", "charged")
    with pytest.raises(SceneError, match="run it with output.sensitivities=true"):
        fp.run(model="cylinders").sensitivities()
