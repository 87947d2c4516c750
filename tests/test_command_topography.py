"""Roughness from a measured height map, by the command and in a scene."""

import numpy as np
import pytest

from fingerpad.cli import main
from fingerpad.model.cautions import examine
from fingerpad.scene import from_data, load
from fingerpad.scene.messages import SceneError
from tests.commands import refused
from variational.roughness.spectrum import SelfAffine


def table_of(text: str) -> dict[str, float]:
    lines = text.partition("[roughness]\n")[2].splitlines()
    return {line.split(" = ")[0]: float(line.split(" = ")[1]) for line in lines if " = " in line}


@pytest.mark.parametrize(
    ("text", "options", "message"),
    [
        ("1 2 3 4\n" * 4, ["--size", "1 um", "1 um"], "holds numbers without a unit; give --unit"),
        ("1 2 3 4\n" * 4, ["--unit", "um"], "has no size; give --size or --pixel"),
    ],
)
def test_topography_refuses(text, options, message, tmp_path, capsys):
    (tmp_path / "map.txt").write_text(text)
    assert message in refused(capsys, "topography", str(tmp_path / "map.txt"), *options)


def test_unfilled_value_is_refused_by_command_and_scene(tmp_path, capsys):
    """Each names its own way to say that these pixels are missing."""
    h = SelfAffine().surface((64, 64), (400e-6, 400e-6), 3).heights * 1e6
    h[7, :40] = -9999
    file = tmp_path / "skin.csv"
    np.savetxt(file, h, delimiter=";")
    options = ("--unit", "um", "--size", "400 um", "400 um")
    text = refused(capsys, "topography", str(file), *options)
    assert "-9999 at 40 pixels" in text and 'give --missing="-9999", or --missing="nan" if it was measured' in text
    assert main(["topography", str(file), *options, "--missing=-9999"]) == 0
    table = {"file": str(file), "unit": "um", "size": ["400 um", "400 um"]}
    with pytest.raises(SceneError, match=r'topography: .* give roughness.topography.missing="-9999", or rough'):
        from_data({"roughness": {"topography": table}})
    assert from_data({"roughness": {"topography": table | {"missing": "-9999"}}}).roughness.h_rms < 10e-6


def test_scene_may_name_a_height_map(tmp_path, capsys):
    """Beside the scene file; h_rms and wavelength are those that the command prints, to its four digits."""
    h = SelfAffine().surface((64, 64), (400e-6, 400e-6), 3).heights
    np.savetxt(tmp_path / "skin.csv", h * 1e6, delimiter=";")
    (tmp_path / "scene.toml").write_text(
        '[roughness.topography]\nfile = "skin.csv"\nunit = "um"\nsize = ["0.4 mm", 4e-4]\n'
    )
    scene = load(tmp_path / "scene.toml")
    size = ("--size", "400 um", "400 um")
    assert main(["topography", str(tmp_path / "skin.csv"), "--unit", "um", *size]) == 0
    table = table_of(capsys.readouterr().out)
    assert (scene.roughness.h_rms, scene.roughness.wavelength) == pytest.approx(
        (table["h_rms"], table["wavelength"]), rel=1e-3
    )
    again = from_data(scene.parameters())
    assert again == scene and scene.replace(voltage=100.0).roughness == scene.roughness


# -- maps that do not show the roughness -------------------------------------------------------------------
def printed(tmp_path, capsys, heights, size) -> str:
    np.save(tmp_path / "map.npy", heights)
    argv = ["topography", str(tmp_path / "map.npy"), "--unit", "m", "--size", *map(str, size)]
    assert main(argv) == 0
    return capsys.readouterr().out


@pytest.mark.parametrize(("slope", "end"), [(3.4, 0.7), (1.5, None), (8.0, None)])
def test_hurst_exponent_at_an_end_of_its_search_is_not_found(tmp_path, capsys, slope, end):
    """Spectra that fall as q^-1.5, less steep than any self-affine one, and as q^-8; q^-3.4 is H = 0.7."""
    n = 64
    q = np.hypot(*np.meshgrid(np.fft.fftfreq(n), np.fft.fftfreq(n), indexing="ij"))
    q[0, 0] = 1.0
    white = np.random.default_rng(0).standard_normal((n, n))
    heights = np.fft.ifft2(np.fft.fft2(white) * q ** (-slope / 2)).real
    text = printed(tmp_path, capsys, 3e-6 * heights / heights.std(), (400e-6, 400e-6))
    line = next(line for line in text.splitlines() if "Hurst" in line)
    if end is None:
        assert line.startswith("# Hurst exponent not found within 0.01 to 2, fitted between")
    else:
        assert float(line.split()[3].rstrip(",")) == pytest.approx(end, abs=0.15)


@pytest.mark.parametrize(("width", "told"), [(0.5e-6, True), (10e-6, True), (100e-6, False)])
def test_map_smaller_than_the_longest_waves_is_told(tmp_path, capsys, width, told):
    """By the command, and by a scene that takes its roughness from the map."""
    heights = SelfAffine().surface((64, 64), (100e-6, 100e-6), 3).heights * width / 100e-6
    words = f"roughness ends at waves of {width:.3g} m, and skin has waves up to 0.0001 m"
    assert (words in printed(tmp_path, capsys, heights, (width, width))) == told
    topography = {"file": str(tmp_path / "map.npy"), "unit": "m", "size": [width, width]}
    scene = from_data({"roughness": {"topography": topography}})
    assert any("roughness ends at waves" in text for text in map(str, examine("scene", scene))) == told
