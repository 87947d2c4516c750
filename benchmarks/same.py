"""Whether the code computes the same numbers as that of an older commit, to the last bit.

python3 -m benchmarks.same COMMIT [--but WORD ...] [--jobs 2]     some minutes; needs git and no dolfinx

Both programs run scenes that between them go through every model, formulation, element and kind of load; all but one
are of a small finger. A scene agrees where whole results do, counts of iterations and factorisations included; seconds,
memory, versions and remarks are left out. Where all agree, the two commits go to docs/same.json. ``make stale`` takes
one for the other: a page of the older one need not be made again because of a file that its numbers do not depend on.

Numbers that a change is meant to change are left out by a word of their key, as in ``--but sed`` for slip_sed_0. Then
the two commits are the same for those pages alone whose programs do not have the word.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterable, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from benchmarks.pages import ROOT, git

SAME = "same.json"
_SMALL = tomllib.loads((ROOT / "demos/scenes/small_finger.toml").read_text(encoding="utf-8"))
_PRESS, _CHARGE = {"name": "press", "f_ext": 1.0}, {"name": "charge", "voltage": 100.0}
_SLIDE = {"name": "slide", "bone_x": 0.6e-3, "until_full_slip": True}
_BACK = {"name": "back", "bone_x": -0.2e-3}
SCENES: dict[str, dict[str, Any]] = {
    "errors estimated": {"output": {"errors": True}},
    "cylinders": {"model": "cylinders"},
    "smooth finger": {"model": "smooth"},
    "accuracy asked for": {"accuracy": {"mu_app": 0.05}},
    "20 µm": {"mesh": {"contact": 20e-6}},
    "receptors": {"output": {"receptors": True}},
    "Nitsche's method": {"contact": {"formulation": "nitsche"}},
    "augmented Lagrangian": {"contact": {"formulation": "augmented"}},
    "linear elements": {"numerics": {"element": "P1"}},
    "mixed elements": {"numerics": {"element": "P2-P1"}},
    "other exponent, length by gap": {"materials": {"exponent": "abaqus"}, "contact": {"length": "gap"}},
    "400 V": {"voltage": 400.0},
    "much friction": {"friction": 0.9},
    "slide, charge, slide back": {"history": [_PRESS, _SLIDE, _CHARGE, _BACK]},
    "there and back, lift": {
        "history": [
            _PRESS,
            _CHARGE,
            _SLIDE,
            _BACK,
            {"name": "unload", "f_ext": 0.0},
            {"name": "up", "bone_height": 1e-4},
        ],
    },
    "bone height": {"history": [{"name": "press", "bone_height": -0.3e-3}, _CHARGE, _SLIDE]},
}
_LEFT_OUT = ("seconds", "memory", "provenance", "folder", "version", "fingerpad", "notes")
_RUN = """
import json, sys, warnings
import fingerpad as fp
warnings.simplefilter("ignore")
base, changes = json.load(sys.stdin)
model = changes.pop("model", "full")
small = fp.Scene(**base).replace(mesh={"contact": 40e-6}, output={"errors": False})
scene = (fp.Scene() if model == "cylinders" else small).replace(**changes)
print("\\n" + json.dumps(fp.run(scene, model=model).to_dict()))
"""


def answer(name: str, root: Path) -> Any:
    """Return the result of a scene by the program in a folder, without what differs from run to run."""
    command = [str(ROOT / "environment" / "run"), "python3", "-c", _RUN]
    done = subprocess.run(
        command, cwd=root, input=json.dumps([_SMALL, SCENES[name]]), text=True, capture_output=True, check=False
    )
    if done.returncode:
        raise SystemExit(f"the program in {root} does not run the scene {name}: {done.stderr.strip().splitlines()[-1]}")
    return numbers(json.loads(done.stdout.strip().splitlines()[-1]))


def numbers(found: Any) -> Any:
    """Return a result without seconds, memory and versions."""
    if isinstance(found, dict):
        return {key: numbers(value) for key, value in found.items() if not any(word in key for word in _LEFT_OUT)}
    return [numbers(value) for value in found] if isinstance(found, list) else found


def differences(before: Any, now: Any, where: str = "", but: Sequence[str] = ()) -> Iterable[str]:
    """Yield where two results differ.

    Keys that only the present one has do not count, nor do those with a word of ``but``, nor a coefficient of friction
    that was zero where no force presses the finger, and is none now.
    """
    if isinstance(before, dict) and isinstance(now, dict):
        for key, value in before.items():
            if not set(key.split("_")) & set(but):
                yield from differences(value, now.get(key), f"{where}.{key}".removeprefix("."), but)
    elif isinstance(before, list) and isinstance(now, list) and len(before) == len(now):
        for number, pair in enumerate(zip(before, now, strict=True)):
            yield from differences(*pair, f"{where}[{number}]", but)
    elif where.endswith("mu_app") and before == 0 and (now is None or now != now):
        return
    elif repr(before) != repr(now):  # nan equals nan
        yield f"{where}: {before} before, {now} now"


def main(given: Sequence[str] | None = None) -> int:
    """Run all scenes by both programs and keep the two commits where all agree."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("commit", metavar="COMMIT", help="the older one")
    parser.add_argument("--but", nargs="+", default=[], metavar="WORD", help="keys with this word are left out")
    parser.add_argument("--jobs", type=int, default=2, help="runs at a time")
    parser.add_argument("--docs", type=Path, default=ROOT / "docs", help="folder of the kept pairs of commits")
    args = parser.parse_args(given)
    if git("status", "--porcelain", "--", "geometry", "variational", "fingerpad").strip():
        parser.error("files of the packages are not in git yet; commit them, so that the two commits can be named")
    older, present = (git("rev-parse", "--short", name).decode().strip() for name in (args.commit, "HEAD"))
    with tempfile.TemporaryDirectory() as folder:
        git("worktree", "add", "--detach", folder, older)
        try:
            agree = _compare(Path(folder), args.jobs, args.but)
        finally:
            git("worktree", "remove", "--force", folder)
    if not agree:
        return 1
    path = args.docs / SAME
    kept = json.loads(path.read_text(encoding="utf-8")) if path.exists() else []
    but = {"but": args.but} if args.but else {}
    kept = [pair for pair in kept if (pair["before"], pair.get("but", [])) != (older, args.but)]  # that said so before
    kept.append({"before": older, "now": present, "scenes": list(SCENES)} | but)
    path.write_text(json.dumps(kept, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    print(f"{older} and {present} compute the same numbers of {len(SCENES)} scenes, to the last bit; kept in {path}")
    return 0


def _compare(older: Path, jobs: int, but: Sequence[str]) -> bool:
    """Print, scene by scene, whether both programs compute the same; return whether all agree."""

    def found(name: str) -> list[str]:
        return list(differences(answer(name, older), answer(name, ROOT), but=but))

    agree = True
    with ThreadPoolExecutor(jobs) as pool:
        for name, differ in zip(SCENES, pool.map(found, SCENES), strict=True):
            print(f"{name}: {differ[0] + f' ({len(differ)} in all)' if differ else 'the same'}", flush=True)
            agree &= not differ
    return agree


if __name__ == "__main__":
    sys.exit(main())
