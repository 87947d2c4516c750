"""Demos as notebooks: valid, without output, and their cells run one after the other."""

import json
import sys
from types import SimpleNamespace

from benchmarks.notebook import main


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
