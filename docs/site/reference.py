"""Pages of the Python reference: one for each folder of the packages, with the modules in it."""

from pathlib import Path
from types import ModuleType

import fingerpad

ROOT = Path(__file__).resolve().parents[2]
PACKAGES = ("geometry", "variational", "fingerpad")
# Tables that have no docstring, and that pages and docstrings name.
TABLES = {
    "geometry.tags": ("LAYERS", "Numbers of the layers, by the names of the physical groups."),
    "variational.element": ("ELEMENTS", "Elements by their names in a scene."),
    "fingerpad.results.states": ("STATES", "Names of the states of a run, in the order of a history."),
}
SKIPPED = {"fingerpad/__main__.py"}  # runs the command


def folders() -> dict[str, list[str]]:
    """Return the modules of every folder, by the dotted name of the folder."""
    found: dict[str, list[str]] = {}
    for package in PACKAGES:
        for path in sorted((ROOT / package).rglob("*.py")):
            name = path.relative_to(ROOT)
            if name.as_posix() not in SKIPPED:
                module = ".".join(name.with_suffix("").parts).removesuffix(".__init__")
                found.setdefault(".".join(name.parent.parts), []).append(module)
    return found


def door() -> dict[str, list[str]]:
    """Return the names that import fingerpad gives, by the module that defines them; api.md describes them."""
    homes: dict[str, list[str]] = {}
    for name in fingerpad.__all__:
        if isinstance(named := getattr(fingerpad, name), ModuleType):
            continue
        homes.setdefault(named.__module__, []).append(name)
    return homes


def page(folder: str, modules: list[str], described: dict[str, list[str]]) -> str:
    """Return the page of a folder."""
    lines = [f"# `{folder}`", ""]
    for module in modules:
        if module != folder:
            lines += [f"## `{module}`", ""]
        lines += ["```{eval-rst}", f".. automodule:: {module}"]
        lines += ["   :members:", "   :ignore-module-all:", "   :show-inheritance:"]
        if module in described:
            lines += [f"   :exclude-members: +{', '.join(described[module])}"]
        if module in TABLES:
            name, meaning = TABLES[module]
            lines += ["", f".. py:data:: {name}", f"   :module: {module}", "", f"   {meaning}"]
        lines += ["```", ""]
    return "\n".join(lines)


def write(into: Path) -> None:
    """Write the pages that have changed, and delete those of folders that are gone."""
    into.mkdir(exist_ok=True)
    described = door()
    pages = {f"{folder}.md": page(folder, modules, described) for folder, modules in folders().items()}
    for old in set(into.glob("*.md")) - {into / name for name in pages}:
        old.unlink()
    for name, text in pages.items():
        if not (into / name).exists() or (into / name).read_text(encoding="utf-8") != text:
            (into / name).write_text(text, encoding="utf-8")
