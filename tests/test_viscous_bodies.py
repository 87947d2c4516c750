"""A viscous ridge and a viscous finger: energy, jumps, half fingers, scenes, and how long loads take."""

import numpy as np
import pytest
from mpi4py import MPI

import fingerpad as fp
import geometry
from fingerpad.model import cautions
from fingerpad.model.options import FingerModel, by_rule, plan
from fingerpad.model.simulation import Simulation
from fingerpad.model.state import least_dissipation
from fingerpad.scene import SceneError
from fingerpad.scene.viscosity import PRESETS
from geometry import tags
from geometry.bodies import ridge
from geometry.mesh import load
from tests.runs import followed
from tests.small_finger import NINE
from variational.body import Body
from variational.contact.interface import Interface
from variational.contact.penalty import Penalty
from variational.energy import Balance, EnergyBook
from variational.materials.ogden import Ogden
from variational.materials.qlv import QLV
from variational.materials.viscoelastic import Viscoelastic
from variational.roughness.bam import BearingArea
from variational.solvers.continuation import Target
from variational.solvers.iteration import EXACT
from variational.state import StepRecord

MOUSE = PRESETS["skin, mouse"]
H_0 = 0.5e-6
SOFT = ("subcutis", "dermis", "viable_epidermis", "stratum_corneum")


def made(comm: MPI.Comm = MPI.COMM_WORLD) -> Body:
    """Return a charged, viscous ridge under friction."""
    solids = {tags.STRATUM_CORNEUM: Viscoelastic(Ogden(86.76e3, -14.53), MOUSE)}
    more = {"tolerance": 1e-10, "coupling_tolerance": 1e-10}
    body = load(comm, ridge(30e-6))
    found = Body(body, solids, Interface(Penalty(), 0.3, H_0), BearingArea(H_0), **more)
    found.continuation.run(Target("press", f_ext=4.0))
    found.continuation.run(Target("charge", voltage=60.0))
    return found


def random_history(seed: int, steps: int, seconds: float) -> list[Target]:
    """Return targets along random f(t), U(t) and x(t) of up to 3 Hz."""
    a, w = np.random.default_rng(seed).uniform(-1, 1, (3, 3)), 2 * np.pi * np.arange(1, 4)

    def at(t: float) -> dict[str, float]:
        f, U, x = np.sin(w * t) @ a.T
        return {"f_ext": 4.0 * (1 + 0.1 * f), "voltage": 60 * (1 + 0.3 * U), "bone_x": 20e-6 * x}

    return [Target("random", **at(seconds * (k + 1) / steps), duration=seconds / steps) for k in range(steps)]


def balances(body: Body, history: list[Target]) -> list[Balance]:
    path = body.continuation
    now = lambda: (path.surface_state, body.solver.bone, body.solver.reaction, body.coupling.d_eq)  # noqa: E731
    book, found = EnergyBook(body.problem, *now()), []
    path.on_accept = lambda target, part, attempt: found.append(book.step(*now()))
    for target in history:
        path.run(target)
    return found


# -- energy --------------------------------------------------------------------------------------------
@pytest.mark.slow
@pytest.mark.parametrize("seed", [pytest.param(1, marks=pytest.mark.mpi), 2])
def test_energy_of_random_histories(seed):
    """Work is what is stored, rubbed off and spent on the branches, to 1e-8 of what is stored in each step.

    What is left is the error of the trapezoidal rule: of third order in the step, and of second order where a point
    begins to touch or to slip. Steps take 0.06 ms.
    """
    body = made()
    found = balances(body, random_history(seed, 80, 0.01))
    assert max(abs(each.released) / each.stored for each in found) < 1e-8
    assert sum(each.viscous for each in found) > 1e-5 * found[-1].stored
    assert min(each.viscous_dissipation for each in found) > 0.0
    assert found[-1].viscous_dissipation == pytest.approx(body.problem.spent()[1], rel=1e-9)
    assert least_dissipation(body.continuation) >= 0.0


