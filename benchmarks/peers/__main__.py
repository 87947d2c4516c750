"""Meshes, cases and fingerpad's answers before the peers run, numbers and page after; benchmarks/peers/run does both.

environment/run python3 -m benchmarks.peers prepare FOLDER SIZE ... | page FOLDER
"""

import argparse
from dataclasses import replace
from pathlib import Path

from benchmarks.harness import DOCS, keep, made
from benchmarks.peers import page
from benchmarks.peers.exchange import TASKS, answer_path, cases, write


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


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("action", choices=("prepare", "page"))
    parser.add_argument("folder", type=Path)
    parser.add_argument("sizes", type=float, nargs="*")
    args = parser.parse_args()
    if args.action == "prepare":
        prepare(args.folder, args.sizes)
    else:
        keep("peers", page.numbers(args.folder), made(), DOCS)
        print(page.draw(DOCS))


if __name__ == "__main__":
    main()
