"""What the spread of friction comes from: Sobol's indices of functions with known ones, and of the default finger."""

import csv
import math
import sys
from dataclasses import replace

import numpy as np
import pytest

import fingerpad as fp
from fingerpad import cli
from fingerpad.cli import uncertainty
from fingerpad.cli.uncertainty import Study, indices
from tests.runs import no_pictures
from tests.small_finger import NINE

GROUPS = ("one", "two", "three")


@pytest.fixture
def salib():
    return pytest.importorskip("SALib", reason="pip install fingerpad[uncertainty]")


@pytest.fixture(scope="module")
def study():
    return Study(fp.run(fp.Scene(voltage=100.0), model="cylinders"))


def by_name(rows, key):
    return {row["factor"]: row[key] for row in rows}


def test_ishigami(salib):
    """Ishigami and Homma 1990, with a = 7 and b = 0.1; to the errors that are given, and those are small."""

    def model(points):
        x, y, z = (2 * np.pi * points - np.pi).T
        return np.sin(x) + 7 * np.sin(y) ** 2 + 0.1 * z**4 * np.sin(x)

    one, two, both = (1 + 0.1 * np.pi**4 / 5) ** 2 / 2, 49 / 8, 0.01 * np.pi**8 * (1 / 18 - 1 / 50)
    variance, rows = one + two + both, indices(model, GROUPS, 1024)
    first = {"one": one / variance, "two": two / variance, "three": 0.0}
    total = {"one": (one + both) / variance, "two": two / variance, "three": both / variance}
    for key, exact in (("first", first), ("total", total)):
        errors = by_name(rows, f"{key}_error")
        for name, value in by_name(rows, key).items():
            assert abs(value - exact[name]) <= 1.5 * errors[name] < 0.15


def test_groups_and_steps_of_a_linear_model(salib):
    """Two factors of a group, and one of three equally likely steps, whose variance is two thirds; to 0.02."""

    def model(points):
        return points[:, 0] + 2 * points[:, 1] + np.minimum(3 * points[:, 2], 2).astype(int)

    found = indices(model, ("line", "line", "steps"), 1024)
    line, steps = 5 / 12, 2 / 3
    for key in ("first", "total"):
        expected = {"line": line / (line + steps), "steps": steps / (line + steps)}
        assert by_name(found, key) == pytest.approx(expected, abs=0.02)
    assert by_name(found, "uncertainty") == pytest.approx({"line": line**0.5, "steps": steps**0.5}, abs=0.02)
    with pytest.raises(fp.SceneError, match="the same for all fingers"):
        indices(lambda points: 0 * points[:, 0], GROUPS, 8)


def test_middle_and_changes_are_the_closed_form_s(study):
    """A finger with all factors in the middle is the scene's; of another law or closure it is that one's run."""
    middle, result = np.full(len(study.names), 0.5), study.result
    middle[[study.names.index("rough contact"), study.names.index("friction law")]] = 0.0
    changed = np.tile(middle, (3, 1))
    changed[1, study.names.index("rough contact")] = 0.99
    changed[2, study.names.index("friction law")] = 0.99
    models, laws = [*study.closures.values()], study.laws
    scenes = (result.scene.replace(**keys) for keys in ({}, {"roughness": models[-1]}, {"friction": laws[-1]}))
    expected = [fp.run(each, model="cylinders").full_slip.mu_app for each in scenes]
    assert np.exp(study(changed)) == pytest.approx(expected, rel=1e-9)
    assert len(models) == 5 and len(laws) == 2


def test_closures_without_a_number_are_left_out():
    study = Study(fp.run(fp.Scene(voltage=200.0), model="cylinders"))
    assert study.missing == {name: "ridges adhere at 200 V" for name in ("boundary elements", "Persson's theory")}
    assert not set(study.missing) & set(study.closures) and any("Left out" in words for words in study.words())


@pytest.mark.slow
def test_command(salib, tmp_path, capsys, monkeypatch):
    """People are first, and among them friction, as 50 % is to 20 %; the files have the table."""
    monkeypatch.setattr(indices, "__defaults__", (32,))
    words = ["uncertainty", "--set", "voltage=100", "--csv", f"{tmp_path}/a.csv", "--plot", f"{tmp_path}/a.png"]
    shown = list[float]()
    monkeypatch.setattr(uncertainty.Console, "phase", lambda _, text, part: shown.append(part))
    assert cli.main(words) == 0
    assert shown[0] == 0 and shown == sorted(shown) and len(set(shown)) > 10
    rows = list(csv.DictReader((tmp_path / "a.csv").read_text().splitlines()))
    assert [row["factor"] for row in rows[:2]] == ["people", "people: friction"]
    assert {row["factor"] for row in rows} > {"rough contact", "friction law", "coating", "closed form"}
    assert float(rows[0]["total"]) > 0.5 and (tmp_path / "a.png").stat().st_size > 1000
    assert "Friction law: Coulomb, Derjaguin." in capsys.readouterr().out


@pytest.mark.slow
def test_budget_of_a_run_adds_up(salib, tmp_path, monkeypatch):
    """Numerical parts are its ± and the tolerance; people are their traits by squares; the total is all."""
    monkeypatch.setattr(indices, "__defaults__", (8,))
    scene, folder = fp.Scene(**NINE, f_ext=1.0, voltage=60.0, output={"receptors": False}), f"{tmp_path}/run"
    with no_pictures():
        result = fp.run(scene, out=folder)
    assert cli.main(["uncertainty", folder, "--csv", f"{tmp_path}/a.csv"]) == 0
    rows = list(csv.DictReader((tmp_path / "a.csv").read_text().splitlines()))
    size, bounds = (
        {row["factor"]: float(row["uncertainty"]) for row in rows},
        [row["factor"] for row in rows if not row["total"]],
    )
    tolerance, numerical = size["tolerance of the solver"], sum(size[name] for name in bounds[:-1])
    assert numerical - tolerance == pytest.approx(result.headline.error) and 0 < tolerance < 1e-4 * numerical
    spreads = [size[name] for name in ("people", "friction law", "rough contact", "coating")]
    assert size["total"] == pytest.approx(numerical + math.hypot(*spreads))
    assert size["people"] == pytest.approx(math.hypot(*(size[name] for name in size if name.startswith("people: "))))
    section = uncertainty._bounds(replace(result, finger=None))
    assert section["mesh"] + section["penalty"] == pytest.approx(result.full_slip.error.mu_app)


def test_refusals(monkeypatch, capsys):
    """Without friction nothing spreads; a missing SALib is a sentence with the way to get it."""
    with pytest.raises(fp.SceneError, match="no friction at full slip"):
        Study(fp.run(fp.Scene(friction=0.0), model="cylinders"))
    assert cli.main(["uncertainty", "tests", "--set", "voltage=3"]) == 2
    assert "with the folder of a run" in capsys.readouterr().err
    monkeypatch.setitem(sys.modules, "SALib.analyze.sobol", None)
    assert cli.main(["uncertainty"]) == 2
    assert "needs SALib" in capsys.readouterr().err and uncertainty.POINTS == 256
