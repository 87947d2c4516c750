"""The command fingerpad: options win over the file, PETSc's options go through, bad input ends in one sentence."""

import argparse
import json
import re
import sys
from pathlib import Path

import numpy as np
import pytest

import fingerpad as fp
from fingerpad.cli import COMMANDS, main, ranges
from fingerpad.cli import run as run_command
from fingerpad.cli.arguments import Parser, scene_of
from fingerpad.scene import Scene, SceneError
from tests.commands import ROOT, python, refused
from variational.roughness.spectrum import SelfAffine

SCENES = ROOT / "demos/scenes"


def run_line(*argv: str) -> tuple[Scene, argparse.Namespace, list[str]]:
    parser = Parser("run", "fingerpad run")
    parser.add_scene()
    parser.add_out("results", "folder")
    args = parser.read(argv, petsc=True)
    return scene_of(args), args, args.petsc


# -- options -----------------------------------------------------------------------------------------------
def test_options():
    words = "--set f_ext=30 --set voltage=1e2 -fingerpad_snes_monitor --set mesh.contact=1e-5 --set friction=0.3"
    words += " -fingerpad_snes_rtol -1 --out there"
    scene, args, petsc = run_line(*words.split())
    assert (scene.f_ext, scene.voltage, scene.mesh.contact, scene.friction) == (30.0, 100.0, 1e-5, 0.3)
    assert args.out == Path("there")
    assert petsc == ["-fingerpad_snes_monitor", "-fingerpad_snes_rtol", "-1"]


@pytest.mark.parametrize(
    ("argv", "message"),
    [
        (["--set", "voltage=high"], "voltage is 'high'; it must be a number"),
        (["--set", "f_ext=0.5 N"], "f_ext is '0.5 N'; it must be in N/m; a force on the whole finger is the key force"),
        (["--set", "voltage=50", "--set", " voltage = 100"], "--set voltage is given twice; give one value"),
        (["--out", f"{__file__}/below"], f"--out {__file__}/below cannot be a folder, since {__file__} is a file;"),
        (["none.toml"], "scene file none.toml cannot be read:"),
        ([str(SCENES / "voltage_while_sliding.toml"), "--set", "f_ext=50"], "f_ext is 50 and history is given"),
        (["--voltage", "3"], "--voltage is not an option; did you mean --set voltage=...?"),
        (["one.toml", "two.toml"], "two.toml is a word too many; options are --help,"),
        (["-snes_monitor"], "-snes_monitor is not an option; did you mean -fingerpad_snes_monitor?"),
        (["--set"], "command line: argument --set: expected one argument"),
        (["--out", __file__], f"--out {__file__} cannot be a folder, since it is a file;"),
    ],
)
def test_bad_command_line(argv, message, capsys):
    assert refused(capsys, "run", *argv).startswith(message)


def test_folder_that_is_read_only(tmp_path, monkeypatch, capsys):
    """Root may write anywhere but on a file system that is read-only; the system says so."""
    monkeypatch.setattr("os.access", lambda path, mode: Path(path) != tmp_path)
    assert "cannot be written to: " in refused(capsys, "run", "--out", str(tmp_path / "new" / "results"))


def test_quiet_ranks(monkeypatch, capsys):
    """Under a launcher rank 0 alone prints, refusals and help too."""
    monkeypatch.setenv("OMPI_COMM_WORLD_RANK", "1")
    for argv in (["run", "--set", "voltage=high"], ["run", "--set"], ["swep"]):
        assert main(argv) == 2
    for argv in (["--help"], ["run", "--help"], ["--version"], ["params"]):
        assert main(argv) == 0
    assert capsys.readouterr() == ("", "")


# -- commands ----------------------------------------------------------------------------------------------
def test_help_lists_every_command(capsys):
    """And each command has help of its own, with examples."""
    assert main(["--help"]) == 0
    text = capsys.readouterr().out
    for name in COMMANDS:
        assert f"\n  {name} " in text
        assert main([name, "--help"]) == 0
        assert f"examples:\n  fingerpad {name}" in capsys.readouterr().out.replace("mpirun -n 2 ", "")


# -- without finite elements -------------------------------------------------------------------------------
PLAIN = {
    "estimate": ["estimate", "--voltage", "0,200"],
    "microscale": ["microscale", "--plot", "a.png"],
    "params": ["params", "roughness"],
    "check": ["check", "--out", "checked"],
    "topography": ["topography", "map.txt", "--unit", "um", "--size", "1e-4", "1e-4"],
    "run": ["run", "--model", "cylinders", "--set", 'f_ext="50 N/m"', "--out", "out"],
    "again": ["run", "out/scene.json", "--out", "again"],
    "full": ["run"],
    "mesh": ["check", "--mesh", "finger.msh"],
}
CODE = """
import contextlib, io, json, sys
sys.modules.update(dict.fromkeys(("dolfinx", "ufl", "basix", "ffcx", "petsc4py", "mpi4py", "gmsh")))
from fingerpad.cli import main
found = {}
for name, argv in json.loads(sys.argv[1]).items():
    with contextlib.redirect_stdout(io.StringIO()) as out, contextlib.redirect_stderr(io.StringIO()) as err:
        code = main(argv)
    found[name] = code, out.getvalue(), err.getvalue()
print(json.dumps(found))
"""


