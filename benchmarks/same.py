"""Whether the code computes the same numbers as that of an older commit, to the last bit.

python3 -m benchmarks.same COMMIT [--but WORD ...] [--within PART] [--jobs 2]     some minutes; needs git, no dolfinx

Both programs run the cases of benchmarks/same.toml, which between them go through every model, formulation, element and
kind of load, laws of one's own, mesh files, folders, newtons, bodies and two ranks; most are of a small finger. A case
agrees where all steps, loads and named states do, with their ridges, skin and counts of iterations; seconds, memory,
versions and remarks are left out.

Runs have a folder. Programs up to fe45c88 factorise at other places without one, and reach other last digits: that one
case is compared to 1e-6 of the largest number of a key.

A change that moves numbers by roundoff alone has ``--within``: a number may then differ by this part of the largest one
of its key, and the records of the solver's steps are left out. Two ranks, which add in another order in each run,
always have a tolerance. Numbers that a change is meant to change are left out by a word of their key, as in ``--but
sed`` for full_slip_sed_0.
"""

import argparse
import json
import re
import subprocess
import sys
import tempfile
import tomllib
from collections.abc import Iterator, Mapping, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path
from typing import Any

from benchmarks.pages import ROOT, git

_SMALL = tomllib.loads((ROOT / "demos/scenes/small_finger.toml").read_text(encoding="utf-8"))
_PROGRAM = (ROOT / "benchmarks/same_run.py").read_text(encoding="utf-8")
CASES: dict[str, dict[str, Any]] = tomllib.loads((ROOT / "benchmarks/same.toml").read_text(encoding="utf-8"))
_LEFT_OUT = ("seconds", "memory", "provenance", "folder", "version", "fingerpad", "notes")


def answer(name: str, root: Path) -> Any:
    """Return the states and loads of a case by the program in a folder, without what differs from run to run."""
    case = {"small": _SMALL, "scene": {}} | CASES[name]
    ranks = ["mpirun", "-n", str(case["ranks"])] if "ranks" in case else []
    command = [str(ROOT / "environment" / "run"), *ranks, "python3", "-c", _PROGRAM]
    done = subprocess.run(command, cwd=root, input=json.dumps(case), text=True, capture_output=True, check=False)
    if done.returncode:
        last = (done.stderr.strip() or done.stdout.strip()).splitlines()[-1:]
        raise SystemExit(f"the program in {root} does not run the case {name}: {' '.join(last)}")
    return numbers(json.loads(done.stdout.strip().splitlines()[-1]))


def numbers(found: Any) -> Any:
    """Return a result without seconds, memory and versions, and skin from left to right: ranks part it at random."""
    if isinstance(found, dict) and {"ridge", "x", "p_n"} <= set(found) and isinstance(found["x"], list):
        order = sorted(range(len(found["x"])), key=found["x"].__getitem__)
        return {key: [values[place] for place in order] for key, values in found.items()}
    if isinstance(found, dict):
        return {key: numbers(value) for key, value in found.items() if not any(word in key for word in _LEFT_OUT)}
    return [numbers(value) for value in found] if isinstance(found, list) else found


def leaves(found: Any, where: str = "") -> Iterator[tuple[str, Any]]:
    """Yield each value of a result with the keys that lead to it, and the length of each list."""
    if isinstance(found, dict):
        for key, value in found.items():
            yield from leaves(value, f"{where}.{key}".removeprefix("."))
    elif isinstance(found, list):
        yield f"{where}[]", len(found)
        for number, value in enumerate(found):
            yield from leaves(value, f"{where}[{number}]")
    else:
        yield where, found


def differences(
    before: Any, now: Any, but: Sequence[str] = (), within: Mapping[str, float] | None = None
) -> Iterator[str]:
    """Yield where two results differ.

    Keys that only the present one has do not count, nor do those with a word of ``but``, nor a coefficient of friction
    that was zero where no force presses the finger, and is none now.

    Args:
        before: the older one.
        now: the present one.
        but: words of keys that are left out.
        within: the largest difference of a number that is none, by its key; without it numbers are the same to the
            last bit.
    """
    present = dict(leaves(now))
    for where, value in leaves(before):
        other, most = present.get(where), (within or {}).get(_key(where), 0.0)
        if repr(value) == repr(other) or set(re.split(r"\W|_", where)) & set(but):  # nan equals nan
            continue
        if where.endswith("mu_app") and value == 0 and (other is None or other != other):
            continue
        if not (isinstance(value, float) and isinstance(other, float) and abs(value - other) <= most):
            yield f"{where}: {value} before, {other} now"


def allowed(found: Any, part: float) -> dict[str, float]:
    """Return a part of the largest number of each key."""
    largest = dict[str, float]()
    for where, value in leaves(found):
        if isinstance(value, float) and value == value:
            largest[_key(where)] = max(part * abs(value), largest.get(_key(where), 0.0))
    return largest


def _key(where: str) -> str:
    """Return the last key of several, without the place in a list."""
    return where.rpartition(".")[2].partition("[")[0]


def main(given: Sequence[str] | None = None) -> int:
    """Run all scenes by both programs and compare them case by case."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("commit", metavar="COMMIT", help="the older one")
    parser.add_argument("--but", nargs="+", default=[], metavar="WORD", help="keys with this word are left out")
    parser.add_argument("--within", type=float, default=0.0, metavar="PART", help="of the largest number of a key")
    parser.add_argument("--jobs", type=int, default=2, help="runs at a time")
    args = parser.parse_args(given)
    if git("status", "--porcelain", "--", "geometry", "variational", "fingerpad"):
        parser.error("files of the packages are not in git yet; commit them, so that the two commits can be named")
    older, present = (git("rev-parse", "--short", name) for name in (args.commit, "HEAD"))
    with tempfile.TemporaryDirectory() as folder:
        git("worktree", "add", "--detach", folder, older)
        try:
            agree = _compare(Path(folder), args.jobs, args.but, args.within)
        finally:
            git("worktree", "remove", "--force", folder)
    if not agree:
        return 1
    exact = f"within {args.within:g}" if args.within else "to the last bit"
    print(f"{older} and {present} compute the same numbers of {len(CASES)} scenes, {exact}")
    return 0


def _compare(older: Path, jobs: int, but: Sequence[str], within: float) -> bool:
    """Print, case by case, whether both programs compute the same; return whether all agree."""

    def found(name: str) -> list[str]:
        before, now = answer(name, older), answer(name, ROOT)
        part = max(within, CASES[name].get("within", 0.0))
        if part == 0:
            return list(differences(before, now, but=but))
        return list(differences(before, now, but=[*but, "record", "step"], within=allowed(before, part)))

    agree = True
    with ThreadPoolExecutor(jobs) as pool:
        for name, differ in zip(CASES, pool.map(found, CASES), strict=True):
            print(f"{name}: {differ[0] + f' ({len(differ)} in all)' if differ else 'the same'}", flush=True)
            agree &= not differ
    return agree


if __name__ == "__main__":
    sys.exit(main())