# -- jumps ---------------------------------------------------------------------------------------------
@pytest.mark.slow
@pytest.mark.mpi
def test_jumps_do_not_age():
    """Pseudo-transient continuation leaves the history of one step, whatever it takes. Tolerance: that of solves."""
    found = []
    for shifted in (False, True):
        body = made()
        path, iteration, calls = body.continuation, body.solver.iteration, []
        plain = iteration.run

        def run(x, also=False, stop=None, shifted=shifted, plain=plain, calls=calls):
            calls.append(shifted)
            return plain(x, shifted or also, stop or EXACT)

        iteration.run = run
        path.run(Target("further", f_ext=4.2, voltage=70.0, duration=0.01))
        assert True in calls or not shifted
        history = path.problem.history
        found.append({field.name: history.accepted[field.name] for field in history.body})
        assert path.time == pytest.approx(0.01)
    assert len(found[0]) == 6
    for name in found[0]:
        np.testing.assert_allclose(found[1][name], found[0][name], atol=1e-6 * np.abs(found[0][name]).max(initial=1e-9))


# -- the same on every number of ranks ------------------------------------------------------------------
@pytest.mark.slow
@pytest.mark.mpi
@pytest.mark.skipif(MPI.COMM_WORLD.size == 1, reason="one rank has no other to agree with")
def test_on_any_number_of_ranks():
    """All ranks together find what each finds alone. Tolerance: that of the solves."""
    found = []
    for comm in (MPI.COMM_WORLD, MPI.COMM_SELF):
        body = made(comm)
        spent = [each.viscous for each in balances(body, random_history(1, 3, 0.05))]
        found.append([*body.solver.bone, *body.solver.reaction, least_dissipation(body.continuation), sum(spent)])
    np.testing.assert_allclose(found[0], found[1], rtol=1e-7)


# -- fingers -------------------------------------------------------------------------------------------
def scene(*loads: dict, preset="fingerpad", **more) -> fp.Scene:
    layers = {name: {"viscosity": {"preset": preset}} for name in SOFT} if preset else {}
    return fp.Scene(**NINE, history=list(loads), materials=layers, output={"receptors": False}, **more)


PRESS, HOLD = {"name": "press", "bone_height": -30e-6}, {"name": "hold", "bone_height": -30e-6, "duration": 5.0}


@pytest.mark.slow
def test_held_finger():
    """At a held depth the force falls to that of the elastic law.

    At once it is larger by less than the ratio of the moduli, 3.8, since the volume's stress does not relax. After 5 s
    the branch of 1.22 s has exp(-5 / 1.22) = 1.7 % of its 19 % left, over 26 % that last: 1.2 %. Tolerance: as much.
    """
    found = followed(scene(PRESS, HOLD)).states
    elastic = followed(scene(PRESS, preset=None)).states[-1]
    start = next(state for state in found if state.load == "press" and state.bone_height == pytest.approx(-30e-6))
    assert 1.8 < start.f_ext / elastic.f_ext < 3.8
    assert 1.0 < found[-1].f_ext / elastic.f_ext < 1.024
    assert min(state.record.viscous_least for state in found) >= 0.0
    forces = [state.f_ext for state in found if state.load == "hold"]
    assert forces == sorted(forces, reverse=True)


@pytest.mark.slow
def test_half_and_whole():
    """Led by its half and as a whole from the start, a finger is the same. Tolerance: that of the solves."""
    asked = by_rule(scene(PRESS, HOLD | {"duration": 0.05}, {"name": "slide", "bone_x_by": 50e-6, "speed": 0.01}))
    found = []
    for options in (plan(asked), plan(asked).with_both_halves()):
        path = Simulation(FingerModel(asked, options), MPI.COMM_SELF)
        assert path.run() is None
        found.append(path.states[-1])
    assert (found[0].f_ext, found[0].f_t) == pytest.approx((found[1].f_ext, found[1].f_t), rel=1e-6)
    assert found[0].record.viscous == pytest.approx(found[1].record.viscous, rel=1e-6)


def test_caution():
    """A branch that made energy is named."""
    record = StepRecord(*[0] * 12, viscous=1.0, viscous_least=-0.2)
    state = fp.ContactState(f_ext=1.0, voltage=0.0, f_t=0.0, mu_app=0.0, f_contact=1.0, f_electrostatic=0.0,
                            ridges_in_contact=0, contact_length=0.0, record=record)  # fmt: skip
    (text,) = map(str, cautions.on_states([state], None))
    assert "in 1 of 1 steps branches of viscous layers made energy at points and dissipated none, up to 0.2" in text


