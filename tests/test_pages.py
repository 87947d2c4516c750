"""Pages are drawn from the numbers in git alone."""

from importlib import import_module

import pytest

from benchmarks.harness import DOCS
from benchmarks.pages import PAGES

NAMES = ("accuracy", "chart", "errors", "models", "sensitivity", "topography")


@pytest.mark.parametrize("name", NAMES)
def test_page_in_git_is_that_of_the_numbers_in_git(tmp_path, name):
    for file in DOCS.glob("*.json"):
        (tmp_path / file.name).write_bytes(file.read_bytes())
    path = import_module(PAGES[name]).draw(tmp_path)
    assert path.read_text(encoding="utf-8") == (DOCS / path.name).read_text(encoding="utf-8")
    pictures = [file.name for file in tmp_path.glob("*.png")]
    assert all((DOCS / picture).exists() for picture in pictures)
