"""Files that commands write: a user's own are not replaced, those of an earlier run of the command are."""

import os
from importlib.resources import files
from pathlib import Path

import pytest

from fingerpad.cli import main
from fingerpad.cli.arguments import PICTURE, Kind, Parser
from fingerpad.scene.messages import SceneError
from tests.commands import refused

OUTPUTS = (
    ("calculator", "--out", "a page; its name must end with .html"),
    ("mesh", "--out", "a mesh; its name must end with .msh"),
    ("mesh", "--plot", "a picture; its name must end with one of .png"),
    ("estimate", "--csv", "a table; its name must end with .csv"),
    ("estimate", "--plot", "a picture; its name must end with one of .png"),
    ("microscale", "--csv", "a table; its name must end with .csv"),
    ("compare-data", "--csv", "a table; its name must end with .csv"),
    ("compare-data", "--out", "a picture; its name must end with one of .png"),
    ("topography", "--plot", "a picture; its name must end with one of .png"),
)
GIVEN = {"compare-data": ["none.csv", "--run", "none"], "topography": ["none.csv"]}


@pytest.mark.parametrize(("command", "option", "words"), OUTPUTS)
def test_scene_is_not_replaced(capsys, write, command, option, words):
    """By no option that names a file to be written."""
    scene = write("voltage = 100")
    said = refused(capsys, command, *GIVEN.get(command, []), option, str(scene))
    assert f"scene.toml cannot be {words}" in said
    assert scene.read_text() == "voltage = 100"


@pytest.mark.parametrize(("command", "option"), [("calculator", "--out"), ("estimate", "--csv"), ("mesh", "--out")])
def test_file_of_the_same_kind_by_somebody_else_is_not_replaced(capsys, tmp_path, command, option):
    """A page, a table and a mesh of another program; gmsh writes format 4.1 by default."""
    mine = tmp_path / f"mine.{dict(calculator='html', estimate='csv', mesh='msh')[command]}"
    text = "$MeshFormat\n4.1 0 8\n" if command == "mesh" else "<!DOCTYPE html>\n<title>Mine</title>\n"
    mine.write_text(text)
    assert f"{mine.name} is there and is not a" in refused(capsys, command, option, str(mine))
    assert mine.read_text() == text


def test_own_file_is_replaced(capsys, tmp_path):
    """By another call of the command; an empty one, too."""
    table, page = tmp_path / "mu.csv", tmp_path / "page.html"
    table.touch()
    for voltage in ("100", "200"):
        assert main(["estimate", "--voltage", voltage, "--csv", str(table)]) == 0
        assert f"75.0,{voltage}.0," in table.read_text()
    page.write_text((files("fingerpad.calculator") / "page.html").read_text(encoding="utf-8").partition("{{")[0])
    assert main(["calculator", "--out", str(page)]) == 0 and "</html>" in page.read_text(encoding="utf-8")


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
