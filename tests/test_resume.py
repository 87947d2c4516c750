"""A run that is cut short goes on from its checkpoint, and computes what one never stopped does."""

import random
import shutil
import signal
from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

import fingerpad as fp
from fingerpad.model.simulation import Simulation
from fingerpad.results import dataset
from fingerpad.results.folder import CheckpointError
from fingerpad.runs.batch import key, sweep
from fingerpad.runs.checkpoint import Checkpoint
from fingerpad.scene import SceneError
from tests.measures import tables
from tests.runs import tables_alone
from tests.test_history import Own
from variational.problem import Problem
from variational.solvers.coupling import Coupling

pytestmark = pytest.mark.slow
ROOT = Path(__file__).resolve().parents[1]

# -- a run that is cut short goes on from its checkpoint, and computes what a run never stopped does -----------------
PRESS, CHARGE = {"name": "press", "f_ext": 2.0}, {"name": "charge", "voltage": 100.0}
SLIDE = {"name": "slide", "bone_x": 0.5e-3, "until_full_slip": True}
HELD = {"name": "held", "f_ext": 2.0, "duration": 0.5}
VISCOUS = {name: {"viscosity": {"preset": "fingerpad"}} for name in ("dermis", "stratum_corneum")}
DRIVE, LOSSY = {"waveform": "sine", "amplitude": 150.0, "frequency": 100.0}, {"tissue": "dry", "leak": 300.0}
WAVE = {"name": "wave", "voltage": DRIVE, "duration": 2e-3, "bone_x": 0.1e-3}
HISTORIES = {
    "charged at rest": ([PRESS, CHARGE, SLIDE], {}),
    "there and back": ([PRESS, SLIDE, CHARGE, {"name": "back", "bone_x": -0.1e-3}], {}),
    "viscous": ([PRESS, HELD, CHARGE, SLIDE | {"bone_x": 0.3e-3, "speed": 0.01}], {"materials": VISCOUS}),
    "bone height": ([{"name": "press", "bone_height": -0.2e-3}, CHARGE, SLIDE], {}),
    "Nitsche": ([PRESS, CHARGE, SLIDE], {"contact": {"formulation": "nitsche"}}),
    "augmented": ([PRESS, CHARGE, SLIDE], {"contact": {"formulation": "augmented"}}),
    "more ridges": ([PRESS, CHARGE, SLIDE], {"mesh": {"touching_half_arc": 0.1e-3}}),  # added on the way
    "receptors": ([PRESS, CHARGE, SLIDE], {"output": {"receptors": True, "errors": True}}),
    "receptors over time": ([PRESS, WAVE], {"output": {"receptors": True}, "materials": VISCOUS}),
    "drive": (None, {"f_ext": 2.0, "voltage": DRIVE, "electric": LOSSY}),
    "drive over time": ([PRESS, WAVE], {"electric": LOSSY}),
    "viscous waveform": ([PRESS, WAVE], {"materials": VISCOUS}),
    "force over time": ([PRESS, WAVE | {"voltage": None, "f_ext": DRIVE | {"amplitude": 0.5, "offset": 2.0}}], {}),
    "mixed": ([PRESS, CHARGE, SLIDE], {"numerics": {"element": "P2-P1"}}),
}


class Killed(BaseException):
    """In the place of a kill."""


def scene(history="charged at rest", **more) -> fp.Scene:
    loads, changes = HISTORIES[history]
    small = fp.Scene.load(ROOT / "demos" / "scenes" / "small_finger.toml")
    small = small.replace(mesh={"contact": 40e-6}, output={"errors": False}, numerics={"step_scale": 0.6})
    return small.replace(history=loads, **changes).replace(**more)


@pytest.fixture(autouse=True)
def bare():
    """Nothing but tables and the summary is written."""
    with tables_alone():
        yield


@pytest.fixture
def killed_at(monkeypatch):
    """Have a run end at its solve of a number, from 1; none is left to do by a run that takes them all over."""
    plain = Coupling.solve

    def killed_at(number):
        count = [0]

        def solve(self, pseudo_transient=False):
            count[0] += 1
            if count[0] == number:
                raise Killed
            plain(self, pseudo_transient)

        monkeypatch.setattr(Coupling, "solve", solve)
        return count

    return killed_at


# -- the same numbers ------------------------------------------------------------------------------------
ALWAYS = ["receptors", "receptors over time"]
LONG = [pytest.param(name, marks=pytest.mark.long) for name in HISTORIES if name not in ALWAYS]


