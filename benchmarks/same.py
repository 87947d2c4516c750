"""Whether the code computes the same numbers as that of an older commit, to the last bit.

python3 -m benchmarks.same COMMIT [--but WORD ...] [--within PART] [--jobs 2]     some minutes; needs git, no dolfinx

Both programs run cases that between them go through every model, formulation, element and kind of load, laws of one's
own, mesh files, folders, newtons, bodies and two ranks; most are of a small finger. A case agrees where all steps,
loads and named states do, with their ridges, skin and counts of iterations; seconds, memory, versions and remarks are
left out. Where all agree, the two commits go to docs/same.json. ``make stale`` takes one for the other: a page of the
older one need not be made again because of a file that its numbers do not depend on.

Runs have a folder. Programs up to fe45c88 factorise at other places without one, and reach other last digits: that one
case is compared to 1e-6 of the largest number of a key.

A change that moves numbers by roundoff alone has ``--within``: a number may then differ by this part of the largest one
of its key, and the records of the solver's steps are left out. The pair is kept with this tolerance, and ``make stale``
names it. Two ranks, which add in another order in each run, always have one.

Numbers that a change is meant to change are left out by a word of their key, as in ``--but sed`` for full_slip_sed_0.
Then the two commits are the same for those pages alone whose programs do not have the word.
"""

import argparse
import json
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterable, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from benchmarks.pages import ROOT, SAME, git

_SMALL = tomllib.loads((ROOT / "demos/scenes/small_finger.toml").read_text(encoding="utf-8"))
_PROGRAM = (ROOT / "benchmarks/same_run.py").read_text(encoding="utf-8")
_PRESS, _CHARGE = {"name": "press", "f_ext": 1.0}, {"name": "charge", "voltage": 100.0}
_SLIDE = {"name": "slide", "bone_x": 0.6e-3, "until_full_slip": True}
_BACK = {"name": "back", "bone_x": -0.2e-3}
_SINE = {"waveform": "sine", "amplitude": 100.0, "frequency": 20.0}
_WAVE = {"name": "sine", "voltage": _SINE, "duration": 0.05}
_BODY = [["press", {"f_ext": 4.4}], ["charge", {"voltage": 150.0}], ["slide", {"until_full_slip": True}]]
SCENES: dict[str, dict[str, Any]] = {
    "errors estimated": {"output": {"errors": True}},
    "cylinders": {},
    "accuracy asked for": {"accuracy": {"mu_app": 0.05}},
    "20 µm": {"mesh": {"contact": 20e-6}},
    "receptors": {"output": {"receptors": True}},
    "Nitsche's method": {"contact": {"formulation": "nitsche"}},
    "Nitsche's method, symmetric": {"contact": {"formulation": "nitsche", "theta": 1}},
    "Nitsche's method, skew-symmetric": {"contact": {"formulation": "nitsche", "theta": -1}},
    "augmented Lagrangian": {"contact": {"formulation": "augmented"}},
    "linear elements": {"numerics": {"element": "P1"}},
    "cubic elements": {"numerics": {"element": "P3"}},
    "reduced quadrature": {"numerics": {"element": "P2 reduced"}},
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
    "waveform": {"history": [_PRESS, _SLIDE, _WAVE]},
    "waveform while sliding": {"history": [_PRESS, _SLIDE, _WAVE | {"bone_x_by": 1e-3}]},
    "speed": {"history": [_PRESS, _SLIDE | {"speed": 0.02}, _CHARGE]},
    "without a folder": {},
    "law of friction": {},
    "materials": {},
    "closure": {},
    "mesh file": {},
    "newtons": {},
    "newtons of cylinders": {"voltage": 200.0},
    "body": {},
    "body, Nitsche's method": {},
    "two ranks": {},
}
"""Changes of the small finger's scene by the name of the case."""

MORE: dict[str, dict[str, Any]] = {
    "cylinders": {"model": "cylinders", "default": True},
    "without a folder": {"without_folder": True, "within": 1e-6},
    "law of friction": {"friction": {"law": "Derjaguin", "mu_f": 0.3, "tau_0": 5e3}},
    "materials": {"materials": {"dermis": {"law": "NeoHooke", "shear_modulus": 2.5e3, "poisson": 0.45}}},
    "closure": {"closure": {"law": "BearingArea", "beta": 0.75}},
    "mesh file": {"mesh": True},
    "newtons": {"force": 0.005},
    "newtons of cylinders": {"model": "cylinders", "default": True, "force": 0.5},
    "body": {"body": _BODY, "contact": {"law": "Penalty", "eps_n": 1.5e12, "eps_t": 5e10}},
    "body, Nitsche's method": {"body": _BODY, "contact": {"law": "Nitsche", "gamma_0": 10.0}},
    "two ranks": {"ranks": 2, "within": 1e-6},
}
"""What else a case has, see benchmarks/same_run.py."""

_LEFT_OUT = ("seconds", "memory", "provenance", "folder", "version", "fingerpad", "notes")


def answer(name: str, root: Path) -> Any:
    """Return the states and loads of a case by the program in a folder, without what differs from run to run."""
    case = {"small": _SMALL, "scene": SCENES[name]} | MORE.get(name, {})
    ranks = ["mpirun", "-n", str(case["ranks"])] if "ranks" in case else []
    command = [str(ROOT / "environment" / "run"), *ranks, "python3", "-c", _PROGRAM]
    done = subprocess.run(command, cwd=root, input=json.dumps(case), text=True, capture_output=True, check=False)
    if done.returncode:
        last = (done.stderr.strip() or done.stdout.strip()).splitlines()[-1:]
        raise SystemExit(f"the program in {root} does not run the case {name}: {' '.join(last)}")
    return numbers(json.loads(done.stdout.strip().splitlines()[-1]))


