"""Laws of one's own in scenes: every way of a run takes them, and laws of one name and other code are two laws."""

import json
import os
import subprocess
import sys
from pathlib import Path

import pytest

import fingerpad as fp
from fingerpad.cli import main
from fingerpad.results.result import Result
from fingerpad.scene import Scene, SceneError, load
from fingerpad.scene.remarks import used
from tests.commands import python
from tests.runs import tables_alone
from tests.small_finger import small

pytestmark = pytest.mark.slow
MINE = """
from dataclasses import dataclass
import fingerpad as fp
from variational.coefficients import parameter

@dataclass(frozen=True)
class Mine(fp.Friction):
    k: float = parameter(0.1, 10.0)
    tau: float = parameter(0, 1e6, "Pa", default=1e3)

    def limit(self, p):
        return {factor} * self.k * p
"""
SCENE = """
friction = {law = "mylaws:Mine", k = 2, tau = "5 kPa"}
"""
COARSE = {"mesh": {"contact": 40e-6}, "output": {"errors": False, "receptors": False, "each_load": False}}


@pytest.fixture
def place(tmp_path, monkeypatch):
    """The folder of a scene with a law of another folder beside, which is on Python's path."""
    folder, path = tmp_path / "scene", tmp_path / "path"
    folder.mkdir()
    path.mkdir()
    (path / "mylaws.py").write_text(MINE.format(factor=0.1), encoding="utf-8")
    (folder / "scene.toml").write_text(SCENE, encoding="utf-8")
    monkeypatch.setenv("PYTHONPATH", str(path))
    monkeypatch.syspath_prepend(path)
    monkeypatch.delitem(sys.modules, "mylaws", raising=False)
    yield folder
    sys.modules.pop("mylaws", None)


def edited(place: Path) -> None:
    """Change the law and forget it, as a new process does."""
    (place.parent / "path" / "mylaws.py").write_text(MINE.format(factor=0.1111), encoding="utf-8")
    sys.modules.pop("mylaws", None)


def command(place: Path, *words: str, cwd: Path | None = None, **more: str) -> subprocess.CompletedProcess[str]:
    path = {"PYTHONPATH": os.pathsep.join([str(place.parent / "path"), os.getcwd()])}
    return python("-m", "fingerpad", *words, cwd=cwd, **path | more)


# -- import paths ----------------------------------------------------------------------------------------------
def test_law_of_a_scene_file_has_units_and_ranges_of_its_own(place):
    law = Scene.load(place / "scene.toml").friction_law()
    assert (type(law).__name__, law.k, law.tau, law.limit(10.0)) == ("Mine", 2.0, 5e3, 2.0)
    with pytest.raises(SceneError, match="friction.k is 20; it must be from 0.1 to 10"):
        load(place / "scene.toml", {"friction.k": 20})
    with pytest.raises(SceneError, match="friction.tau is '5 mm'; its unit is not a unit of pressure"):
        load(place / "scene.toml", {"friction.tau": "5 mm"})


@pytest.mark.parametrize(
    ("path", "sentence"),
    [
        ("nolaws:Mine", "Python finds no module nolaws in installed packages and folders of yours; name the folder"),
        ("mylaws:Yours", "the module mylaws has no Yours"),
        ("broken:Mine", "the module cannot be imported: no law here"),
        ("__main__:Mine", "the class is known to the program that made it alone; put it into a module"),
        ("mylaws", "or a law of your own, as 'module:Class'"),
    ],
)
def test_path_that_names_no_law_is_refused(place, path, sentence):
    (place.parent / "path" / "broken.py").write_text("raise RuntimeError('no law here')", encoding="utf-8")
    with pytest.raises(SceneError) as error:
        Scene(friction={"law": path, "k": 2.0})
    assert f"friction.law is {path!r}; " in str(error.value) and sentence in str(error.value)


