"""Pages are in short sentences and in words that a stranger knows: README, CONTRIBUTING and the pages in docs/."""

import re

import pytest

from tests.pages import ROOT, sentences, words

PAGES = ["README.md", "CONTRIBUTING.md", "demos/README.md"]
PAGES += [f"docs/{page.name}" for page in sorted((ROOT / "docs").glob("*.md"))]
MEAN, LONGEST = 20, 40
PRIVATE = [
    r"rungs?", r"knobs?", r"woken", r"(?<!contact )zones?", r"knows?", r"says nothing", r"leapt", r"creeps?",
    r"hopeless", r"fits and starts", r"taken up again", r"sees", r"asks", r"feels nothing", r"gets? there",
    r"one's own", r"as good as none", r"swallows?", r"tells?", r"what it owes",
]  # fmt: skip


def text(page: str) -> str:
    return (ROOT / page).read_text(encoding="utf-8")


@pytest.mark.parametrize("page", PAGES)
def test_sentences_are_short(page):
    """Below 20 words on average, none above 40; a cell of a table counts for the longest alone."""
    prose, cells = sentences(text(page))
    mean = sum(map(words, prose)) / len(prose)
    assert mean < MEAN
    assert [sentence for sentence in [*prose, *cells] if words(sentence) > LONGEST] == []


@pytest.mark.parametrize("page", PAGES)
def test_words_are_common(page):
    """Words of the code's own dialect; quotations of code and of outputs count too."""
    assert re.findall(rf"\b(?:{'|'.join(PRIVATE)})\b", text(page), re.IGNORECASE) == []


@pytest.mark.parametrize("page", PAGES)
def test_normal_contact_is_the_charged_one(page):
    """Where a page means the state without voltage, it says so: uncharged normal contact."""
    assert re.findall(r"normal contact (?:without|at 0 V|before the voltage)", text(page)) == []
