"""The README's lines run as they are written: the laws of one's own, on a small finger, and the commands."""

import re
import shlex
from pathlib import Path

import numpy as np
import pytest

import fingerpad as fp
from fingerpad import cli
from fingerpad.scene import from_data

ROOT = Path(__file__).parents[1]
README = (ROOT / "README.md").read_text(encoding="utf-8")
PYTHON = re.findall(r"```python\n(.*?)```", README, re.DOTALL)
COMMANDS = [line.split("#")[0] for line in re.findall(r"^    (?:mpirun .*)?(fingerpad .*)$", README, re.MULTILINE)]
SMALL = {
    "f_ext": 1.0,
    "voltage": 60.0,
    "geometry": {"ridge_count": 9},
    "mesh": {"contact": 40e-6, "receptor": 100e-6, "interface": 200e-6, "growth": 1.0, "touching_half_arc": 1.0e-3},
    "output": {"receptors": False, "errors": False},
}


@pytest.mark.slow
def test_own_laws_run_as_written(monkeypatch):
    """With another scene; each law acts: the gap is constant, and friction is its limit summed over the skin."""
    small = from_data(SMALL)
    monkeypatch.setattr(fp, "Scene", lambda: small, raising=False)
    names: dict = {}
    exec(compile(PYTHON[1], "README.md", "exec"), names)
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


def test_door_is_the_demo():
    """The first lines of the README are those of the first demo, which runs them."""
    demo = (ROOT / "demos" / "first_run.py").read_text(encoding="utf-8")
    lines = [line.split("#")[0].strip() for line in PYTHON[0].splitlines()]
    missing = [line for line in lines if line and line not in re.sub(r"[ ]*#.*", "", demo)]
    assert missing == []


@pytest.mark.parametrize("line", COMMANDS)
def test_commands_are_known(line, capsys):
    """Each command's options are its own: with an option that no command has, only that one is refused."""
    words = shlex.split(line)[1:]
    assert cli.main([*words, "--no-such-option"]) == 2
    assert "--no-such-option is not an option" in capsys.readouterr().err


def test_links_lead_somewhere():
    links = re.findall(r"\]\((?!http)([^)#]+)\)", README)
    assert len(links) > 20 and [link for link in links if not (ROOT / link).exists()] == []