# -- scenes --------------------------------------------------------------------------------------------
def test_scene_is_written_and_read():
    """The branches of a preset are written, and read again; other keys of the layer stay as they are."""
    given = fp.Scene(materials={"dermis": {"viscosity": {"preset": "fingerpad"}}})
    again = fp.Scene(**given.parameters())
    assert again.materials.dermis == given.materials.dermis
    stiffer = given.replace(materials={"dermis": {"shear_modulus": 3e3}}).materials.dermis
    assert (stiffer.viscosity, stiffer.elastic.shear_modulus) == (PRESETS["fingerpad"], 3e3)
    none = given.replace(materials={"dermis": {"viscosity": None}})
    assert none.materials.dermis == fp.Scene().materials.dermis
    times = fp.Scene(materials={"dermis": {"viscosity": {"moduli": [0.5], "times": ["4 ms"]}}})
    assert times.materials.dermis == Viscoelastic(fp.Scene().materials.dermis, QLV([0.5], [4e-3]))
    assert fp.Scene(materials={"dermis": times.materials.dermis}).materials.dermis == times.materials.dermis


@pytest.mark.parametrize(
    ("viscosity", "message"),
    [
        ({"moduli": [0.5, 0.5], "times": [1, 2]}, "materials.dermis.viscosity.moduli sum to 1; .* must be below 1"),
        ({"moduli": [0.5], "times": [0]}, r"viscosity.times\[0\] is 0 s; it must be from 1e-06"),
        ({"moduli": [0.5], "times": ["3 m"]}, "its unit is not a unit of time"),
        ({}, "viscosity.moduli is missing; viscosity must have moduli and times, or a preset"),
        ({"preset": "fingerpad", "times": [1]}, "preset is 'fingerpad' and times is given too"),
        ({"modul": [1]}, "viscosity.modul is not a key of materials.dermis.viscosity; did you mean"),
    ],
)
def test_refused(viscosity, message):
    with pytest.raises(SceneError, match=message):
        fp.Scene(materials={"dermis": {"viscosity": viscosity}})


# -- a viscous body at the door: how long its loads take, and refusals without ---------------------------------------
G, NU = 86.76e3, 0.48
RELAXED = fp.Ogden(G, -14.53, NU)
SKIN = fp.Viscoelastic(RELAXED, fp.QLV([0.2, 0.4], [0.02, 0.1]))
DEPTH = -30e-6  # m


def body_of(material, **more) -> fp.Body:
    return fp.Body(geometry.ridge(size=60e-6), material, **more)


def at_once() -> fp.Ogden:
    """Return the elastic solid that the viscous one is at once: its shear modulus over 1 - 0.6, its bulk modulus."""
    shear, bulk = G / 0.4, 2 * G * (1 + NU) / (3 * (1 - 2 * NU))
    return fp.Ogden(shear, -14.53, (3 * bulk - 2 * shear) / (2 * (3 * bulk + shear)))


@pytest.mark.slow
@pytest.mark.parametrize(("seconds", "elastic"), [(0.0, at_once()), ("10 s", RELAXED)])
def test_forces_are_those_of_elastic_bodies(seconds, elastic):
    """Pressed at once and after 100 times of the slowest branch. Tolerance: the solves', and exp(-100)."""
    body = body_of(SKIN).press(height=DEPTH, seconds=0).press(height=DEPTH, seconds=seconds)
    assert body.state.f_ext == pytest.approx(body_of(elastic).press(height=DEPTH).state.f_ext, rel=1e-6)
    assert body.state.time == (0.0 if seconds == 0.0 else 10.0)


@pytest.mark.parametrize(("material", "friction"), [(SKIN, 0.25), (RELAXED, fp.Occlusion(0.25, 0.5))])
def test_loads_without_a_time_are_refused(material, friction):
    """Of a viscous material, and of friction that grows over time; a load that is refused leaves no state."""
    body = body_of(material, friction=friction, roughness=fp.BearingArea(h_0=0.51e-6))
    loads = (
        lambda: body.press(4.0),
        lambda: body.press(height=DEPTH),
        body.lift,
        lambda: body.charge(100.0),
        lambda: body.slide(1e-3),
    )
    for call in loads:
        with pytest.raises(ValueError, match=r"^\w+ takes seconds, how long the load lasts, 0 for at once"):
            call()
    assert body.states == [] and body.state.load == "unloaded"
