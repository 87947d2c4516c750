"""Pictures of a result that was read from its folder: as the run itself draws them."""

import re
import shutil

import pytest
from matplotlib.backends.backend_agg import FigureCanvasAgg

import fingerpad as fp
from fingerpad.scene import from_data
from tests.runs import no_pictures
from tests.small_finger import NINE

pytestmark = pytest.mark.slow
KINDS = ("history", "surface", "finger")
RUNS = {"plain": {"output": {"errors": False}}, "refined": {"accuracy": {"mu_app": 0.2}}}


@pytest.fixture(scope="module", params=RUNS)
def ran(request, tmp_path_factory) -> fp.Result:
    """A run on one mesh, and one whose named states are on a finer mesh than its path."""
    with no_pictures():
        scene = from_data(NINE | {"f_ext": 1.0, "voltage": 100.0} | RUNS[request.param])
        return fp.run(scene, out=tmp_path_factory.mktemp("run") / "out")


def pixels(figure) -> bytes:
    canvas = FigureCanvasAgg(figure)
    canvas.draw()
    return bytes(canvas.buffer_rgba())


@pytest.mark.parametrize("kind", KINDS)
def test_picture_is_that_of_the_run(ran, kind):
    assert pixels(fp.Result.load(ran.folder).plot(kind)) == pixels(ran.plot(kind))


@pytest.mark.parametrize(("kind", "missing"), [("surface", "surface.npz"), ("finger", "finger_*.npz")])
def test_picture_whose_arrays_are_gone_is_refused(ran, tmp_path, kind, missing):
    bare = shutil.copytree(ran.folder, tmp_path / "bare", ignore=shutil.ignore_patterns("*.npz", "*.bp"))
    read = fp.Result.load(bare)
    assert read.plot("history").axes
    with pytest.raises(ValueError, match=re.escape(f"its folder has no {missing}")):
        read.plot(kind)


def test_folder_is_kept_and_a_damaged_file_is_none(ran, tmp_path, monkeypatch):
    """Where the program goes to another folder; and where a file was cut short."""
    shutil.copytree(ran.folder, tmp_path / "a", ignore=shutil.ignore_patterns("*.bp"))
    (tmp_path / "b").mkdir()
    monkeypatch.chdir(tmp_path)
    read = fp.Result.load("a")
    monkeypatch.chdir(tmp_path / "b")
    assert read.plot("surface").axes
    whole = (tmp_path / "a" / "surface.npz").read_bytes()
    (tmp_path / "a" / "surface.npz").write_bytes(whole[: len(whole) // 2])
    with pytest.raises(ValueError, match=r"its folder has no surface\.npz"):
        read.plot("surface")
