"""The size and shape of the code: what a reader has to climb.

python3 -m benchmarks.structure [--modules]     a second; needs nothing but Python

Lines of code are those without docstrings, comments and blank lines. A module's level is one above the highest of the
modules that it imports, at its head, inside functions and for type checkers; circles and importers count the same. A
scene passes a module where a function has a parameter, or returns a value, that is annotated as a Scene. A list of
quantities is a literal collection of three or more names of quantities outside of the module that defines them. A test
of a law is an isinstance on a class of contact, materials, attraction or roughness that is no interface: laws answer
such questions by methods. Public names are functions and classes without a leading underscore; the promised ones stand
in the __all__ of fingerpad.
"""

import argparse
import ast
import io
import tokenize
from collections import Counter
from collections.abc import Iterator, Mapping
from functools import cache
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
PRODUCT = ("fingerpad", "variational", "geometry")
OTHERS = ("tests", "benchmarks")
LONGEST = 350  # lines of a module
LAWS = tuple(f"variational.{part}." for part in ("contact", "materials", "attraction", "roughness"))
QUANTITIES = "fingerpad.results.quantities"
_LAYOUT = {
    *(tokenize.COMMENT, tokenize.NL, tokenize.NEWLINE, tokenize.INDENT, tokenize.DEDENT, tokenize.ENDMARKER),
}
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


def code(path: Path) -> int:
    """Return the number of lines of a file without docstrings, comments and blank lines."""
    text = path.read_text(encoding="utf-8")
    prose = set[int]()
    for node in ast.walk(tree(path)):
        if isinstance(node, ast.Expr) and isinstance(node.value, ast.Constant) and isinstance(node.value.value, str):
            prose |= set(range(node.lineno, (node.end_lineno or node.lineno) + 1))
    found = set[int]()
    for token in tokenize.generate_tokens(io.StringIO(text).readline):
        if token.type not in _LAYOUT:
            found |= set(range(token.start[0], token.end[0] + 1))
    return len(found - prose)


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


def for_checkers(files: Mapping[str, Path]) -> int:
    """Return the number of imports of modules of the product that type checkers alone read."""
    blocks = [
        (name, node)
        for name, path in files.items()
        for node in tree(path).body
        if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test)
    ]
    return sum(len(set(_imported(node, files, (ast.AST,)))) for _, node in blocks)


def public(path: Path) -> set[str]:
    """Return the public functions and classes of a module."""
    found = {node.name for node in tree(path).body if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    return {name for name in found if not name.startswith("_")}


def tests_of_laws(files: Mapping[str, Path]) -> list[str]:
    """Return the places, as module:line, where isinstance has a law of the package."""
    laws = {
        node.name
        for name, path in files.items()
        if name.startswith(LAWS)
        for node in ast.walk(tree(path))
        if isinstance(node, ast.ClassDef)
        and any(ast.unparse(base) not in ("ABC", "NamedTuple", "Named", "Law") for base in node.bases)
    }
    return [
        f"{name}:{node.lineno}"
        for name, path in files.items()
        for node in ast.walk(tree(path))
        if isinstance(node, ast.Call) and ast.unparse(node.func) == "isinstance" and laws & _names(node.args[1])
    ]


def _names(part: ast.AST) -> set[str]:
    return {each.id for each in ast.walk(part) if isinstance(each, ast.Name)}


def lists_of_quantities(files: Mapping[str, Path]) -> list[str]:
    """Return the places, as module:line, of literal collections of names of quantities, but for those inside others."""
    known = {
        node.elts[0].value
        for node in ast.walk(tree(files[QUANTITIES]))
        if isinstance(node, ast.Tuple) and len(node.elts) > 2 and isinstance(node.elts[0], ast.Constant)
    }
    found = []
    for name, path in files.items():
        if name != QUANTITIES:
            inner = set[ast.AST]()
            for node in ast.walk(tree(path)):
                items = node.keys if isinstance(node, ast.Dict) else getattr(node, "elts", [])
                named = sum(isinstance(each, ast.Constant) and each.value in known for each in items)
                if named >= 3 and node not in inner:
                    inner |= set(ast.walk(node))
                    found.append(f"{name}:{getattr(node, 'lineno', 0)}")
    return found


def longest(files: Mapping[str, Path]) -> tuple[int, str]:
    """Return the lines and the name of the longest function."""
    return max(
        ((node.end_lineno or 0) - node.lineno + 1, f"{name}.{node.name}")
        for name, path in files.items()
        for node in ast.walk(tree(path))
        if isinstance(node, ast.FunctionDef)
    )


def words() -> tuple[int, int]:
    """Return the pages of docs that are written, not built, and their words."""
    pages = [page for page in sorted((ROOT / "docs").glob("*.md")) if page.name != "scene.md"]
    return len(pages), sum(len(page.read_text(encoding="utf-8").split()) for page in pages)


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=(__doc__ or "").split("\n\n", maxsplit=1)[0])
    parser.add_argument("--modules", action="store_true", help="list each module with level, lines and importers")
    given = parser.parse_args()
    files = {name: path for folder in PRODUCT for name, path in modules(folder).items()}
    for folder in (*PRODUCT, *OTHERS):
        print(f"{folder:<12} {sum(map(lines, modules(folder).values())):6} lines in {len(modules(folder))} modules")
    print(f"{'product':<12} {sum(map(lines, files.values())):6} lines in {len(files)} modules, of code", end=" ")
    print(sum(map(code, files.values())))
    print("docs         {1:6} words on {0} pages".format(*words()))
    graph = imports(files)
    importers = Counter(other for each in graph.values() for other in each)
    level, scene = levels(graph), passed(files)
    print(f"import levels: {max(level.values())}, {max(levels(imports(files, ())).values())} at the heads of modules")
    print(f"imports for type checkers: {for_checkers(files)}")
    found = [", ".join(group) for group in circles(graph) if len(group) > 1]
    print(f"circles: {len(found)}", *found, sep="\n  ")
    print(f"modules of one importer: {sum(importers[name] == 1 for name in files)}")
    print(f"over {LONGEST} lines: {', '.join(name for name, path in files.items() if lines(path) > LONGEST) or 'none'}")
    print("longest function: {} lines, {}".format(*longest(files)))
    takes, returns = (sum(each[k] for each in scene.values()) for k in (0, 1))
    print(f"a scene passes {len(scene)} modules; {takes} functions take one, {returns} return one")
    print(f"public names: {sum(len(public(path)) for path in files.values())}")
    for title, places in (
        ("lists of quantities", lists_of_quantities(files)),
        ("isinstance on laws", tests_of_laws(files)),
    ):
        print(f"{title}: {len(places)}", *(places if given.modules else ()), sep="\n  ")
    if given.modules:
        for name in sorted(files, key=lambda each: (-level[each], each)):
            print(f"{level[name]:3} {lines(files[name]):5} {importers[name]:3} {name}")


if __name__ == "__main__":
    main()
