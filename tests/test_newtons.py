"""Newtons by branches of one simulation: beside runs of sections, with more ridges, cut short, on more ranks."""

import signal
from dataclasses import replace

import pytest
from mpi4py import MPI

import fingerpad as fp
from fingerpad.accuracy.solves import StateSolver
from fingerpad.model.simulation import Simulation
from fingerpad.results.folder import full_scene
from fingerpad.results.states import WORDS
from fingerpad.runs import newtons
from fingerpad.runs.branches import Branches
from fingerpad.scene import Load, SceneError, from_data
from fingerpad.slices import traces
from fingerpad.slices.total import RATIOS, BeyondTrace
from tests.runs import path_of, tables_alone
from tests.small_finger import NINE, small
from variational.solvers.continuation import StepFailed

pytestmark = pytest.mark.slow
SMALL = {"output": {"receptors": False, "errors": False}, "slices": {"radius": 6e-3, "length": 8e-3}}
FORCE = 2e-3  # N
COARSE = NINE | SMALL | {"voltage": 100.0, "force": FORCE}


def scene(**changes) -> fp.Scene:
    return small(**SMALL).replace(force=FORCE, mesh={"touching_half_arc": 1.2e-3}, **changes)


@pytest.fixture(scope="module")
def found() -> tuple[fp.Result, dict[str, list]]:
    """The result, and the states that were solved for again on the scene's own mesh, at growing forces."""
    fine, again = dict[str, list](), newtons.solve_again

    def kept(*given, **named):
        solve = again(*given, **named)
        for words, each in solve.states.items():
            name = next(name for name, word in WORDS.items() if words.startswith(word))
            fine.setdefault(name, []).append(each.state)
        return solve

    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(newtons, "solve_again", kept)
        return fp.run(scene()), fine


def test_states_on_the_scenes_mesh_are_those_of_a_run(found):
    """Full slip by another path, on elements as large, which are small about its own ends alone: within its error.

    The first force is so light that this is large; then the two meshes change less than a per cent.
    """
    output = SMALL["output"] | {"errors": True}
    for state in found[1]["full_slip"]:
        run = fp.run(scene().replace(force=None, f_ext=state.f_ext, output=output)).full_slip
        assert run.ridges_in_contact == state.ridges_in_contact
        for name, error in run.error.known().items():
            if name in run.error.own:
                continue  # an output, which states of traces do not have
            value = getattr(state, name)
            assert getattr(run, name) == pytest.approx(value, abs=min(error, 1e-2 * abs(value))), name


def test_traces_meet_the_states_on_the_scenes_mesh(found):
    """Where they were corrected; the section at the centre is about there."""
    for name, states in found[1].items():
        made = found[0].finger.traces[name]
        for state in states:
            values = made.at([-state.bone_height])
            assert values["f_ext"] == pytest.approx(state.f_ext, rel=1e-6), name
            assert values["contact_length"] == pytest.approx(state.contact_length, rel=1e-6), name
    for name in ("charged", "full_slip"):  # whose force is known from the first trace
        assert found[0].named[name].f_ext == pytest.approx(found[1][name][-1].f_ext, rel=0.1)


def test_errors_have_four_parts(found):
    """All of which are printed, and none of which is zero or all; two sums of one error have a ratio without."""
    assert "by mesh of the cross-section, coarser mesh of the traces, penalty, points of the traces" in str(found[0])
    for name, parts in found[0].finger.carried.items():
        for part, known in parts.items():
            sums = {key: error for key, error in known.items() if key not in RATIOS}
            assert all(0 < error < 0.5 for error in sums.values()), (name, part, known)
    assert found[0].full_slip.error.mu_app > 0


def test_trace_that_was_too_short_is_made_longer(monkeypatch):
    """To a larger force: full slip from where it ended."""
    monkeypatch.setattr(traces, "MARGIN", 0.55 * traces.MARGIN)
    made, before = [], Branches._made
    monkeypatch.setattr(Branches, "_made", lambda self, *given: made.append(given) or before(self, *given))
    again = fp.run(scene())
    assert [given[0] for given in made].count("full_slip") > 1
    assert again.finger.values("full_slip")["f_ext"] == pytest.approx(FORCE, rel=1e-9)


def test_more_ridges_are_added_where_they_must_touch():
    """All traces are followed again, and none goes on from before."""
    few = from_data(COARSE | {"mesh": NINE["mesh"] | {"touching_half_arc": 0.4e-3}})
    result = fp.run(few)
    assert result.record["restarts"] and "meshed to touch" in result.record["restarts"][0]
    assert result.record["path_mesh"]["touching_half_arc"] > 0.4e-3
    assert result.finger.values("full_slip")["f_ext"] == pytest.approx(FORCE, rel=1e-9)


