"""Fingers by name: what they give, what wins over them, and how a scene changes from one to another."""

import json

import pytest

import fingerpad as fp
from fingerpad.cli import main
from fingerpad.reduced.press import known
from fingerpad.scene import load
from fingerpad.scene.fingers import AIR_GAP, FINGERS
from fingerpad.scene.presets import named, value_at

NAMES = [name for name in FINGERS if name != "paper"]


def value(scene, key):
    for part in key.split("."):
        scene = getattr(scene, part)
    return scene


@pytest.mark.parametrize("name", NAMES)
def test_name_gives_its_keys(name):
    """In scenes from Python, files and the command line, and no others."""
    scene, default = fp.Scene(finger=name), fp.Scene()
    assert named(scene.parameters()) == {key: value_at(scene.parameters(), key) for key in FINGERS[name].values}
    back = {"finger": "paper"} | {key: value(default, key) for key in FINGERS[name].values}
    assert load(None, {"finger": name} | back) == default
    assert load(None, {"finger": name}) == scene and scene.finger == name


def test_paper_is_the_default_finger():
    """Its scene is the default one, and its record is that of before there were names."""
    assert fp.Scene(finger="paper") == fp.Scene()
    assert "finger" not in fp.Scene(finger="paper").parameters()


def test_given_keys_win(tmp_path):
    """Key by key, whatever the unit; a law of another kind takes the parameters that it has."""
    scene = fp.Scene(finger="child", friction=0.4, geometry={"width": "18 mm"})
    assert (scene.friction, scene.geometry.width, scene.geometry.height) == (0.4, 0.018, 0.0123)
    file = tmp_path / "scene.toml"
    file.write_text('finger = "moist"\n[roughness]\nlaw = "Persson"\nhurst = 0.8\n')
    moist = fp.Scene.load(file)
    assert (moist.roughness.young, moist.roughness.hurst, moist.friction.tau_0) == (0.32e6, 0.8, 14e3)
    with_law = fp.Scene(finger="moist", friction=fp.Coulomb(0.5), roughness={"young": "2 MPa"})
    assert (with_law.friction, with_law.roughness.young) == (0.5, 2e6)
    assert fp.Scene(finger="old", materials={"dermis": fp.NeoHooke(1e3)}).materials.dermis.shear_modulus == 1e3
    neo_hooke = fp.Scene(finger="old", materials={"dermis": {"law": "NeoHooke"}})
    assert neo_hooke.materials.dermis == fp.NeoHooke(8510.0)
    assert fp.Scene(finger="old", materials={"dermis": {"alpha": 5.0}}).materials.dermis.shear_modulus == 8510.0


def test_keys_of_a_name_give_way_to_what_contradicts_them():
    """A table of heights has no radius and no length, of the name or of the scene that is changed; both given do not
    go together, and the record has the table alone.
    """
    table = {"z": [-0.01, 0.0, 0.01], "height": [2e-3, 0.0, 2e-3]}
    for scene in (
        fp.Scene(finger="child", slices=table),
        fp.Scene(finger="child").replace(slices=table),
        fp.Scene(slices=table).replace(finger="child"),
        fp.Scene(**fp.Scene(finger="child").parameters()).replace(slices=table),
    ):
        assert scene.slices.height == (2e-3, 0.0, 2e-3)
        assert scene.geometry.width == FINGERS["child"].values["geometry.width"]
        assert fp.Scene(**scene.parameters()).slices == scene.slices
    with pytest.raises(fp.SceneError, match="^slices.radius is 0.02 and slices.height is given too"):
        fp.Scene(finger="child", slices=table | {"radius": 0.02})


def test_another_name_keeps_what_was_given():
    """By replace, as sweeps do, through several names and back."""
    scene = fp.Scene(finger="child", friction=0.4, roughness={"gamma": 0.4}, geometry={"width": 0.018})
    moist = scene.replace(finger="moist")
    assert (moist.friction, moist.roughness.young, moist.roughness.gamma) == (0.4, 0.32e6, 0.4)
    assert (moist.geometry.width, moist.geometry.height) == (0.018, 0.014)
    back = moist.replace(finger="old").replace(finger="paper")
    assert back == fp.Scene(friction=0.4, roughness={"gamma": 0.4}, geometry={"width": 0.018})
    assert fp.Scene(friction=0.25).replace(finger="dry").friction == 0.25
    assert fp.Scene(finger="dry").replace(friction=0.3).replace(finger="moist").friction == 0.3


@pytest.mark.parametrize("name", FINGERS)
def test_record_of_a_run_changes_its_name(name, tmp_path):
    """It gives every key; those that are of its finger are not held for given ones."""
    record = fp.Scene(finger=name, f_ext=50.0).parameters()
    read = fp.Scene(**record)
    assert read == fp.Scene(finger=name, f_ext=50.0)
    assert read.replace(finger="old") == fp.Scene(finger="old", f_ext=50.0)
    file = tmp_path / "scene.json"
    file.write_text(json.dumps(record))
    assert load(file, {"finger": "child"}) == fp.Scene(finger="child", f_ext=50.0)


@pytest.mark.parametrize("bad", ["children", "Child", "", 3, None, ["dry"], {"dry": 1}, True])
def test_other_names_are_refused(bad):
    with pytest.raises(fp.SceneError, match="^finger is .*; it must be 'paper', 'fitted', .* 'callused' or 'dry'$"):
        fp.Scene(finger=bad)
    with pytest.raises(fp.SceneError, match="^finger is "):
        fp.Scene().replace(finger=bad)


@pytest.mark.parametrize("name", FINGERS)
def test_headline_and_check_say_that_a_finger_was_not_measured(name, tmp_path, capsys):
    """Of every name but the default finger's; where a name changes moisture, that it contradicts a measurement."""
    remark = FINGERS[name].remark
    scene = fp.Scene(finger=name)
    assert bool(remark) == (name != "paper")
    assert ("arXiv 2409.16936" in remark) == (FINGERS[name].values.get("roughness.young", 1e6) != 1e6)
    if known(scene) is not None:
        headline = fp.run(scene, model="cylinders").headline
        assert headline.remark == remark and (not remark or f"\n  {remark}" in str(headline))
    main(["check", "--set", f"finger={name}", "--set", "mesh.contact=40e-6", "--out", str(tmp_path)])
    assert not remark or remark in capsys.readouterr().out


@pytest.mark.parametrize("law", AIR_GAP)
def test_fitted_finger_has_one_air_gap_by_each_closure(law):
    """2 µm where a ridge bears 18 kPa, within 1 %: the rms heights have three digits."""
    name, _, outside = law.partition(",")
    more = {"field_in_contact": False} if outside else {}
    scene = fp.Scene(finger="fitted", roughness={"law": name, **more})
    assert scene.roughness.h_rms == AIR_GAP[law]
    assert float(scene.closure()(18e3).d_eq) == pytest.approx(2e-6, rel=0.01)


@pytest.mark.parametrize("keys", [{"force": 0.5}, {}])
def test_dataset_has_both_the_name_and_the_whole_finger(keys):
    result = fp.run(fp.Scene(finger="fitted", **keys), model="cylinders")
    data = result.to_xarray()
    again = fp.Result.from_xarray(data)
    assert data.attrs["finger"] == again.scene.finger == "fitted"
    assert (again.finger is None) == (result.finger is None)
    if result.finger:
        assert again.finger.full_slip.f_t == pytest.approx(result.finger.full_slip.f_t, rel=1e-12)
