"""Closures of rough contact in scenes, height maps, the command microscale and sweeps."""

import numpy as np
import pytest

import fingerpad as fp
from fingerpad.cli import main
from fingerpad.scene import with_values
from variational.roughness.spectrum import SelfAffine


@pytest.mark.parametrize("law", ["BoundaryElements", "Persson"])
def test_scene_and_back(law):
    scene = fp.Scene(roughness={"law": law, "h_rms": "2 um", "field_in_contact": False})
    assert isinstance(scene.roughness, getattr(fp, law)) and scene.roughness.h_rms == 2e-6
    assert scene.roughness.h_0 == scene.h_0
    assert fp.Scene(**scene.parameters()).roughness == scene.roughness


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"shortest_wave": 1e-6}, "roughness.shortest_wave is 1e-06 m; .* so take 1.563e-06 to 1.25e-05 m"),
        ({"hurst": 0.5}, "roughness.hurst is 0.5; tables of the package are for 0.6 to 0.9, and Persson has no such"),
        ({"p_floor": 1e6}, "roughness.p_floor is 1000000; it must be below the end of the table of gaps"),
    ],
)
def test_refused_in_a_scene(table, words, tmp_path, monkeypatch):
    monkeypatch.setenv("FINGERPAD_CACHE", str(tmp_path))
    with pytest.raises(fp.SceneError, match=words):
        fp.Scene(roughness={"law": "BoundaryElements"} | table)


def test_height_map_of_a_scene(tmp_path, monkeypatch):
    """The table of a map is that of the map as boundary elements have it; a map with non-square pixels is refused."""
    monkeypatch.setenv("FINGERPAD_CACHE", str(tmp_path))
    file = tmp_path / "skin.npy"
    np.save(file, SelfAffine(2.0, 0.8, 40.0, shortest=12.0).surface((48, 48), (100.0, 100.0), 1).heights)
    given = {"file": str(file), "unit": "um", "size": ["100 um", "100 um"]}
    scene = fp.Scene(roughness={"law": "BoundaryElements", "topography": given})
    law = scene.roughness
    assert law.surface and law.wavelength == pytest.approx(100e-6)
    assert fp.Scene(roughness={"law": "BearingArea", "topography": given}).roughness.h_rms == pytest.approx(law.h_rms)
    assert 0 < law(2e4).d_eq < law(5e3).d_eq
    with pytest.raises(fp.SceneError, match="roughness.topography: pixels of the map are .* needs square ones"):
        fp.Scene(roughness={"law": "BoundaryElements", "topography": given | {"size": ["100 um", "90 um"]}})


def test_result_is_read_where_the_table_is_not(tmp_path, monkeypatch):
    """A folder on another computer: numbers, band and report are in it; another run needs the map."""
    monkeypatch.setenv("FINGERPAD_CACHE", str(tmp_path / "here"))
    np.save(tmp_path / "skin.npy", np.outer(np.cos(np.arange(24)), np.cos(np.arange(24) / 2)))
    given = {"file": str(tmp_path / "skin.npy"), "unit": "um", "size": ["100 um", "100 um"]}
    scene = fp.Scene(voltage=50.0, roughness={"law": "BoundaryElements", "topography": given})
    made = fp.run(scene, model="cylinders", out=tmp_path / "run")
    monkeypatch.setenv("FINGERPAD_CACHE", str(tmp_path / "there"))
    found = fp.Result.load(tmp_path / "run")
    assert found.full_slip.mu_app == made.full_slip.mu_app and main(["report", str(tmp_path / "run")]) == 0
    with pytest.raises(fp.SceneError, match="roughness.surface is .* has no table of that name"):
        fp.run(found.scene.replace(voltage=60.0), model="cylinders")


def test_sweep_over_closures_is_of_one_surface():
    """Roughness that the scene gives stays, as when a run is given both; keys of another law alone go."""
    scene = fp.Scene(roughness={"h_rms": 1e-6, "gamma": 0.45}, voltage=50.0)
    laws = ["BoundaryElements", "Persson"]
    curve = fp.sweep(scene, model="cylinders", **{"roughness.law": laws})
    for law, found in zip(laws, curve, strict=True):
        alone = fp.run(scene.replace(roughness={"law": law, "h_rms": 1e-6}), model="cylinders")
        assert found.full_slip.mu_app == pytest.approx(alone.full_slip.mu_app, rel=1e-12)


def test_sweep_over_laws_of_friction_keeps_a_coefficient_that_is_a_number():
    """It stands for Coulomb's mu_f, which Derjaguin's law has too."""
    scene = fp.Scene(friction=0.3)
    assert with_values(scene, {"friction.law": "Coulomb"}).friction == 0.3
    assert with_values(scene, {"friction.law": "Derjaguin", "friction.tau_0": 5e3}).friction.mu_f == 0.3


@pytest.mark.parametrize(("voltage", "told"), [(200, True), (80, False)])
def test_check_tells_that_ridges_adhere(capsys, tmp_path, voltage, told):
    """Before a run that follows jumps for a long time."""
    given = "roughness.law=BoundaryElements", f"voltage={voltage}"
    assert main(["check", "--out", str(tmp_path), *(word for each in given for word in ("--set", each))]) == 0
    words = f"not reach full slip: by the closed form ridges adhere at {voltage} V; take a smaller voltage"
    assert (words in capsys.readouterr().out) == told
