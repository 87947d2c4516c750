"""What pages show runs, with a small scene in the place of the reader's own: command lines, laws, the tutorial."""

import re
import shlex
import textwrap
import tomllib
from pathlib import Path

import numpy as np
import pytest

import fingerpad as fp
from fingerpad import cli
from fingerpad.runs.checkpoint import Checkpoint
from fingerpad.scene import from_data
from tests.pages import alike, blocks, printed
from tests.runs import no_pictures
from tests.small_finger import NINE
from variational.roughness.spectrum import SelfAffine

pytestmark = pytest.mark.slow
ROOT = Path(__file__).resolve().parents[1]
PAGES = [ROOT / "README.md", ROOT / "demos" / "README.md", *sorted((ROOT / "docs").glob("*.md"))]
SHOWN = sorted(
    {
        line.split("  #")[0].strip()
        for page in PAGES
        for line in re.findall(r"^    (fingerpad .*)$", page.read_text(encoding="utf-8"), re.MULTILINE)
    }
)
SMALL = """
f_ext = 1.0
voltage = 60.0
[geometry]
ridge_count = 9
[mesh]
contact = 40e-6
receptor = 100e-6
interface = 200e-6
growth = 1.0
touching_half_arc = 1.0e-3
[output]
receptors = false
errors = false
"""
SMALLER = {
    "50 N/m": "1 N/m",
    "voltage=0:200:5": "voltage=0:60:2",
    "voltage=0:200:21": "voltage=0:60:2",
    "0:200:41": "0:200:3",
}


@pytest.fixture
def folder(tmp_path, monkeypatch) -> Path:
    """A folder with the files that the lines name, as the current one."""
    (tmp_path / "scene.toml").write_text(SMALL, encoding="utf-8")
    heights = 1e6 * SelfAffine().surface((128, 128), (1e-3, 1e-3), seed=1).heights
    np.savetxt(tmp_path / "skin.csv", heights, delimiter=",")
    page = (ROOT / "docs" / "command.md").read_text(encoding="utf-8")
    shown = re.search(r"^    # source: .*?(?=\n\n)", page, re.MULTILINE | re.DOTALL)
    (tmp_path / "mine.csv").write_text(textwrap.dedent(shown[0]), encoding="utf-8")
    people = [f"{k},{f},{u},{mu * (f + 4e-6 * u**2 * f**0.7)}" for k, mu in enumerate((0.2, 0.3, 0.4, 0.25))
              for f in (0.2, 0.5) for u in (0, 100, 200)]  # fmt: skip
    head = "participant,force (N),voltage (V),friction force (N)"
    (tmp_path / "people.csv").write_text("\n".join([head, *people]) + "\n", encoding="utf-8")
    monkeypatch.chdir(tmp_path)
    return tmp_path


def small(line: str) -> list[str]:
    for shown, less in SMALLER.items():
        line = line.replace(shown, less)
    words = shlex.split(line)[1:]
    if words[0] == "run" and "--force" in words and "cylinders" not in words:  # which know the default finger alone
        words.insert(1, "scene.toml")
        words[words.index("--force") + 1] = "0.01 N"
    return words


def cases() -> list:
    """Return the lines; those that run several models or loads, which other tests do smaller, take long."""
    several = ("fingerpad sweep", "fingerpad run --force")
    return [pytest.param(line, marks=pytest.mark.long) if line.startswith(several) else line for line in SHOWN]


@pytest.mark.parametrize("line", cases())
def test_shown_command_runs(line, folder, capsys, monkeypatch):
    """It ends well, prints, and writes the file or folder that it names."""
    words = small(line)
    if words[0] == "uncertainty":
        pytest.importorskip("SALib", reason="pip install fingerpad[uncertainty]")
    if words[0] == "report" and len(words) == 2 and words[1] != "--calculator":
        fp.run(model="cylinders", out=words[1])
    if "--animate" in words:  # a full run, whose steps have moved
        with no_pictures():
            fp.run(fp.Scene.load("scene.toml"), out=words[1])
    if "--feel" in words:  # a run with a load over time
        loads = [{"name": "press", "f_ext": 1.0, "duration": 0.02}]
        fp.run(fp.Scene(**NINE, history=loads, output={"errors": False}), out=words[1])
    if words[0] == "sensitivities":
        with no_pictures():
            fp.run(fp.Scene.load("scene.toml").replace(output={"sensitivities": True}), out=words[1])
    if words[0] == "compare":
        fp.sweep(fp.Scene(), "results/sweep", model="cylinders", voltage=[0, 200], f_ext=[25, 75])
    if "--resume" in words:  # a run that was killed when its checkpoint was whole
        with monkeypatch.context() as kept, no_pictures():
            kept.setattr(Checkpoint, "delete", lambda self: None)
            fp.run(fp.Scene.load("scene.toml"), out=words[-1])
    with no_pictures():
        assert cli.main(words) == 0, capsys.readouterr().err
    assert capsys.readouterr().out
    written = [words[k + 1] for k, word in enumerate(words) if word in ("--out", "--plot")]
    assert [name for name in written if not (folder / name).exists()] == []


# -- Python ------------------------------------------------------------------------------------------------
def test_own_laws_run_as_written(monkeypatch):
    """With another scene; each law acts: the gap is constant, and friction is its limit summed over the skin.

    A ridge's contact is of several facets: on one alone the skin that bears friction is half as long again as L_R.
    """
    small = from_data(tomllib.loads(SMALL)).replace(mesh={"contact": 10e-6})
    laws = (ROOT / "docs" / "laws.md").read_text(encoding="utf-8")
    monkeypatch.setattr(fp, "Scene", small.replace, raising=False)
    names: dict = {}
    printed(blocks(laws)[0][0], names)
    slip, p = names["result"].full_slip, names["p"]
    touching = slip.ridges.length > 0
    np.testing.assert_allclose(slip.d_eq[touching], 2e-6, rtol=1e-12)
    shear = slip.skin.t_t
    assert p.shape == shear.shape
    used = names["result"].to_dict()["laws"]
    assert (used["friction"].partition("(")[0], used["dermis"].partition("(")[0]) == ("Adhesive", "Soft")
    assert "ConstantGap" in used["closure"]
    # Between the Coulomb part alone and the whole of tau_0 on the current area in contact.
    low, high = 0.3 * slip.f_contact, 0.3 * slip.f_contact + 5e3 * 1.5 * slip.contact_length
    assert low < abs(slip.f_t) < high
    printed(blocks(laws)[1][0], names)
    assert small.replace(friction=names["Bounded"](0.4)).friction.tau == 20e3
    with pytest.raises(fp.SceneError, match="friction.mu_f is 3; it must be from 0.01 to 2"):
        small.replace(friction=names["Bounded"](3.0))
    printed(blocks(laws)[2][0], names)
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