# -- every way of a run ----------------------------------------------------------------------------------------
def test_law_works_from_the_command_line(place):
    """A run, the run of its scene.json, and a report; the model is light, and friction that of the law."""
    done = command(place, "run", place / "scene.toml", "--model", "cylinders", "--out", place / "one")
    assert done.returncode == 0, done.stderr
    again = command(place, "run", place / "one" / "scene.json", "--out", place / "two")
    assert again.returncode == 0, again.stderr
    one, two = (json.loads((place / name / "summary.json").read_text()) for name in ("one", "two"))
    assert one["full_slip_mu_app"] == two["full_slip_mu_app"] == pytest.approx(0.2 * one["full_slip_f_contact"] / 75.0)
    assert one["parameters"] == two["parameters"] and one["parameters"]["friction"]["law"] == "mylaws:Mine"
    assert one["laws"]["friction"] == "Mine(k=2, tau=5000 Pa)"


def test_results_are_read_where_the_law_is_not(place):
    """Its code is not imported: a folder of results is from anywhere. What computes with the law imports it."""
    fp.run(Scene.load(place / "scene.toml"), model="cylinders", out=place / "one")
    edited(place)
    read = Result.load(place / "one")
    assert "mylaws" not in sys.modules and used(read.scene)["friction"] == "mylaws:Mine(k=2, tau=5000)"
    with pytest.raises(SceneError, match="friction is of the law 'mylaws:Mine', which is not imported"):
        read.scene.friction_law()
    with pytest.raises(SceneError, match="friction.law is 'mylaws:Mine', whose file was changed since"):
        fp.run(read.scene, model="cylinders")
    assert fp.run(read.scene.replace(friction=0.2), model="cylinders").full_slip is not None


def test_sweep_in_processes_takes_a_law(place):
    """Its processes import the law; one of this program alone is refused before any of them starts."""
    scene = small(friction=Scene.load(place / "scene.toml").friction, voltage=0.0, **COARSE)
    (found,) = fp.sweep(scene, place / "sweep", **{"friction.k": [1.0]}, quiet=True)
    assert found.failure == ""
    assert fp.run(scene).full_slip.f_t == pytest.approx(2 * found.full_slip.f_t, rel=0.02)  # its k is 2

    with pytest.raises(SceneError, match="friction is a Local, which the processes of a sweep cannot have"):
        fp.sweep(scene.replace(friction=_local()), place / "other", voltage=[0.0, 1.0])


def test_changed_law_is_not_resumed(place, capsys):
    scene = small(friction=Scene.load(place / "scene.toml").friction, voltage=0.0, **COARSE)
    with tables_alone():
        fp.run(scene, out=place / "run")
    words = ["run", "--resume", str(place / "run")]
    assert main(words) == 2 and "has no checkpoint to go on from" in capsys.readouterr().err
    edited(place)
    assert main(words) == 2 and "friction.law is 'mylaws:Mine', whose file was changed since" in capsys.readouterr().err
    with pytest.raises(SceneError, match="friction is a Local, which a run that goes on cannot have"):
        fp.run(scene.replace(friction=_local()), out=place / "run", resume=True)


def _local() -> fp.Friction:
    from dataclasses import dataclass

    @dataclass(frozen=True)
    class Local(fp.Friction):
        """A law that no other process can import."""

        def limit(self, p):
            return 0.3 * p

    return Local()


# -- hashes ----------------------------------------------------------------------------------------------------


def test_law_without_a_file_counts_in_its_process_alone():
    """Code of a session: the same key twice in one process, another one in the next."""
    code = (
        "from dataclasses import dataclass\nimport fingerpad as fp\n"
        "@dataclass(frozen=True)\nclass Mine(fp.Friction):\n    def limit(self, p): return 0.3 * p\n"
        "one, two = (fp.Scene(friction=Mine()).parameters()['friction'] for _ in range(2))\n"
        "assert one == two\nprint(one)\n"
    )
    found = {python("-c", code).stdout for _ in range(2)}
    assert len(found) == 2
    assert all("__main__:Mine" in text for text in found)
