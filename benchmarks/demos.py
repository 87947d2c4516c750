"""Keep what the demos print and draw at small size, for their pages: demos/output/.

environment/run python3 -m benchmarks.demos [NAME ...]

The first run is left out: at its own size it takes minutes, and the README has its output. tests/test_demos.py compares
what is kept with what a demo prints.
"""

import argparse
import os
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from pathlib import Path

from PIL import Image

ROOT = Path(__file__).resolve().parents[1]
OUTPUT = ROOT / "demos" / "output"
WIDTH = 800  # pixels of a picture
DEMOS = sorted(path.stem for path in (ROOT / "demos").glob("*.py") if path.stem != "first_run")


def keep(name: str, into: Path = OUTPUT) -> None:
    """Run a demo; write its output to NAME.txt and its pictures, of few colours, to NAME_PICTURE.png."""
    with tempfile.TemporaryDirectory() as folder:
        command = [sys.executable, str(ROOT / "demos" / f"{name}.py"), folder]
        variables = {**os.environ, "PYTHONPATH": str(ROOT)}
        done = subprocess.run(command, env=variables, cwd=folder, stdout=subprocess.PIPE, text=True, check=True)
        into.mkdir(exist_ok=True)
        (into / f"{name}.txt").write_text(done.stdout, encoding="utf-8")
        for path in Path(folder).glob("*.png"):
            with Image.open(path) as picture:
                small = picture.convert("RGB").resize((WIDTH, round(picture.height * WIDTH / picture.width)))
                small.quantize(128).save(into / f"{name}_{path.name}", optimize=True)


def main(words: Sequence[str] | None = None) -> int:
    """Keep the output of the named demos, or of all."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("name", nargs="*", choices=[[], *DEMOS], default=[])
    for name in parser.parse_args(words).name or DEMOS:
        keep(name)
        print(name)
    return 0


if __name__ == "__main__":
    raise SystemExit(main())
