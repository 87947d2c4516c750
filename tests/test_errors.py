"""The error study of the default scene, on runs that are made up so that their limits are known."""

import pytest

from benchmarks import errors, limits
from benchmarks.errors import QUANTITIES


def exact(mesh):
    """A quantity whose errors are 1 % times the sizes over their defaults, of second order."""
    sizes = mesh.contact / 5e-6, mesh.growth / 0.25, mesh.receptor / 5e-6
    return dict.fromkeys(QUANTITIES, 2 + 0.02 * sum(size**2 for size in sizes))


def told(mesh, off=0.0):
    values = {name: value + off for name, value in exact(mesh).items()}
    return {"mesh": mesh.model_dump(), "unknowns": 10, "factorisations": 3, "values": values}


@pytest.fixture
def runs(monkeypatch):
    """Let every scene have been run, but those that a test adds to the list, and the states solved again."""
    missing = []

    def values(scene, out):
        return None if scene in missing else exact(scene.mesh) | {"unknowns": 9.0, "factorisations": 30.0}

    meshes = limits.meshes(errors.DEFAULT.mesh, errors.LEVELS)
    again = {
        "path": told(errors.DEFAULT.mesh),
        "own": told(errors.DEFAULT.mesh),
        "levels": [told(mesh) for mesh in meshes],
    }
    monkeypatch.setattr(errors, "values", values)
    monkeypatch.setattr(limits, "kept", lambda scene, levels, folder: None if "again" in missing else again)
    return missing, again


def test_meshes_are_halved_in_everything():
    first, second, third = limits.meshes(errors.DEFAULT.mesh, 3)
    for name in ("contact", "growth", "receptor", "interface", "coarsest"):
        sizes = [getattr(mesh, name) for mesh in (first, second, third)]
        assert sizes == [sizes[0], sizes[0] / 2, sizes[0] / 4]
    assert first.touching_half_arc == third.touching_half_arc == errors.DEFAULT.mesh.touching_half_arc


def test_reference_is_the_limit(runs, tmp_path):
    """Errors of second order are taken away exactly, the bar is Roache's for the finest mesh. Tolerance: roundoff."""
    found = errors.reference(tmp_path)
    finest = limits.meshes(errors.DEFAULT.mesh, errors.LEVELS)[-1]
    assert set(found) == set(QUANTITIES)
    for name, each in found.items():
        assert each.value == pytest.approx(2, rel=1e-12, abs=0)
        assert each.order == pytest.approx(2, rel=1e-9)
        assert each.bar == pytest.approx(1.25 * (exact(finest)[name] - 2), rel=1e-9, abs=0)


def test_what_the_path_changes_is_in_the_bar(runs, tmp_path):
    """The default mesh solved again is 0.1 off the whole run there."""
    _, again = runs
    plain = errors.reference(tmp_path)
    again["own"] = told(errors.DEFAULT.mesh, off=-0.1)
    for name, each in errors.reference(tmp_path).items():
        assert each.value == plain[name].value
        assert each.bar == pytest.approx(plain[name].bar + 0.1, rel=1e-12)


def test_page_of_all_runs(runs, tmp_path):
    """The default's error against the limit: 0.02 (1 + 1 + 1) over 2, and a bar of 1.25 times 0.02 3 / 16."""
    errors.write(tmp_path, tmp_path)
    text = (tmp_path / "errors.md").read_text(encoding="utf-8")
    row = next(line for line in text.splitlines() if line.startswith("| SED at ridge 0, full slip"))
    assert row.split("|")[2:4] == [" 2.06 ", " 2.06 "]
    assert row.split("|")[-4:] == [" 2.0000 ± 0.0047 ", " 2.0 ", " 3 % ", ""]
    assert (tmp_path / "errors.png").exists()


@pytest.mark.parametrize("lost", [errors.DEFAULT, "again"])
def test_no_reference_before_all_was_run(runs, tmp_path, lost):
    runs[0].append(lost)
    assert errors.reference(tmp_path) == {}
    errors.write(tmp_path, tmp_path)
    assert "What the results tend to" not in (tmp_path / "errors.md").read_text(encoding="utf-8")
