"""The lines of the README and of the pages about laws and commands run as they are written."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest

import fingerpad as fp
from fingerpad import cli
from fingerpad.scene import from_data
from tests.pages import alike, blocks, printed

ROOT = Path(__file__).parents[1]
PAGES = [Path("README.md"), Path("CONTRIBUTING.md"), Path("demos/README.md")]
PAGES += [Path("docs", page.name) for page in sorted((ROOT / "docs").glob("*.md"))]
README, LAWS, COMMAND = (
    (ROOT / name).read_text(encoding="utf-8") for name in ("README.md", "docs/laws.md", "docs/command.md")
)
COMMANDS = [line.split("#")[0] for line in re.findall(r"^    (?:mpirun .*)?(fingerpad .*)$", COMMAND, re.MULTILINE)]
SMALL = {
    "f_ext": 1.0,
    "voltage": 60.0,
    "geometry": {"ridge_count": 9},
    "mesh": {"contact": 40e-6, "receptor": 100e-6, "interface": 200e-6, "growth": 1.0, "touching_half_arc": 1.0e-3},
    "output": {"receptors": False, "errors": False},
}


def code(block: str) -> list[str]:
    return [line for line in (line.split("  #")[0].strip() for line in block.splitlines()) if line]


def test_readme_fits_a_screen():
    assert len(README.splitlines()) <= 65


def test_door_is_the_demo():
    """Every line of Python of the README is one of the first demo, which runs them; so is the body of docs/laws.md."""
    demo = code((ROOT / "demos" / "first_run.py").read_text(encoding="utf-8"))
    lines = [line for block, _ in [*blocks(README), blocks(LAWS)[-1]] for line in code(block)]
    assert len(lines) > 10 and [line for line in lines if line not in demo] == []


def test_closed_form_prints_the_readme(tmp_path, monkeypatch):
    """To the last digit printed: one of roundoff may be rounded the other way."""
    monkeypatch.chdir(tmp_path)
    block, output = blocks(README)[0]
    first = block.partition("result =")[0]
    assert alike(output.partition("section at the centre")[0], printed(first, {}), 0.0)


def test_full_run_of_the_readme_is_the_kept_one():
    """The default scene's friction is that of docs/errors.md, whose runs take minutes, to the digits printed there."""
    page = (ROOT / "docs" / "errors.md").read_text(encoding="utf-8")
    kept = re.search(r"^\| µ_app, full slip \| ([0-9.]+) \|", page, re.MULTILINE)
    found = re.search(r"µ_app = ([0-9.]+) ± ", README)
    assert kept is not None and found is not None
    assert float(found[1]) == pytest.approx(float(kept[1]), abs=6e-5)


def test_claims_of_the_readme_are_those_of_its_pages():
    """The effect is that of the output below it; the count of verified numbers is that of docs/verification.md."""
    found = re.search(r"µ_app = ([0-9.]+) ± ", README)
    count = re.search(r"(\d+ of \d+) numbers", README)
    assert found is not None and f"from 0.25 to {float(found[1]):.2f}" in README
    assert count is not None and count[1] in (ROOT / "docs" / "verification.md").read_text(encoding="utf-8")


def test_own_laws_run_as_written(monkeypatch):
    """With another scene; each law acts: the gap is constant, and friction is its limit summed over the skin."""
    small = from_data(SMALL)
    monkeypatch.setattr(fp, "Scene", small.replace, raising=False)
    names: dict = {}
    printed(blocks(LAWS)[0][0], names)
    slip, p = names["result"].full_slip, names["p"]
    touching = slip.ridges.length > 0
    np.testing.assert_allclose(slip.d_eq[touching], 2e-6, rtol=1e-12)
    shear = slip.skin.t_t
    assert p.shape == shear.shape
    laws = names["result"].to_dict()["laws"]
    assert (laws["friction"].partition("(")[0], laws["dermis"].partition("(")[0]) == ("Adhesive", "Soft")
    assert "ConstantGap" in laws["closure"]
    # Between the Coulomb part alone and the whole of tau_0 on the current area in contact.
    low, high = 0.3 * slip.f_contact, 0.3 * slip.f_contact + 5e3 * 1.5 * slip.contact_length
    assert low < abs(slip.f_t) < high
    printed(blocks(LAWS)[1][0], names)
    assert small.replace(friction=names["Bounded"](0.4)).friction.tau == 20e3
    with pytest.raises(fp.SceneError, match="friction.mu_f is 3; it must be from 0.01 to 2"):
        small.replace(friction=names["Bounded"](3.0))
    printed(blocks(LAWS)[2][0], names)
    cap = names["Cap"]()
    cap.check()
    assert cap.limit(1e5) == cap.tau and cap.limit(1e4) == 5e3


def test_tutorial_prints_what_it_shows(tmp_path, monkeypatch):
    """One block after the other; numbers within 2 %, since the mesh may differ from one version of gmsh to the next."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "demos").symlink_to(ROOT / "demos")
    names: dict = {}
    for block, output in blocks((ROOT / "docs" / "tutorial.md").read_text(encoding="utf-8")):
        found = printed(block, names)
        assert not output or alike(output, found, 0.02), found
    assert {file.name for file in tmp_path.glob("*.png")} == {"surface.png", "history.png", "friction.png"}


@pytest.mark.parametrize("line", COMMANDS)
def test_commands_are_known(line, capsys):
    """Each command's options are its own: with an option that no command has, only that one is refused."""
    words = shlex.split(line)[1:]
    assert cli.main([*words, "--no-such-option"]) == 2
    assert "--no-such-option is not an option" in capsys.readouterr().err


def test_make_targets_exist():
    makefile = (ROOT / "Makefile").read_text(encoding="utf-8")
    named = re.findall(r"^    make ([a-z-]+)", README, re.MULTILINE)
    assert len(named) == 2 and all(f"\n{name}:\n" in makefile for name in named)


@pytest.mark.parametrize("page", PAGES, ids=str)
def test_links_lead_somewhere(page):
    text = (ROOT / page).read_text(encoding="utf-8")
    links = re.findall(r"\]\((?!http)([^)#\s]+)\)", text)
    assert [link for link in links if not (ROOT / page).parent.joinpath(link).exists()] == []


def test_every_page_is_in_the_index():
    index = (ROOT / "docs" / "README.md").read_text(encoding="utf-8")
    assert [page.name for page in (ROOT / "docs").glob("*.md") if f"({page.name})" not in index] == ["README.md"]