@pytest.mark.parametrize("history", [*ALWAYS, *LONG])
def test_goes_on_to_the_last_bit(history, tmp_path, killed_at):
    """Killed twice on the way; the solves of earlier runs are not done again."""
    whole, cut = tmp_path / "whole", tmp_path / "cut"
    count = killed_at(None)
    reference = fp.run(scene(history), out=whole)
    total = count[0]
    first, second = sorted(random.Random(history).sample(range(8, total - 3), 2))
    killed_at(first)
    with pytest.raises(Killed):
        fp.run(scene(history), out=cut)
    killed_at(second - first)
    with pytest.raises(Killed):
        fp.run(scene(history), out=cut, resume=True)
    count = killed_at(None)
    found = fp.run(scene(history), out=cut, resume=True)
    assert 0 < count[0] < total - first + 12  # at most a part of the checkpoint was solved for again
    assert tables(cut) == tables(whole)
    assert dataset.values(found) == dataset.values(reference)
    assert found.cost.newton_iterations == reference.cost.newton_iterations
    assert found.cost.factorisations == reference.cost.factorisations
    for load, views in reference.fields.items():
        for name, values in vars(views).items():
            np.testing.assert_array_equal(getattr(found.fields[load], name), values)
    assert not (cut / "checkpoint").exists()


@pytest.mark.mpi
@pytest.mark.skipif(MPI.COMM_WORLD.size == 1, reason="one rank has no other to agree with")
@pytest.mark.parametrize("history", ["charged at rest", "viscous waveform"])
def test_on_another_number_of_ranks(history, tmp_path, killed_at):
    """Begun on one rank and finished on all; to 1e-8 the numbers of one rank."""
    comm = MPI.COMM_WORLD
    place = Path(comm.bcast(str(tmp_path)))
    if comm.rank == 0:
        fp.run(scene(history), out=place / "whole", comm=MPI.COMM_SELF)
        killed_at(15)
        with pytest.raises(Killed):
            fp.run(scene(history), out=place / "cut", comm=MPI.COMM_SELF)
    comm.barrier()
    killed_at(None)
    fp.run(scene(history), out=place / "cut", resume=True)
    whole, cut = tables(place / "whole"), tables(place / "cut")
    assert len(whole["steps"]) == len(cut["steps"])
    for name in ("f_ext", "f_t", "f_contact", "contact_length", "mu_app", "bone_height"):
        values = [[float(row[name]) for row in found["steps"]] for found in (whole, cut)]
        assert np.allclose(*values, rtol=1e-8, atol=1e-8 * np.abs(values[0]).max())


# -- refusals -------------------------------------------------------------------------------------------
@pytest.fixture
def cut_short(tmp_path, killed_at):
    killed_at(12)
    with pytest.raises(Killed):
        fp.run(scene(), out=tmp_path)
    killed_at(None)
    return tmp_path


def test_run_that_stops_before_its_first_checkpoint(tmp_path, monkeypatch):
    """The failure promises no more than there is, and to go on is refused for what it is."""
    accepted = Simulation._accepted

    def stop(self, *given):
        signal.raise_signal(signal.SIGTERM)
        return accepted(self, *given)

    monkeypatch.setattr(Simulation, "_accepted", stop)
    monkeypatch.setattr(Checkpoint, "write", lambda *args: None)
    with pytest.raises(SystemExit) as ended:
        fp.run(scene(), out=tmp_path)
    words = "every accepted step is in the folder of results, and the same command starts again"
    assert ended.value.result.failure == f"stopped by SIGTERM after step 1; {words}"
    refused("has no checkpoint to go on from", tmp_path)


def refused(match: str, folder: Path, **more) -> None:
    with pytest.raises(SceneError, match=match):
        fp.run(scene(**more), out=folder, resume=True)


