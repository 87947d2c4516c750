"""Settings of the documentation site; environment/docs builds it from the pages in place."""

import re
import sys
from pathlib import Path
from typing import Any, get_type_hints

HERE = Path(__file__).resolve().parent
ROOT = HERE.parents[1]
sys.path[:0] = [str(HERE), str(ROOT)]

import reference
from percent import Percent
from pydantic import BaseModel

import fingerpad.startup  # noqa: F401
from fingerpad.calculator import page as calculator
from fingerpad.cli import params
from fingerpad.scene import Scene
from fingerpad.scene.keys import every

project, author = "fingerpad", "The fingerpad developers"
version = re.search(r'^version = "(.*)"', (ROOT / "pyproject.toml").read_text(), re.MULTILINE)[1]
copyright = f"{author}; text and program under the GNU Lesser General Public License, version 3 or later"

root_doc = "docs/README"
include_patterns = [
    "docs/*.md", "docs/site/*.md", "docs/site/modules/*.md", "demos/README.md", "demos/*.py", "CONTRIBUTING.md",
    "CHANGELOG.md",
]  # fmt: skip
exclude_patterns = ["build/**", "results/**", "docs/site/contents.md", "docs/site/*.py"]
source_suffix = {".md": "markdown", ".py": "percent"}
extensions = [
    "myst_parser", "mathml", "sphinx.ext.autodoc", "sphinx.ext.napoleon", "sphinx.ext.viewcode",
]  # fmt: skip

myst_enable_extensions = ["dollarmath"]
myst_heading_anchors = 4
myst_dmath_double_inline = True

viewcode_follow_imported_members = False
toc_object_entries = False  # hundreds, in the navigation of every page
add_module_names = False
autodoc_member_order = "bysource"
autodoc_default_options = {"exclude-members": "model_config, model_post_init, set"}  # of Pydantic, Matplotlib
autodoc_typehints = "description"
autodoc_typehints_description_target = "documented"
autodoc_preserve_defaults = True
napoleon_use_rtype = False
# Types of other libraries and of variables in signatures have no page here.
nitpick_ignore_regex = [
    ("py:.*", r"(?!(geometry|variational|fingerpad)\.).*"),
    ("py:.*", r"variational\.state\._WithOwn"),  # a base without a page
    ("py:.*", r"fingerpad\.(runs\.processes\.(Key|Result)|scene\.(loads\.load_name|Scene\.replace|load))"),
]

html_theme = "furo"
html_title = f"fingerpad {version}"
html_static_path = ["_static"]
html_css_files = ["site.css"]
CALCULATOR = ROOT / "build" / "calculator.html"  # the page of the closed form, made at every build
CALCULATOR.parent.mkdir(exist_ok=True)
CALCULATOR.write_text(calculator.page(), encoding="utf-8")
html_extra_path = ["_extra", "../../build/calculator.html"]
html_math_renderer = "mathml"
html_search_scorer = str(HERE / "scorer.js")
html_copy_source = False
html_show_sphinx = False

# Pages of a code host, which the site has elsewhere or in another form.
ELSEWHERE = {
    "](../demos/scenes)": "](site/scenes.md)",
    "](../README.md)": "](README.md)",
}
PLACE = re.compile(r"`((?:geometry|variational|fingerpad)[a-z_.]*):(\w+)`")


# Words of readers, which lead a search to a page or to its part under a heading.
WORDS = {
    "docs/command": {"": ["Windows", "WSL", "macOS", "Docker", "conda", "install"], "## Targets": ["target"]},
    "docs/drive": {"": ["alternating voltage", "frequency", "waveform"]},
    "docs/measured": {"## What is felt": ["nerve", "perception", "spike"]},
    "docs/fingers": {"": ["child", "old", "moisture", "sweat", "callus"]},
    "docs/newtons": {"": ["newton", "contact area"]},
    "docs/scene": {"## `[electric]`": ["coating", "insulator", "dielectric", "permittivity"]},
    "docs/laws": {"## Viscous layers": ["viscous", "relaxation", "creep"]},
}


def adapt(app: Any, docname: str, source: list[str]) -> None:
    """Make places in the code links to the reference, lead links to folders to pages, and index words of readers.

    The front page is the table from a question to a page, with the beginning of the README and the table of contents.
    """
    if docname == root_doc:
        questions = source[0].replace("# Documentation: from", "## From", 1)
        source[0] = (HERE / "contents.md").read_text(encoding="utf-8").replace("<!-- questions -->", questions)
    for heading, words in WORDS.get(docname, {}).items():
        index = "```{index} " + ", ".join(f"!{word}" for word in words) + "\n```\n\n"
        before, found, after = source[0].partition(f"{heading}\n" if heading else "# ")
        assert found, f"{docname} has no heading {heading}"
        source[0] = before + index + found + after
    if docname.startswith("docs/") and "/site/" not in docname:
        text = PLACE.sub(r"{py:obj}`\1:\2 <\1.\2>`", source[0])
        text = re.sub(r"\[(\w+\.md)\]\((\1(?:#[\w-]+)?)\)", r"[](\2)", text)  # by titles of pages, not by files
        for before, after in ELSEWHERE.items():
            text = text.replace(before, after)
        source[0] = text
    if docname == "demos/README":
        demos = (f"{name.stem}" for name in sorted((ROOT / "demos").glob("*.py")))
        source[0] += "\n```{toctree}\n:hidden:\n\n" + "\n".join(demos) + "\n```\n"


def plain_text(app: Any, what: str, name: str, thing: Any, options: Any, lines: list[str]) -> None:
    """Take bars in the text of an attribute for absolute values, and what stands before a colon for no type."""
    if what in ("attribute", "property", "data"):
        lines[:] = ["..", "", *(line if "`" in line else line.replace("|", "\\|") for line in lines)]


def plain_types(model: type[BaseModel]) -> None:
    """Leave the ranges out of the types of a table of the scene; they are in the scene reference."""
    for table in model.__subclasses__():
        hints = get_type_hints(table)
        table.__annotations__ = {name: hints[name] for name in table.__annotations__}
        plain_types(table)


def setup(app: Any) -> None:
    """Register what is above."""
    reference.write(HERE / "modules")
    (ROOT / "docs/scene.md").write_text(params.page([*every(Scene)]) + "\n", encoding="utf-8")
    plain_types(BaseModel)
    app.add_source_parser(Percent)
    app.connect("source-read", adapt)
    app.connect("autodoc-process-docstring", plain_text, priority=400)  # before Napoleon
