"""Pages as text: README, CONTRIBUTING and docs/ name what exists, agree with each other, and are in short sentences."""

import ast
import json
import os
import re
import shlex
import subprocess
from collections.abc import Iterator
from html.parser import HTMLParser
from pathlib import Path
from types import ModuleType
from urllib.parse import unquote, urlsplit

import pytest

import fingerpad
from fingerpad import cli
from fingerpad.results.quantities import FINGER
from tests.pages import ROOT, alike, blocks, printed, sentences, words

PAGES = ["README.md", "CONTRIBUTING.md", "demos/README.md"]
PAGES += [f"docs/{page.name}" for page in sorted((ROOT / "docs").glob("*.md")) if page.name != "scene.md"]  # built
README, LAWS, COMMAND = (
    (ROOT / name).read_text(encoding="utf-8") for name in ("README.md", "docs/laws.md", "docs/command.md")
)
COMMANDS = [line.split("#")[0] for line in re.findall(r"^    (?:mpirun .*)?(fingerpad .*)$", COMMAND, re.MULTILINE)]


def text(page: str | Path) -> str:
    """Return a page as it is read: without comments, which hold the expressions of its numbers."""
    return re.sub(r"<!--.*?-->", "", (ROOT / page).read_text(encoding="utf-8"), flags=re.DOTALL)


def code(block: str) -> list[str]:
    return [line for line in (line.split("  #")[0].strip() for line in block.splitlines()) if line]


def test_readme_fits_a_screen():
    assert len(README.splitlines()) <= 66


def test_door_is_the_demo():
    """Every line of Python of the README is one of the first demo, which runs them; so is the body of docs/laws.md."""
    demo = code((ROOT / "demos" / "first_run.py").read_text(encoding="utf-8"))
    body = [block for block, _ in blocks(LAWS) if "ridge.press(4.4)" in block]
    lines = [line for block in [*(block for block, _ in blocks(README)), *body] for line in code(block)]
    assert len(lines) > 10 and [line for line in lines if line not in demo] == []


def test_closed_form_prints_the_readme(tmp_path, monkeypatch):
    """The sweep, to the last digit printed: one of roundoff may be rounded the other way."""
    monkeypatch.chdir(tmp_path)
    block, output = blocks(README)[0]
    first = block.partition("result =")[0]
    assert alike(output.partition("At 0.5 N")[0], printed(first, {}), 0.0)


def test_numbers_of_the_readme_are_kept_ones():
    """The headline is that of docs/hero.json, counts are those of their pages."""
    kept = json.loads((ROOT / "docs" / "hero.json").read_text(encoding="utf-8"))["numbers"]["default"]
    headline = kept["headline"]
    number = FINGER["mu_app"].shown(headline["value"], headline["error"])
    assert f"µ_app of the {headline['of']} = {number}, {headline['state']}." in README
    assert headline["sentence"] in README and f"from 0.25 to {headline['value']:.2f}" in README
    counts = re.search(
        r"^Of (\d+) findings that judge, .* hit (\d+), meet (\d+) in part and miss (\d+)",
        text("docs/measured.md"),
        re.M,
    )
    assert counts is not None
    words = "Of {} [measured findings](docs/measured.md) that judge, the fingers hit {}, meet {} in part and miss {}"
    assert words.format(*counts.groups()) in README
    verified = re.search(r"(\d+ of \d+) numbers", README)
    assert verified is not None and verified[1] in text("docs/verification.md")


def test_commands_are_known(capsys):
    """Each command's options are its own: with an option that no command has, only that one is refused."""
    for line in COMMANDS:
        assert cli.main([*shlex.split(line)[1:], "--no-such-option"]) == 2
        assert "--no-such-option is not an option" in capsys.readouterr().err, line


def test_every_page_is_in_the_index():
    index = (ROOT / "docs" / "README.md").read_text(encoding="utf-8")
    names = [Path(page).name for page in PAGES if page.startswith("docs/")]
    assert [name for name in names if f"({name})" not in index] == ["README.md"]


# -- sentences, links, places in the code -----------------------------------------------------------------
MEAN, LONGEST = 20, 40
PLACES = sorted({place for page in PAGES for place in re.findall(r"`([a-z_.]+):(\w+)`", text(page))})


def anchors(page: Path) -> set[str]:
    """Return the anchors of a page's headings, as code hosts and the site make them."""
    heads = re.findall(r"^#+ (.*)$", text(page), re.MULTILINE) if page.suffix == ".md" else []
    return {re.sub(r"[^\w\- ]", "", head.lower()).replace(" ", "-") for head in heads}


@pytest.mark.parametrize("page", PAGES)
def test_page(page):
    """Below 20 words on average, none above 40 (in a cell too); links lead to files and headings."""
    prose, cells = sentences(text(page))
    assert sum(map(words, prose)) / len(prose) < MEAN
    assert [sentence for sentence in [*prose, *cells] if words(sentence) > LONGEST] == []
    for link, anchor in re.findall(r"\]\((?!http)([^)#\s]*)#?([^)\s]*)\)", text(page)):
        target = (ROOT / page).parent / link if link else ROOT / page
        assert target.exists(), link
        assert not anchor or anchor in anchors(target), f"{link}#{anchor}"