def numbers(found: Any) -> Any:
    """Return a result without seconds, memory and versions."""
    if isinstance(found, dict):
        return {key: numbers(value) for key, value in found.items() if not any(word in key for word in _LEFT_OUT)}
    return [numbers(value) for value in found] if isinstance(found, list) else found


def differences(
    before: Any, now: Any, where: str = "", but: Sequence[str] = (), within: Mapping[str, float] | None = None
) -> Iterable[str]:
    """Yield where two results differ.

    Keys that only the present one has do not count, nor do those with a word of ``but``, nor a coefficient of friction
    that was zero where no force presses the finger, and is none now.

    Args:
        before: the older one.
        now: the present one.
        where: keys that lead to the two, with dots.
        but: words of keys that are left out.
        within: the largest difference of a number that is none, by its key; without it numbers are the same to the
            last bit.
    """
    if isinstance(before, dict) and isinstance(now, dict):
        for key, value in before.items():
            if not set(key.split("_")) & set(but):
                yield from differences(value, now.get(key), f"{where}.{key}".removeprefix("."), but, within)
    elif isinstance(before, list) and isinstance(now, list) and len(before) == len(now):
        for number, pair in enumerate(zip(before, now, strict=True)):
            yield from differences(*pair, f"{where}[{number}]", but, within)
    elif where.endswith("mu_app") and before == 0 and (now is None or now != now):
        return
    elif repr(before) != repr(now) and not _near(before, now, (within or {}).get(_key(where), 0.0)):  # nan equals nan
        yield f"{where}: {before} before, {now} now"


def _near(before: Any, now: Any, most: float) -> bool:
    return isinstance(before, float) and isinstance(now, float) and abs(before - now) <= most


def allowed(found: Any, part: float, where: str = "") -> dict[str, float]:
    """Return a part of the largest number of each key."""
    parts: Iterable[tuple[str, Any]] = ()
    if isinstance(found, dict):
        parts = ((f"{where}.{key}", value) for key, value in found.items())
    elif isinstance(found, list):
        parts = ((where, value) for value in found)
    elif isinstance(found, float) and found == found:
        return {_key(where): part * abs(found)}
    largest: dict[str, float] = {}
    for path, value in parts:
        for key, most in allowed(value, part, path).items():
            largest[key] = max(most, largest.get(key, 0.0))
    return largest


def _key(where: str) -> str:
    """Return the last key of several, without the place in a list."""
    return where.rpartition(".")[2].partition("[")[0]


def main(given: Sequence[str] | None = None) -> int:
    """Run all scenes by both programs and keep the two commits where all agree."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("commit", metavar="COMMIT", help="the older one")
    parser.add_argument("--but", nargs="+", default=[], metavar="WORD", help="keys with this word are left out")
    parser.add_argument("--within", type=float, default=0.0, metavar="PART", help="of the largest number of a key")
    parser.add_argument("--jobs", type=int, default=2, help="runs at a time")
    parser.add_argument("--docs", type=Path, default=ROOT / "docs", help="folder of the kept pairs of commits")
    args = parser.parse_args(given)
    if git("status", "--porcelain", "--", "geometry", "variational", "fingerpad").strip():
        parser.error("files of the packages are not in git yet; commit them, so that the two commits can be named")
    older, present = (git("rev-parse", "--short", name).decode().strip() for name in (args.commit, "HEAD"))
    with tempfile.TemporaryDirectory() as folder:
        git("worktree", "add", "--detach", folder, older)
        try:
            agree = _compare(Path(folder), args.jobs, args.but, args.within)
        finally:
            git("worktree", "remove", "--force", folder)
    if not agree:
        return 1
    path = args.docs / SAME
    kept = json.loads(path.read_text(encoding="utf-8")) if path.exists() else []
    looser = {name: part for name in SCENES if (part := MORE.get(name, {}).get("within", 0.0)) > args.within}
    more = {"but": args.but, "within": args.within, "looser": looser}  # the last by case
    kept = [pair for pair in kept if (pair["before"], pair.get("but", [])) != (older, args.but)]  # that said so before
    kept.append({"before": older, "now": present, "scenes": list(SCENES)} | {k: v for k, v in more.items() if v})
    path.write_text(json.dumps(kept, indent=1, ensure_ascii=False) + "\n", encoding="utf-8")
    exact = f"within {args.within:g}" if args.within else "to the last bit"
    print(f"{older} and {present} compute the same numbers of {len(SCENES)} scenes, {exact}; kept in {path}")
    return 0


def _compare(older: Path, jobs: int, but: Sequence[str], within: float) -> bool:
    """Print, case by case, whether both programs compute the same; return whether all agree."""

    def found(name: str) -> list[str]:
        before, now = answer(name, older), answer(name, ROOT)
        part = max(within, MORE.get(name, {}).get("within", 0.0))
        if part == 0:
            return list(differences(before, now, but=but))
        return list(differences(before, now, but=[*but, "record", "step"], within=allowed(before, part)))

    agree = True
    with ThreadPoolExecutor(jobs) as pool:
        for name, differ in zip(SCENES, pool.map(found, SCENES), strict=True):
            print(f"{name}: {differ[0] + f' ({len(differ)} in all)' if differ else 'the same'}", flush=True)
            agree &= not differ
    return agree


if __name__ == "__main__":
    sys.exit(main())