@pytest.fixture(scope="module")
def plain(tmp_path_factory) -> tuple[Path, dict[str, list]]:
    """Run commands in a process where finite elements, MPI and gmsh cannot be imported: exit code and what they print.

    A matplotlibrc of its folder may be anybody's.
    """
    folder = tmp_path_factory.mktemp("plain")
    np.savetxt(folder / "map.txt", SelfAffine().surface((32, 32), (100e-6, 100e-6), 1).heights * 1e6)
    (folder / "matplotlibrc").write_text("figure.dpi : nonsense\n")
    done = python("-P", "-c", CODE, json.dumps(PLAIN), cwd=folder)
    assert (done.returncode, done.stderr) == (0, "")
    return folder, json.loads(done.stdout)


@pytest.mark.parametrize("name", [name for name in PLAIN if name not in ("full", "mesh")])
def test_commands_without_finite_elements(plain, name):
    """They end well, warn of nothing, and read no configuration of the folder."""
    code, out, err = plain[1][name]
    assert (code, err) == (0, "") and len(out.splitlines()) > 5


def test_files_of_commands_without_finite_elements(plain):
    """A picture, no mesh, and the closed form as a run, which leaves a summary and is run again from its folder."""
    folder, found = plain
    assert (folder / "a.png").stat().st_size > 10_000
    assert (
        "The mesh is not drawn, since gmsh is not installed." in found["check"][1] and not (folder / "checked").exists()
    )
    said = found["run"][1]
    assert said.startswith("At 0.32 N, 200 V raise the friction force from ")
    whole, section = "\nWhole finger, as a sum of slices\n", "\nMiddle section of the finger (model 'cylinders')\n"
    assert 0 < said.find(whole) < said.find(section)
    assert found["again"][1].replace("again", "out") == found["run"][1], "the scene of a folder, by its model"
    assert json.loads((folder / "out" / "summary.json").read_text(encoding="utf-8"))["f_ext"] == 50.0


@pytest.mark.parametrize(("name", "needed"), [("full", "run needs mpi4py"), ("mesh", "check needs gmsh")])
def test_commands_with_finite_elements_name_what_is_missing(plain, name, needed):
    code, _, err = plain[1][name]
    assert code == 2 and err.startswith(f"fingerpad: {needed}, which is not installed;") and err.count("\n") == 1


# -- values of a quantity ----------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("text", "values"),
    [
        ("75", [75.0]),
        ("0:200:5", [0.0, 50.0, 100.0, 150.0, 200.0]),
        ("1e3:1e6:4:log", [1e3, 1e4, 1e5, 1e6]),
        ("0:0.2:3 kV", ["0.0 kV", "0.1 kV", "0.2 kV"]),
    ],
)
def test_ranges(text, values):
    """Ends are exact and inner values rounded to 12 digits, so that 0.3 is 0.3."""
    assert ranges.read("x", text) == values


@pytest.mark.parametrize("words", [["params"], ["--help"]])
def test_full_disk_under_the_output_is_told(words, monkeypatch, capsys):
    """Also where the output is so small that it waits until the program's end, at which nothing more is written."""
    with open("/dev/full", "w") as full:
        monkeypatch.setattr(sys, "stdout", full)
        assert main(words) == 2
    assert capsys.readouterr().err == "fingerpad: the output cannot be written: No space left on device\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("", "x is empty; write one value"),
        ("0:1:0", "x is 0:1:0, of 0 values; it must be of 1 to 10000"),
        ("0:1:3:log", "x is 0:1:3:log; both ends must be greater than 0"),
    ],
)
def test_bad_ranges(text, message):
    with pytest.raises(SceneError) as refusal:
        ranges.read("x", text)
    assert str(refusal.value).startswith(message)


def test_negative_voltages(capsys):
    """A range of them after an equals sign, and a number also without."""
    for words in (["--voltage=-200:200:3"], ["--voltage", "-200"]):
        assert main(["estimate", *words]) == 0
        assert re.search(r"^ *-200 +0.5377 +0.594", capsys.readouterr().out, re.MULTILINE)


def test_refused_options_of_a_run_that_goes_on(tmp_path):
    with pytest.raises(SceneError, match="only a full run in a folder can go on"):
        fp.run(resume=True)
    with pytest.raises(SceneError, match="only a full run in a folder can go on"):
        fp.run(out=tmp_path, model="cylinders", resume=True)
    for words in (["scene.toml"], ["--set", "voltage=1"], ["--model", "cylinders"], ["--out", "x"], ["--force", "1 N"]):
        with pytest.raises(SceneError, match="and --resume are given"):
            run_command.main([*words, "--resume", str(tmp_path)])
    with pytest.raises(SceneError, match=r"has no scene.json of a run, and so no run to go on with"):
        run_command.main(["--resume", str(tmp_path)])
    for kept, match in (
        ('{"model": "cylinders"}', "only a full one can go on"),
        ('{"friction": {"law": "__main__:Mine"}}', "known to the program that made it alone; put it into a module"),
        ('{"mesh": ' * 100_000 + "0" + "}" * 100_000, "has no scene.json of a run"),
    ):
        (tmp_path / "scene.json").write_text(kept, encoding="utf-8")
        with pytest.raises(SceneError, match=match):
            run_command.main(["--resume", str(tmp_path)])