def test_places_exist():
    """Of the code, as pages name them; files are read, not imported."""
    assert len(PLACES) > 25
    assert [place for place in PLACES if place[1] not in names(tree(place[0]).body)] == []


def names(body: list[ast.stmt]) -> set[str]:
    found = {node.name for node in body if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    targets = [t for node in body if isinstance(node, ast.Assign) for t in node.targets]
    targets += [node.target for node in body if isinstance(node, ast.AnnAssign)]
    return found | {target.id for target in targets if isinstance(target, ast.Name)}


def tree(module: str) -> ast.Module:
    return ast.parse((ROOT / f"{module.replace('.', '/')}.py").read_text(encoding="utf-8"))


def test_every_name_of_the_package_is_on_the_page_of_the_interface():
    """Under the module that defines it: the other pages of the reference leave it out."""
    found = re.findall(r"auto(?:class|exception|function):: ([\w.]+)", text("docs/site/api.md"))
    every = [getattr(fingerpad, name) for name in fingerpad.__all__]
    names = [each for each in every if not isinstance(each, ModuleType)]
    assert {f"{each.__module__}.{each.__name__}" for each in names} == set(found)


# -- the documentation site: built as by make docs, with its links followed ------------------------------------------
DOCS = ROOT / "environment" / "docs"
SITE = [path.relative_to(ROOT) for folder in ("docs", "docs/site", "demos") for path in (ROOT / folder).glob("*.md")]
OWN = r"(?:geometry|variational|fingerpad|benchmarks|tests|demos|environment|docs)"
LINK = re.compile(r'<a class="reference internal" href="site/[^"]+"[^>]*><code[^>]*>(?:<span[^>]*>)?([\w.:]+)')
FROM_ELSEWHERE = re.compile(r"(?:url\(|@import)\W*(?:https?:)?//")


class Page(HTMLParser):
    """Anchors, links and what is loaded of a page."""

    def __init__(self, text: str) -> None:
        super().__init__()
        self.anchors: set[str] = set()
        self.links: set[str] = set()
        self.loaded: set[str] = set()
        self.formulas = 0
        self.feed(text)

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        values = {name: value for name, value in attrs if value}
        self.anchors |= {values[name] for name in ("id", "name") if name in values}
        self.formulas += tag == "math"
        if tag == "a" and "href" in values:
            self.links.add(values["href"])
        elif tag != "a":
            self.loaded |= {values[name] for name in ("src", "href", "data") if name in values}


@pytest.fixture
def site(tmp_path) -> Path:
    """The folder of the site; a warning of Sphinx is an error."""
    place = subprocess.run([DOCS, "--place"], capture_output=True, text=True, check=True).stdout.strip()
    if not Path(place).is_dir():
        pytest.skip("Sphinx is not there; environment/docs --get")
    out = tmp_path / "html"
    done = subprocess.run([DOCS, out], env=os.environ, capture_output=True, text=True, check=False)
    assert done.returncode == 0, done.stdout + done.stderr
    return out


def within(path: Path, links: set[str]) -> Iterator[tuple[Path, str]]:
    """Return file and anchor of each link that leads to the site."""
    for link in links:
        parts = urlsplit(link)
        if not parts.scheme:
            yield (path.parent / unquote(parts.path)).resolve() if parts.path else path, unquote(parts.fragment)


@pytest.mark.long
def test_site(site):
    """Built whole and without a warning; links and anchors exist; nothing comes from a network. One build for all."""
    pages = {path: Page(path.read_text(encoding="utf-8")) for path in site.rglob("*.html")}
    expected = {site / page.with_suffix(".html") for page in SITE if page != Path("docs/site/contents.md")}
    expected |= {site / "demos" / f"{demo.stem}.html" for demo in (ROOT / "demos").glob("*.py")}
    assert expected - set(pages) == set()
    assert broken(site, pages) == set()
    loaded = {link for page in pages.values() for link in page.loaded}
    assert loaded and {link for link in loaded if urlsplit(link).scheme not in ("", "data")} == set()
    assert [path for path in site.rglob("*.css") if FROM_ELSEWHERE.search(path.read_text(encoding="utf-8"))] == []
    model = site / "docs" / "model.html"
    source = text("docs/model.md")
    assert pages[model].formulas == source.count("$$") // 2 > 5  # as MathML, without a script
    places = set(re.findall(r"`([a-z_.]+:\w+)`", source))
    linked = set(LINK.findall(model.read_text(encoding="utf-8")))
    assert len(places) > 25 and places - linked == set()  # to the reference, which leads to the source


def broken(site: Path, pages: dict[Path, Page]) -> set[str]:
    """Return the links to files or anchors that are not there."""
    return {
        f"{path.relative_to(site)}: {target}#{anchor}"
        for path, page in pages.items()
        for target, anchor in within(path, page.links | page.loaded)
        if not target.exists() or (anchor and target in pages and anchor not in pages[target].anchors)
    }


@pytest.mark.parametrize("page", SITE, ids=str)
def test_files_that_a_page_names_exist(page):
    named = re.findall(rf"`({OWN}/[\w./-]*)`", text(page))
    assert [name for name in named if not (ROOT / name).exists() and not name.startswith("demos/output")] == []
