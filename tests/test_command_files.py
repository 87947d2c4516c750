"""Files that commands write: a user's own are not replaced, those of an earlier run of the command are."""

import os
import re
from importlib.resources import files
from pathlib import Path

import pytest

from fingerpad.cli import main
from fingerpad.cli.arguments import PICTURE, Kind, Parser
from fingerpad.scene import Scene
from fingerpad.scene.messages import SceneError
from tests.commands import COARSE, refused

OUTPUTS = (
    ("report", "--out", "a page; its name must end with .html"),
    ("check", "--mesh", "a mesh; its name must end with .msh"),
    ("estimate", "--csv", "a table; its name must end with .csv"),
    ("estimate", "--plot", "a picture; its name must end with one of .png"),
    ("compare", "--csv", "a table; its name must end with .csv"),
)
GIVEN = {"report": ["--calculator"], "compare": ["none.csv", "--run", "none"], "topography": ["none.csv"]}


@pytest.mark.parametrize(("command", "option", "words"), OUTPUTS)
def test_scene_is_not_replaced(capsys, write, command, option, words):
    """By no option that names a file to be written."""
    scene = write("voltage = 100")
    said = refused(capsys, command, *GIVEN.get(command, []), option, str(scene))
    assert f"scene.toml cannot be {words}" in said
    assert scene.read_text() == "voltage = 100"


@pytest.mark.parametrize(("command", "option"), [("report", "--out"), ("estimate", "--csv"), ("check", "--mesh")])
def test_file_of_the_same_kind_by_somebody_else_is_not_replaced(capsys, tmp_path, command, option):
    """A page, a table and a mesh of another program; gmsh writes format 4.1 by default."""
    mine = tmp_path / f"mine.{dict(report='html', estimate='csv', check='msh')[command]}"
    text = "$MeshFormat\n4.1 0 8\n" if command == "check" else "<!DOCTYPE html>\n<title>Mine</title>\n"
    mine.write_text(text)
    assert f"{mine.name} is there and is not a" in refused(capsys, command, *GIVEN.get(command, []), option, str(mine))
    assert mine.read_text() == text


def test_own_file_is_replaced(capsys, tmp_path):
    """By another call of the command; an empty one, too."""
    table, page = tmp_path / "mu.csv", tmp_path / "page.html"
    table.touch()
    for voltage in ("100", "200"):
        assert main(["estimate", "--voltage", voltage, "--csv", str(table)]) == 0
        assert re.search(rf"^{voltage}(\.0)?,", table.read_text(), re.MULTILINE)
    page.write_text((files("fingerpad.calculator") / "page.html").read_text(encoding="utf-8").partition("{{")[0])
    assert main(["report", "--calculator", "--out", str(page)]) == 0 and "</html>" in page.read_text(encoding="utf-8")


def read(*argv: str) -> None:
    parser = Parser("any", "fingerpad any")
    parser.add_argument("maps", nargs="*", type=Path)
    parser.add_file("--plot", PICTURE, "picture")
    parser.add_file("--csv", Kind("a table", (".csv",)), "table")
    parser.read(argv)


def test_file_that_is_read_is_not_written(tmp_path, monkeypatch):
    """Under one name or another, alone or in a list."""
    monkeypatch.chdir(tmp_path)
    (tmp_path / "map.tif").write_bytes(b"heights")
    for given in ("map.tif", "./map.tif", str(tmp_path / "map.tif")):
        with pytest.raises(SceneError, match="is given twice, once to be written; give it another name"):
            read("other.tif", given, "--plot", "map.tif")
    read("map.tif", "--plot", "picture.tif")


def test_no_link_and_no_device_is_written(tmp_path):
    (tmp_path / "victim").write_text("mine")
    (tmp_path / "link.csv").symlink_to(tmp_path / "victim")
    (tmp_path / "gone.csv").symlink_to(tmp_path / "nothing")
    os.mkfifo(tmp_path / "pipe.csv")
    for name in ("link.csv", "gone.csv", "pipe.csv"):
        with pytest.raises(SceneError, match=f"{name} cannot be written, since it is no ordinary file"):
            read("--csv", str(tmp_path / name))


# -- check and mesh --------------------------------------------------------------------------------------------------
@pytest.mark.slow
def test_check(tmp_path, capsys):
    """Loads in order, what is left out with its reason, and a picture."""
    argv = ["check", "--set", "voltage=0", "--out", str(tmp_path)]
    assert main([*argv, *(word for text in COARSE for word in ("--set", text))]) == 0
    text = capsys.readouterr().out
    assert text.index("1. press: force to 75 N/m") < text.index("3. slide: bone sideways to 5 mm, or until full slip")
    assert "attraction and the air gaps of the ridges: no load has a voltage" in text
    assert "friction: Coulomb(mu_f=0.25)" in text and "closure: none" in text
    assert (tmp_path / "mesh.png").stat().st_size > 10_000


def test_mesh_beyond_the_memory_is_refused(capsys):
    """It is meshed, and passes the bound; the refusal has the number of its unknowns."""
    words = [word for text in (*COARSE, "numerics.memory=0.35e9") for word in ("--set", text)]
    assert "the mesh has " in refused(capsys, "check", *words)


def test_mesh_is_read_again_with_its_names(tmp_path, capsys):
    """Lengths in m, groups by name; a facet of 30 um takes 1 um off the tip of a ridge, of a radius of 0.12 mm."""
    import gmsh

    file = tmp_path / "finger.msh"
    assert (
        main(
            [
                "check",
                "--mesh",
                str(file),
                "--out",
                str(tmp_path),
                *(word for text in COARSE for word in ("--set", text)),
            ]
        )
        == 0
    )
    assert "Mesh written: " in capsys.readouterr().out
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(file))
        groups = {gmsh.model.getPhysicalName(*group) for group in gmsh.model.getPhysicalGroups()}
        y = gmsh.model.mesh.getNodes()[1].reshape(-1, 3)[:, 1]
    finally:
        gmsh.finalize()
    assert {"stratum corneum", "dermis", "bone rim", "outer skin", "ridge 0", "ridge -1"} <= groups
    assert y.min() == pytest.approx(0, abs=2e-6)
    assert y.max() == pytest.approx(Scene().geometry.height, rel=1e-3)  # chords of an ellipse