@pytest.mark.parametrize(
    ("of", "method", "words"),
    [
        (Simulation, "_accepted", "light press"),
        pytest.param(Simulation, "slip_to", "trace of full slip", marks=pytest.mark.long),
        (StateSolver, "re_equilibrate", "correction of the traces"),
    ],
)
def test_force_that_was_interrupted_goes_on(tmp_path, of, method, words):
    """Whichever trace it was in, by the same command or by --resume, with the traces that were finished."""
    out, before, last = tmp_path / "out", getattr(of, method), method != "_accepted"

    def signalled(self, *given):
        signal.raise_signal(signal.SIGTERM)
        return before(self, *given)

    with tables_alone(), pytest.MonkeyPatch.context() as patch, pytest.raises(SystemExit) as stop:
        patch.setattr(of, method, signalled)
        fp.run(scene(), out=out)
    assert stop.value.code == 143
    assert stop.value.result.finger is None
    assert stop.value.result.failure.startswith("stopped by SIGTERM after step ")
    assert stop.value.result.failure.endswith(f" of the {words}; the same command goes on with it")
    assert not (out / "summary.json").exists() and full_scene(out) == scene()
    made, raised = [], Branches._raised
    with tables_alone(), pytest.MonkeyPatch.context() as patch:
        patch.setattr(Branches, "_raised", lambda self, *given: made.append(given) or raised(self, *given))
        went_on = fp.run(full_scene(out), out=out, resume=last)
    assert len(made) == (0 if last else 2)
    assert went_on.finger.values("full_slip")["f_ext"] == pytest.approx(FORCE, rel=1e-9)
    assert not (out / "checkpoint").exists()
    with tables_alone(), pytest.MonkeyPatch.context() as patch:
        patch.setattr(Simulation, "_accepted", None)  # nothing is solved again
        assert fp.run(scene(), out=out).finger.flat() == went_on.finger.flat()
    with pytest.raises(SceneError, match=r"its force was 0.002, and is 0.0022 now"):
        fp.run(scene().replace(force=1.1 * FORCE), out=out)


def test_accuracy_is_refused():
    with pytest.raises(SceneError, match="accuracy is given and force is 0.002 N; the traces"):
        fp.run(scene(accuracy={"mu_app": 0.05}))


@pytest.mark.parametrize(
    ("of", "name", "error", "words"),
    [
        pytest.param(
            newtons,
            "at_force",
            BeyondTrace("of a test"),
            "the correction of the traces failed: of a test; give f_ext",
            marks=pytest.mark.long,
        ),
        (Branches, "follow", StepFailed("no equilibrium"), "the light press failed: no equilibrium; give f_ext"),
    ],
)
def test_lost_trace_is_refused_with_its_reason(monkeypatch, of, name, error, words):
    def lost(*given):
        raise error

    monkeypatch.setattr(of, name, lost)
    with pytest.raises(SceneError, match=words):
        fp.run(from_data(COARSE))


@pytest.mark.mpi
@pytest.mark.skipif(MPI.COMM_WORLD.size == 1, reason="one rank has no other to agree with")
def test_numbers_are_the_same_on_more_ranks():
    """Tolerance: Newton's on other sums, and the air gaps' of 1e-6."""
    one, all_ranks = (fp.run(from_data(COARSE), comm=comm) for comm in (MPI.COMM_SELF, MPI.COMM_WORLD))
    for name, total in one.finger.states.items():
        for key, value in total.values.items():
            assert all_ranks.finger.values(name)[key] == pytest.approx(value, rel=1e-5, abs=1e-12), key


@pytest.mark.parametrize("friction", [0.0, pytest.param(0.25, marks=pytest.mark.long)])
def test_without_a_voltage_there_is_one_normal_contact(friction):
    """And without friction no full slip; the section at the centre has no error of friction that is roundoff."""
    found = fp.run(from_data(COARSE | {"voltage": 0.0, "friction": friction}))
    assert list(found.finger.states) == ["uncharged", "charged", *["full_slip"] * bool(friction)]
    assert found.finger.values("charged") == found.finger.values("uncharged")
    assert found.charged.error.f_t != found.charged.error.f_t or found.charged.error.f_t == 0.0
    assert (found.full_slip is None) == (not friction)


@pytest.mark.mpi
def test_what_is_reached_aside_leaves_the_path_as_it_is():
    """The state before is there again, and the next load is reached as without it; the steps are counted on."""
    loads = [{"name": "press", "f_ext": 1.0}, {"name": "charge", "voltage": 100.0}]
    given = from_data(NINE | {"history": loads, "output": SMALL["output"]})
    plain = path_of(given)
    plain.run()

    def on_load():
        if path.states[-1].load == "press":
            before = path.states[-1]
            with path.aside():
                path.reach([Load(name="raise", f_ext=1.2)], lambda: seen.append(path.states[-1]))
                path.reach([Load(name="charge", voltage=50.0)], lambda: seen.append(path.states[-1]))
            assert path.states[-1] is before
            now = path.finger.present(path.finger.ridge_loads(), "", 0).state
            for name in ("f_ext", "voltage", "f_contact", "contact_length", "bone_height"):
                assert getattr(now, name) == getattr(before, name), name

    seen, path = [], path_of(given, lambda step, done: None, on_load)
    assert path.run() is None
    assert [(state.f_ext, state.voltage) for state in seen] == [(pytest.approx(1.2), 0.0), (pytest.approx(1.2), 50.0)]
    for name in ("f_electrostatic", "contact_length", "bone_height"):
        assert getattr(path.states[-1], name) == pytest.approx(getattr(plain.states[-1], name), rel=1e-6), name
    assert replace(path.states[-1], step=0).load == "charge"
