"""The error study of the default scene, on runs that are made up so that their limits are known."""

import pytest

from benchmarks import errors
from benchmarks.errors import QUANTITIES


def exact(scene):
    """A quantity whose errors are 1 % times the sizes over their defaults, squared for the size at the sites."""
    mesh = scene.mesh
    sizes = mesh.contact / 5e-6, mesh.growth / 0.25, (mesh.receptor / 20e-6) ** 2
    return {name: 2 + 0.02 * sum(sizes) for name in [*QUANTITIES, "unknowns", "factorisations"]}


@pytest.fixture
def runs(monkeypatch):
    """Let every scene have been run but those that a test adds to the list."""
    missing = []
    monkeypatch.setattr(errors, "values", lambda scene, out: None if scene in missing else exact(scene))
    return missing


def test_reference_adds_up(runs, tmp_path):
    """Errors that add up are taken away exactly; and so do the bars. Tolerance: roundoff."""
    found = errors.reference(tmp_path)
    assert set(found) == set(QUANTITIES)
    for each in found.values():
        assert each.value == pytest.approx(2, rel=1e-12, abs=0)
        assert each.bar == pytest.approx(1.25 * 0.02 * (2.5 / 5 + 0.125 / 0.25 + (2.5 / 20) ** 2), rel=1e-9, abs=0)


def test_page_of_all_runs(runs, tmp_path):
    """The sum of the studies is what the run with all of them finds."""
    errors.write(tmp_path, tmp_path)
    text = (tmp_path / "errors.md").read_text(encoding="utf-8")
    row = next(line for line in text.splitlines() if line.startswith("| SED at ridge 0, full slip"))
    assert row.split("|")[2:] == [" 2.06 ", " 2.000 ± 0.025 ", " 3 % ", " 2.035 ", " 2.035 ", ""]
    assert (tmp_path / "errors.png").exists()


def test_what_does_not_add_up_is_in_the_bar(runs, monkeypatch, tmp_path):
    """The fine mesh is 0.1 off the sum of the studies."""
    plain, fine = errors.reference(tmp_path), next(iter(errors.study("check").values()))
    found = errors.values
    monkeypatch.setattr(
        errors, "values", lambda scene, out: {k: v + 0.1 * (scene == fine) for k, v in found(scene, out).items()}
    )
    for name, each in errors.reference(tmp_path).items():
        assert each.value == plain[name].value
        assert each.bar == pytest.approx(plain[name].bar + 0.1, rel=1e-12)


@pytest.mark.parametrize("study", ["growth", "check"])
def test_no_reference_before_all_was_run(runs, tmp_path, study):
    runs.append(next(iter(errors.study(study).values())))
    assert errors.reference(tmp_path) == {}
    errors.write(tmp_path, tmp_path)
    assert "What the results tend to" not in (tmp_path / "errors.md").read_text(encoding="utf-8")
