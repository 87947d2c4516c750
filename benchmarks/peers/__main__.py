"""One ridge in another program, and by a plain dolfinx script at equal error.

environment/run python3 -m benchmarks.peers prepare FOLDER SIZE ... | page FOLDER     by benchmarks/peers/run
environment/run python3 -m benchmarks.peers equal

``prepare`` writes meshes, cases and fingerpad's answers; ``page`` keeps the answers of both programs.
"""

import argparse
from pathlib import Path

from benchmarks.harness import DOCS, RESULTS, keep, kept, made, page, picture
from benchmarks.peers import compared
from benchmarks.peers.exchange import cases, write


def prepare(folder: Path, sizes: list[float]) -> None:
    """Write meshes, cases, the tasks of NGSolve, and the answers of fingerpad; facets in µm."""
    from benchmarks.peers import ours  # needs dolfinx, which a reader of answers does not

    folder.mkdir(parents=True, exist_ok=True)
    tasks = []
    for size in sizes:
        body = ours.make(size * 1e-3)
        ridge = ours.for_peers(body)
        ridge.save(mesh := folder / f"{size:g}.npz")
        for name, case in cases().items():
            answer = ours.solve(case, body, ridge.points[ridge.skin].reshape(-1, 2))
            write(answer, folder / f"ours_{name}_{size:g}.json")
            print(f"fingerpad: {name}, facets of {size:g} µm, {answer.iterations} iterations", flush=True)
            write(case, folder / f"{name}.json")
            tasks.append(f"{folder / name}.json {mesh} {folder / f'ngsolve_{name}_{size:g}.json'}")
    (folder / "tasks").write_text("\n".join(tasks) + "\n", encoding="utf-8")


def draw(docs: Path) -> Path:
    """Put the numbers of docs/peers.json in place, and draw their picture."""
    found = kept("peers", docs).numbers
    rows = found["equal"]["rows"]
    picture(docs / "peers_equal_error.png", (11, 4), lambda figure: compared.paint(figure, rows))
    names = {"summary": compared.summary(found), "equal": found["equal"], **compared.words(rows)}
    return page(docs, "peers", "benchmarks/peers/run", vars(compared) | names)


def main() -> None:
    """Read the command line."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("action", choices=("prepare", "page", "equal"))
    parser.add_argument("folder", type=Path, nargs="?", default=RESULTS / "peers")
    parser.add_argument("sizes", type=float, nargs="*")
    args = parser.parse_args()
    if args.action == "prepare":
        prepare(args.folder, args.sizes)
        return
    old, by = kept("peers", DOCS), made()
    if args.action == "page":
        keep("peers", compared.numbers(args.folder) | {"equal": old.numbers["equal"]}, by, DOCS)
    else:
        from benchmarks.peers import equal  # needs dolfinx

        text = {"made": f"version {by.version} of {by.date} (source {by.source})"}
        keep("peers", old.numbers | {"equal": equal.numbers() | text}, old.made, DOCS)
    print(draw(DOCS))


if __name__ == "__main__":
    main()
