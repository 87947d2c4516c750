"""The documentation site: built as it is by make docs, with its links followed and nothing loaded from elsewhere."""

import os
import re
import subprocess
from collections.abc import Iterator
from functools import cache
from html.parser import HTMLParser
from pathlib import Path
from urllib.parse import unquote, urlsplit

import pytest

ROOT = Path(__file__).resolve().parents[1]
DOCS = ROOT / "environment" / "docs"
PAGES = [path.relative_to(ROOT) for folder in ("docs", "docs/site", "demos") for path in (ROOT / folder).glob("*.md")]
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
    expected = {site / page.with_suffix(".html") for page in PAGES if page != Path("docs/README.md")}
    expected |= {site / "demos" / f"{demo.stem}.html" for demo in (ROOT / "demos").glob("*.py")}
    assert expected - set(pages) == set()
    assert broken(site, pages) == set()
    loaded = {link for page in pages.values() for link in page.loaded}
    assert loaded and {link for link in loaded if urlsplit(link).scheme not in ("", "data")} == set()
    assert [path for path in site.rglob("*.css") if FROM_ELSEWHERE.search(path.read_text(encoding="utf-8"))] == []
    model = site / "docs" / "model.html"
    source = text(Path("docs/model.md"))
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


# -- the pages themselves ----------------------------------------------------------------------------------
@cache
def text(page: Path) -> str:
    return (ROOT / page).read_text(encoding="utf-8")


@pytest.mark.parametrize("page", PAGES, ids=str)
def test_files_that_a_page_names_exist(page):
    named = re.findall(rf"`({OWN}/[\w./-]*)`", text(page))
    assert [name for name in named if not (ROOT / name).exists() and not name.startswith("demos/output")] == []
