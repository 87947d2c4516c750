"""Make a notebook of a demo: environment/run python3 -m benchmarks.notebook NAME [FOLDER], or make notebook DEMO=NAME

The notebook is results/NAME.ipynb by default, in Jupyter's format 4.5 (https://nbformat.readthedocs.io) and without
output. Cells of the script become cells; the first one stands for the command line, and the last one shows pictures.
"""

import argparse
import json
from collections.abc import Sequence
from pathlib import Path
from typing import Any

from benchmarks.demos import DEMOS, ROOT

# A notebook has neither a file nor arguments of its own.
_BEGIN = """import os, sys

__file__ = {script!r}
sys.argv = [__file__]
sys.path.insert(0, {root!r})
os.environ["PYTHONPATH"] = {root!r}  # of processes of a sweep
"""
_END = """from pathlib import Path

from IPython.display import Image, display

for picture in sorted([*Path(".").glob("*.png"), *Path("results/demos/{name}").glob("*.png")]):
    display(Image(picture))
"""


def cells(script: str) -> list[tuple[bool, str]]:
    """Return the cells of a script in percent format: whether it is prose, and its text."""
    found: list[tuple[bool, list[str]]] = [(False, [])]
    for line in script.splitlines():
        if line.startswith("# %%"):
            found.append(("[markdown]" in line, []))
        elif not line.startswith("# fmt:"):
            prose, lines = found[-1]
            lines.append(line.removeprefix("#").removeprefix(" ") if prose else line)
    return [(prose, text) for prose, lines in found if (text := "\n".join(lines).strip("\n"))]


def notebook(name: str) -> dict[str, Any]:
    """Return a demo as a notebook, ready for JSON."""
    script = ROOT / "demos" / f"{name}.py"
    begin, end = _BEGIN.format(script=str(script), root=str(ROOT)), _END.format(name=name)
    title, *rest = cells(script.read_text(encoding="utf-8"))
    return {
        "cells": [_cell(k, *each) for k, each in enumerate([title, (False, begin), *rest, (False, end)])],
        "metadata": {"kernelspec": {"display_name": "Python 3", "language": "python", "name": "python3"}},
        "nbformat": 4,
        "nbformat_minor": 5,
    }


def _cell(number: int, prose: bool, text: str) -> dict[str, Any]:
    code: dict[str, Any] = {} if prose else {"execution_count": None, "outputs": []}
    kind = "markdown" if prose else "code"
    return {"cell_type": kind, "id": f"cell-{number}", "metadata": {}, "source": text.splitlines(keepends=True)} | code


def main(words: Sequence[str] | None = None) -> int:
    """Write the notebook of the named demo."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("name", choices=["first_run", *DEMOS])
    parser.add_argument("folder", nargs="?", type=Path, default=Path("results"))
    asked = parser.parse_args(words)
    asked.folder.mkdir(parents=True, exist_ok=True)
    file = asked.folder / f"{asked.name}.ipynb"
    file.write_text(json.dumps(notebook(asked.name), indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    print(f"{file}: environment/add jupyterlab, then environment/run jupyter lab {file}")
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