def test_refusals(cut_short, tmp_path_factory, capsys):
    """Of nothing to go on from, another scene, a damaged or foreign checkpoint; each in one sentence."""
    refused("has no checkpoint to go on from", tmp_path_factory.mktemp("empty"))
    refused("holds the results of another scene", cut_short, friction=0.3)
    output = fp.Output("p_mean", "Pa", lambda state: state.f_contact / state.contact_length)
    with pytest.raises(SceneError, match="is of another list of outputs"):
        fp.run(scene(), out=cut_short, resume=True, outputs=[output])
    head, part = cut_short / "checkpoint" / "head.json", sorted((cut_short / "checkpoint").glob("*.npz"))[-1]
    whole, text = part.read_bytes(), head.read_text(encoding="utf-8")
    for damaged in (whole[: len(whole) // 2], b"", whole[:200] + bytes([whole[200] ^ 1]) + whole[201:]):
        part.write_bytes(damaged)
        refused(f"{part.name} cannot be read", cut_short)
    part.unlink()
    other = tmp_path_factory.mktemp("other")
    shutil.copytree(cut_short / "checkpoint", other / "checkpoint")
    refused("is of another scene", other, friction=0.3)
    for old, new, match in (
        ('"format": 4', '"format": 0', "another format"),
        ('"source": "', '"source": "x', "source"),
    ):
        head.write_text(text.replace(old, new), encoding="utf-8")
        refused(match, cut_short)
    head.write_text("{", encoding="utf-8")
    refused("head.json cannot be read", cut_short)
    head.write_text(text, encoding="utf-8")
    fp.run(scene(), out=cut_short, resume=True)  # from the part before the one that was deleted
    refused("has no checkpoint to go on from", cut_short)


def test_checkpoint_of_another_mesh(cut_short, monkeypatch):
    """As by another version of gmsh: the places are compared, not trusted."""
    read = Checkpoint.read

    def elsewhere(self, classes):
        kept = read(self, classes)
        places = kept["simulation"]["paths"]["finger"]["places"]
        places["unknowns"] = places["unknowns"] + 1e-6
        return kept

    monkeypatch.setattr(Checkpoint, "read", elsewhere)
    with pytest.raises(CheckpointError, match="of another mesh"):
        fp.run(scene(), out=cut_short, resume=True)


@pytest.mark.parametrize(
    ("last", "words"), [(2, "fingerpad run --resume FOLDER goes on"), (0, "the same command starts again")]
)
def test_full_disk_under_the_checkpoint(tmp_path, monkeypatch, last, words):
    """What is there stays whole, and the run goes on from it when there is room, or starts again without one."""
    write = Checkpoint.write

    def full(self, *given):
        if self.number == last:
            raise OSError(28, "No space left on device")
        write(self, *given)

    monkeypatch.setattr(Checkpoint, "write", full)
    with pytest.raises(OSError, match=f"{words} when there is room"):
        fp.run(scene(), out=tmp_path)
    monkeypatch.setattr(Checkpoint, "write", write)
    assert fp.run(scene(), out=tmp_path, resume=last > 0).full_slip is not None


# -- sweeps ---------------------------------------------------------------------------------------------
@pytest.mark.long
def test_sweep_goes_on(tmp_path, killed_at, monkeypatch):
    """The run that was cut short takes its outcomes over; where that is not possible it starts anew."""
    one = scene()
    folder = tmp_path / key(one)
    for head in (None, "{}"):
        killed_at(12)
        with pytest.raises(Killed):
            fp.run(one, out=folder)
        if head is not None:
            (folder / "checkpoint" / "head.json").write_text(head, encoding="utf-8")
        found = sweep({"one": one}, tmp_path, jobs=1, quiet=True)["one"]
        assert "failure" not in found
        assert ("earlier" in (folder / "run.log").read_text(encoding="utf-8")) == (head is None)
        (folder / "summary.json").unlink()


# -- history and outputs of one's own -------------------------------------------------------------------
def test_own_history_is_kept(tmp_path, killed_at, monkeypatch):
    """A viscous strain and an accumulated slip go on from the checkpoint to the last bit, with no other edit."""
    plain, problems = Problem.__init__, list[Problem]()

    def init(self, *args, **more):
        plain(self, *args, **more)
        Own.of(self)
        problems.append(self)

    def ends() -> tuple[np.ndarray, np.ndarray]:
        whole = problems[0].history.accepted
        problems.clear()
        return whole["slip"], whole["strain"]

    monkeypatch.setattr(Problem, "__init__", init)
    slow = {"history": [PRESS, SLIDE | {"speed": 0.02}]}
    killed_at(None)
    fp.run(scene().replace(**slow), out=tmp_path / "whole")
    reference = ends()
    killed_at(14)
    with pytest.raises(Killed):
        fp.run(scene().replace(**slow), out=tmp_path / "cut")
    problems.clear()
    killed_at(None)
    fp.run(scene().replace(**slow), out=tmp_path / "cut", resume=True)
    for found, expected in zip(ends(), reference, strict=True):
        np.testing.assert_array_equal(found, expected)
        assert np.abs(expected).max() > 0
