"""Demos as notebooks: valid, without output, and their cells run one after the other."""

import json
import sys
from types import SimpleNamespace

import pytest

from benchmarks.demos import DEMOS
from benchmarks.notebook import main, notebook


@pytest.mark.parametrize("name", ["first_run", *DEMOS])
def test_notebook_has_the_demo(name):
    """All prose and code in the order of the script; each cell has an id of its own, and code compiles."""
    found = notebook(name)["cells"]
    assert len({cell["id"] for cell in found}) == len(found) > 3
    assert found[0]["cell_type"] == "markdown" and found[0]["source"][0].startswith("# ")
    code = ["".join(cell["source"]) for cell in found if cell["cell_type"] == "code"]
    for text in code:
        compile(text, name, "exec")
    assert "import fingerpad as fp" in "".join(code) and not any(cell.get("outputs") for cell in found)


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
