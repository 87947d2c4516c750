"""What a notebook shows of results, and demos as notebooks."""

import json
import sys
from dataclasses import replace
from types import SimpleNamespace

import pytest

import fingerpad as fp
from benchmarks.notebook import main
from tests.commands import python
from tests.small_finger import small
from variational.caution import Caution

pytestmark = pytest.mark.slow
CELLS = """
import fingerpad as fp
scene = fp.Scene(voltage=100.0); scene
result = fp.run(scene, model="cylinders"); result
result.finger
fp.sweep(scene, voltage=[0.0, 100.0], model="cylinders", quiet=True)
result.plot("footprint")
import matplotlib.pyplot; result.plot("footprint")
fp.Body(fp.geometry.ridge(size=40e-6), fp.Ogden(86.76e3, -14.53, 0.48), friction=0.25).press(1.0)
"""


EXECUTE = """
import json, sys, nbclient, nbformat
book = nbformat.v4.new_notebook(cells=[nbformat.v4.new_code_cell(text) for text in sys.argv[1].splitlines()])
nbclient.NotebookClient(book, timeout=300, kernel_name="python3").execute()
print(json.dumps([[out["data"] for out in cell["outputs"] if "data" in out] for cell in book.cells]))
"""


@pytest.fixture(scope="module")
def shown(tmp_path_factory) -> list[dict[str, str]]:
    """What a kernel shows of the last value of each cell, by type."""
    done = python("-c", EXECUTE, CELLS.strip(), cwd=tmp_path_factory.mktemp("notebook"), JUPYTER_PLATFORM_DIRS="1")
    assert done.returncode == 0, done.stderr
    first, *others = json.loads(done.stdout)
    assert first == []
    return [each for (each,) in others]


def test_values_are_tables(shown):
    """A scene has what it changes, a result its headline, a finger newtons, a sweep its points, a body its state."""
    words = ("<td style", "raise the friction force", "friction force F_T (N)", "at full slip", "ridges in contact")
    for found, sentence in zip((*shown[:4], shown[6]), words, strict=True):
        assert sentence in found["text/html"] and found["text/html"].count("<table>") >= 1
        assert "array(" not in found["text/plain"] and "object at 0x" not in found["text/plain"]
    assert "voltage" in shown[0]["text/html"] and "friction" not in shown[0]["text/html"]


@pytest.mark.parametrize("cell", [4, 5], ids=["without pyplot", "with pyplot"])
def test_figure_is_a_picture(shown, cell):
    assert shown[cell]["image/png"].startswith("iVBORw0KGgo")


# -- without a kernel ------------------------------------------------------------------------------------------
def test_words_are_escaped():
    """Cautions and notes may have words of anybody's."""
    found = replace(fp.run(model="cylinders"), cautions=(Caution("a", "<script>a"),), notes=("<b>note",))._repr_html_()
    assert "&lt;script&gt;a" in found and "&lt;b&gt;note" in found and "<script>" not in found
    sweep = fp.sweep(model="cylinders", voltage=[100.0], quiet=True)
    assert "&lt;i&gt;" in replace(sweep, notes=("<i>",))._repr_html_()


@pytest.mark.parametrize("backend", ["module://matplotlib_inline.backend_inline", "nonsense"])
def test_pictures_of_a_command_have_no_backend(tmp_path, backend):
    """As a terminal of Jupyter has it; Matplotlib may refuse to be imported under it."""
    words = ["-m", "fingerpad", "microscale", "--plot", tmp_path / "a.png"]
    done = python(*words, MPLBACKEND=backend)
    assert done.returncode == 0 and (tmp_path / "a.png").exists(), done.stderr
    if backend != "nonsense":
        code = 'import fingerpad as fp; fp.run(model="cylinders").plot("footprint")'
        assert (done := python("-c", code, MPLBACKEND=backend)).returncode == 0, done.stderr


def test_each_step_is_passed_on():
    """In order, with the part of the path that is done; a call that raises ends the run."""
    seen = []
    scene = small(voltage=0.0, mesh={"contact": 40e-6}, output={"errors": False, "receptors": False})
    result = fp.run(scene, on_step=lambda state, part: seen.append((state, part)))
    assert [state.step for state, _ in seen] == [state.step for state in result.steps]
    parts = [part for _, part in seen]
    assert 0 <= min(parts) == parts[0] < 0.9 < max(parts) <= 1
    with pytest.raises(ZeroDivisionError):
        fp.run(scene, on_step=lambda state, part: 1 / 0)


# -- demos as notebooks: valid, without output, and their cells run one after the other ------------------------------
def test_cells_run(tmp_path, monkeypatch, capsys):
    """As Jupyter runs them: with its own arguments, without the script's file; the last cell shows its picture."""
    shown: list[str] = []
    monkeypatch.chdir(tmp_path)
    assert main(["drive_over_frequency", "made"]) == 0
    kept = json.loads((tmp_path / "made" / "drive_over_frequency.ipynb").read_text(encoding="utf-8"))
    display = SimpleNamespace(Image=str, display=shown.append)
    ipython = SimpleNamespace(display=display, version_info=(9, 0), get_ipython=lambda: None)
    monkeypatch.setitem(sys.modules, "IPython", ipython)
    monkeypatch.setitem(sys.modules, "IPython.display", display)
    monkeypatch.setattr(sys, "argv", ["ipykernel_launcher.py", "-f", "kernel.json"])
    monkeypatch.setattr(sys, "path", [*sys.path])
    monkeypatch.setenv("PYTHONPATH", "")
    names: dict = {"__name__": "__main__"}
    for cell in kept["cells"]:
        if cell["cell_type"] == "code":
            exec("".join(cell["source"]), names)
    assert shown == ["results/demos/drive_over_frequency/share.png"]
    assert capsys.readouterr().out
