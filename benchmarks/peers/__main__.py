"""Meshes, cases and fingerpad's answers before the peers run, numbers and page after; benchmarks/peers/run does both.

environment/run python3 -m benchmarks.peers prepare FOLDER SIZE ... | page FOLDER | prepare-timed FOLDER | timed FOLDER
"""

import argparse
from dataclasses import replace
from pathlib import Path

from benchmarks.harness import DOCS, keep, kept, made
from benchmarks.peers import page, speed
from benchmarks.peers.exchange import TASKS, answer_path, cases, timed, write


def prepare(folder: Path, sizes: list[float]) -> None:
    """Write meshes, cases, the tasks of the peers, and the answers of fingerpad."""
    from benchmarks.peers import ours  # needs dolfinx, which a reader of answers does not

    folder.mkdir(parents=True, exist_ok=True)
    tasks = []
    for size in sizes:
        mesh = folder / f"{size:g}.npz"
        body = ours.make(size * 1e-3)
        ridge = ours.for_peers(body)
        ridge.save(mesh)
        for name, case in cases().items():
            answer = ours.solve(case, body, ridge.points[ridge.skin].reshape(-1, 2))
            write(answer, answer_path(folder, size, name, "", "ours"))
            print(f"fingerpad: {name}, facets of {size:g} µm, {answer.iterations} iterations", flush=True)
        for name, variant, peer in TASKS:
            case_path = folder / f"{name}_{variant}.json".replace(" ", "_")
            write(replace(cases()[name], variant=variant), case_path)
            tasks.append(f"{peer} {case_path} {mesh} {answer_path(folder, size, name, variant, peer)}")
    tasks.sort(key=lambda task: task.startswith("calculix"))  # the slowest last
    (folder / "tasks").write_text("\n".join(tasks) + "\n", encoding="utf-8")


def prepare_timed(folder: Path) -> None:
    """Write meshes, the timed case, and the tasks of all programs."""
    from benchmarks.peers import ours

    folder.mkdir(parents=True, exist_ok=True)
    write(timed(), case := folder / "case.json")
    for size in (*speed.SIZES, speed.FINEST):
        ours.for_peers(ours.make(size * 1e-3)).save(folder / f"{size:g}.npz")
    lines = [
        f"{program} {case} {folder / f'{size:g}.npz'} {answer_path(folder, size, 'timed', repeat, program)}"
        for size, repeat, program in speed.tasks()
    ]
    (folder / "tasks").write_text("\n".join(lines) + "\n", encoding="utf-8")


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("action", choices=("prepare", "page", "prepare-timed", "timed"))
    parser.add_argument("folder", type=Path)
    parser.add_argument("sizes", type=float, nargs="*")
    args = parser.parse_args()
    old = kept("peers", DOCS)
    if args.action == "prepare":
        prepare(args.folder, args.sizes)
    elif args.action == "prepare-timed":
        prepare_timed(args.folder)
    elif args.action == "timed":
        by = made()
        text = {"made": f"version {by.version} of {by.date} (source {by.source})"}
        keep("peers", old.numbers | {"speed": speed.numbers(args.folder) | text}, old.made, DOCS)
    else:
        keep("peers", page.numbers(args.folder) | {"speed": old.numbers["speed"]}, made(), DOCS)
    if args.action in ("page", "timed"):
        print(page.draw(DOCS))


if __name__ == "__main__":
    main()
