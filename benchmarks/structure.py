"""The size and shape of the code: what a reader has to climb.

python3 -m benchmarks.structure [--modules]     a second; needs nothing but Python

Prints lines by folder, modules, the levels of their imports, circles, modules of one importer and the modules that a
scene passes. A module's level is one above the highest of those that are imported at its head; a second number counts
those for type checkers as well. Circles and importers count all imports, also inside functions. A scene passes a
module where a function has a parameter, or returns a value, that is annotated as a Scene.
"""

import argparse
import ast
from collections import Counter
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PRODUCT = ("fingerpad", "variational", "geometry")
OTHERS = ("tests", "benchmarks")
LONGEST = 350  # lines of a module
Graph = Mapping[str, set[str]]


def modules(folder: str) -> dict[str, Path]:
    """Return the files of a folder by the dotted names of their modules."""
    found = {}
    for path in sorted((ROOT / folder).rglob("*.py")):
        parts = path.relative_to(ROOT).with_suffix("").parts
        found[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return found


@cache
def tree(path: Path) -> ast.Module:
    """Return the syntax tree of a file."""
    return ast.parse(path.read_text(encoding="utf-8"))


def lines(path: Path) -> int:
    """Return the number of lines of a file."""
    return len(path.read_text(encoding="utf-8").splitlines())


def imports(files: Mapping[str, Path], inside: tuple[type[ast.AST], ...] = (ast.AST,)) -> dict[str, set[str]]:
    """Return by module the other modules of the product that it imports.

    Args:
        files: of the product by module.
        inside: kinds of statements whose inner imports count; without any, those at the head of a module alone do.
    """
    return {name: set(_imported(tree(path), files, inside)) - {name} for name, path in files.items()}


def _imported(part: ast.AST, files: Mapping[str, Path], inside: tuple[type[ast.AST], ...]) -> Iterator[str]:
    """Yield the modules that a part of a program imports."""
    for node in ast.iter_child_nodes(part):
        if isinstance(node, ast.Import):
            yield from (alias.name for alias in node.names if alias.name in files)
        elif isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                inner = f"{node.module}.{alias.name}"
                if inner in files or node.module in files:
                    yield inner if inner in files else node.module
        if isinstance(node, inside):
            yield from _imported(node, files, inside)


def circles(graph: Graph) -> list[list[str]]:
    """Return the sets of modules that import each other, each sorted; a module of no circle is a set of its own."""
    reached = {name: _reached(name, graph) for name in graph}
    found = {tuple(sorted({name} | {other for other in reached[name] if name in reached[other]})) for name in graph}
    return [list(group) for group in sorted(found)]


def _reached(name: str, graph: Graph) -> set[str]:
    found, waiting = set[str](), [name]
    while waiting:
        new = graph[waiting.pop()] - found
        found |= new
        waiting += new
    return found


def levels(graph: Graph) -> dict[str, int]:
    """Return the level of each module, from 1; the modules of a circle have one."""
    circle = {name: tuple(group) for group in circles(graph) for name in group}

    @cache
    def level(group: tuple[str, ...]) -> int:
        below = {circle[other] for name in group for other in graph[name]} - {group}
        return 1 + max(map(level, below), default=0)

    return {name: level(group) for name, group in circle.items()}


def passed(files: Mapping[str, Path]) -> dict[str, tuple[int, int]]:
    """Return by module how many functions take a scene, and how many return one; those that a scene passes."""
    found = {}
    for name, path in files.items():
        functions = [node for node in ast.walk(tree(path)) if isinstance(node, ast.FunctionDef)]
        takes = sum(any(_is_scene(a.annotation) for a in [*f.args.args, *f.args.kwonlyargs]) for f in functions)
        returns = sum(_is_scene(f.returns) for f in functions)
        if takes or returns:
            found[name] = takes, returns
    return found


def _is_scene(annotation: ast.expr | None) -> bool:
    return annotation is not None and "Scene" in {
        word.strip("'\" ") for word in ast.unparse(annotation).replace("|", ",").split(",")
    }


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n", maxsplit=1)[0])
    parser.add_argument("--modules", action="store_true", help="list each module with level, lines and importers")
    given = parser.parse_args()
    files = {name: path for folder in PRODUCT for name, path in modules(folder).items()}
    for folder in (*PRODUCT, *OTHERS):
        print(f"{folder:<12} {sum(map(lines, modules(folder).values())):6} lines in {len(modules(folder))} modules")
    print(f"{'product':<12} {sum(map(lines, files.values())):6} lines in {len(files)} modules")
    graph = imports(files)
    importers = Counter(other for each in graph.values() for other in each)
    level, scene = levels(imports(files, ())), passed(files)
    typed = levels(imports(files, (ast.If,)))
    print(f"import levels: {max(level.values())}; {max(typed.values())} with imports for type checkers")
    found = [", ".join(group) for group in circles(graph) if len(group) > 1]
    print(f"circles: {len(found)}", *found, sep="\n  ")
    print(f"modules of one importer: {sum(importers[name] == 1 for name in files)}")
    print(f"over {LONGEST} lines: {', '.join(name for name, path in files.items() if lines(path) > LONGEST) or 'none'}")
    takes, returns = (sum(each[k] for each in scene.values()) for k in (0, 1))
    print(f"a scene passes {len(scene)} modules; {takes} functions take one, {returns} return one")
    if given.modules:
        for name in sorted(files, key=lambda each: (-level[each], each)):
            print(f"{level[name]:3} {lines(files[name]):5} {importers[name]:3} {name}")


if __name__ == "__main__":
    main()
