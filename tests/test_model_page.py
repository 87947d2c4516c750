"""Every place in the code that docs/model.md names exists; the files are read, not imported."""

import ast
import re
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[1]
PAGE = (ROOT / "docs" / "model.md").read_text(encoding="utf-8")
PLACES = sorted(set(re.findall(r"`([a-z_.]+):(\w+)`", PAGE)))
METHODS = re.findall(r"\| `(\w+)` \|$", PAGE, re.MULTILINE)


def names(body: list[ast.stmt]) -> set[str]:
    found = {node.name for node in body if isinstance(node, ast.FunctionDef | ast.ClassDef)}
    targets = [t for node in body if isinstance(node, ast.Assign) for t in node.targets]
    targets += [node.target for node in body if isinstance(node, ast.AnnAssign)]
    return found | {target.id for target in targets if isinstance(target, ast.Name)}


def tree(module: str) -> ast.Module:
    return ast.parse((ROOT / f"{module.replace('.', '/')}.py").read_text(encoding="utf-8"))


@pytest.mark.parametrize(("module", "name"), PLACES, ids=lambda part: part)
def test_place_exists(module, name):
    assert name in names(tree(module).body)


def test_every_equation_has_a_place():
    """In the paragraph before or after it; those of the table of section 5 are in its last column."""
    paragraphs = re.split(r"\n\s*\n", PAGE)
    equations = [k for k, paragraph in enumerate(paragraphs) if paragraph.startswith("$$")]
    assert len(equations) >= 6
    lone = [k for k in equations if not any(re.search(r"`[a-z_.]+:\w+`", paragraphs[i]) for i in (k - 1, k + 1))]
    assert [paragraphs[k] for k in lone] == []


def test_methods_of_the_bearing_area_model_exist():
    (model,) = (n for n in tree("variational.roughness.bam").body if getattr(n, "name", "") == "BearingArea")
    assert isinstance(model, ast.ClassDef) and len(METHODS) >= 5 and set(METHODS) <= names(model.body)


def test_every_equation_of_the_paper_has_a_place():
    """Numbers 1 to 15 are on the page, alone or in a range; Eq. 8 is the roughness's spectrum."""
    assert len(PLACES) > 25
    ranges = re.findall(r"(?:Eqs?\. |^\| )(\d+)(?:(?: and |, )(\d+))?", PAGE, re.MULTILINE)
    assert {int(number) for pair in ranges for number in pair if number} >= set(range(1, 16))
