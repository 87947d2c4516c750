"""The registry of models: a model of one's own is one class and one line, and works wherever the others do."""

import json

import pytest

import fingerpad as fp
from fingerpad.cli import main
from fingerpad.reduced.model import Model, reduced_state
from fingerpad.results.result import Result
from fingerpad.runs import solve as registry
from fingerpad.scene import Scene, SceneError
from tests.measures import rows_of

LENGTH = 1e-3  # m, of every contact of the toy


class Block(Model):
    """A rigid block, without attraction: f_T is mu_f times the external force."""

    name, words = "block", "A rigid block on the screen"

    def solve(self, scene, context) -> Result:
        contact = {"f_contact": scene.f_ext, "f_electrostatic": 0.0, "contact_length": LENGTH, "ridges_in_contact": 1}
        contact["bone_height"] = -1e-5 * scene.f_ext
        return Result(scene, self.name, None, *(reduced_state(scene, contact, slips) for slips in (False, True)))


@pytest.fixture(autouse=True)
def block(monkeypatch):
    """The recipe of CONTRIBUTING: one line in the registry."""
    monkeypatch.setitem(registry.MODELS, Block.name, Block())


def test_run(tmp_path):
    """In Python; the folder gives the same result again."""
    found = fp.run(Scene(friction=0.3), model="block", out=tmp_path)
    assert found.full_slip.mu_app == pytest.approx(0.3, rel=1e-12)
    assert found.record["provenance"]["versions"]["fingerpad"] == fp.__version__
    again = Result.load(tmp_path)
    assert (again.model, again.full_slip.mu_app) == ("block", found.full_slip.mu_app)
    with pytest.raises(SceneError, match="its model was block, and is cylinders now"):
        fp.run(Scene(friction=0.3), model="cylinders", out=tmp_path)


def test_command_and_report(tmp_path, capsys):
    """By its name, with a report in its own words; nothing of the path or its mesh is in there."""
    assert main(["run", "--model", "block", "--set", "friction=0.3", "--out", str(tmp_path)]) == 0
    shown = capsys.readouterr().out
    assert "Result (model 'block')" in shown and "Report: " in shown
    page = (tmp_path / "report.html").read_text(encoding="utf-8")
    assert "A rigid block on the screen (model 'block')" in page and "--model block" in page
    assert "a cheaper one" in page and "discretisation error of the contact length" not in page
    assert main(["report", str(tmp_path)]) == 0


def test_sweep(tmp_path):
    """Its points need no process of their own, and the table is that of any model."""
    table = fp.sweep(Scene(), tmp_path, model="block", friction=[0.2, 0.3])
    assert table.array("mu_app") == pytest.approx([0.2, 0.3], rel=1e-12)
    assert json.loads((tmp_path / "sweep.json").read_text())["model"] == "block"
    assert [row["friction"] for row in rows_of(tmp_path, "table")] == ["0.2", "0.3"]
    assert "--model block" in (tmp_path / "report.html").read_text(encoding="utf-8")


def test_newtons():
    """A force on the whole finger sums slices over its points; the coefficient of all is that of each."""
    found = fp.run(Scene(friction=0.3, voltage=0.0, force=0.5), model="block")
    assert found.finger.values("full_slip")["mu_app"] == pytest.approx(0.3, rel=1e-9)
    assert "traces over the force" in str(found.finger)


def test_what_it_cannot_do_is_refused(tmp_path):
    """It follows no history and goes on from no checkpoint, both in one sentence."""
    with pytest.raises(SceneError, match="the model 'block' answers for press, charge and slide alone"):
        fp.run(Scene(history=[{"name": "press", "f_ext": 5.0}]), model="block")
    with pytest.raises(SceneError, match="can go on"):
        fp.run(model="block", out=tmp_path, resume=True)
    with pytest.raises(SceneError, match="it must be 'cylinders' or 'full' or 'block'"):
        fp.run(model="blocks")
