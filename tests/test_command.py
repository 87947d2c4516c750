"""The command line: what is given wins over the file, PETSc's options go through, bad input ends in one sentence."""

import argparse
from pathlib import Path

import pytest

from fingerpad import command
from fingerpad.command import positive

SCENES = Path(__file__).parent.parent / "demos/scenes"


def command_line(*argv: str, quiet: bool = False):
    parser = argparse.ArgumentParser()
    command.add_arguments(parser)
    return command.command_line(parser, argv, quiet)


def test_options():
    words = "--f-ext 30 --voltage 1e2 -fingerpad_snes_monitor --contact-size 1e-5 --friction 0.3"
    words += " -fingerpad_snes_rtol -1 --out there"
    scene, args, petsc = command_line(*words.split())
    assert (scene.f_ext, scene.voltage, scene.mesh.contact, scene.friction) == (30.0, 100.0, 1e-5, 0.3)
    assert args.out == Path("there")
    assert petsc == ["-fingerpad_snes_monitor", "-fingerpad_snes_rtol", "-1"]


def test_options_win_over_the_file():
    scene, _, _ = command_line("--scene", str(SCENES / "coarse.toml"), "--voltage", "0")
    assert (scene.f_ext, scene.voltage, scene.mesh.interface) == (10.0, 0.0, 120e-6)


@pytest.mark.parametrize(
    ("argv", "message"),
    [
        (["--voltage", "high"], "voltage is 'high'; it must be a number"),
        (["--f-ext", "nan"], "f_ext is nan; it must be a finite number"),
        (["--f-ext", "-3"], "f_ext is -3 N/m; it must be from 0.001 to 5000 N/m"),
        (["--contact-size", "2e-4"], "mesh.contact is 0.0002 m, too large for a ridge of 0.000483 m"),
        (["--volts", "3"], "--volts is not an option; did you mean --voltage?"),
        (["-voltage", "300"], "-voltage is not an option; did you mean --voltage?"),
        (["-f_ext=3"], "-f_ext=3 is not an option; did you mean --f-ext?"),
        (["-snes_monitor"], "-snes_monitor is not an option; did you mean -fingerpad_snes_monitor?"),
        (["-h_rms", "2e-6"], "-h_rms is not an option; did you mean -fingerpad_h_rms?"),
        (["results"], "results is not an option; options are --help, --scene, --f-ext,"),
        (["--f-ext"], "command line: argument --f-ext: expected one argument"),
        (["--out", ""], "command line: argument --out: it is empty; it must be a path"),
        (["--out", "results\udcff"], "--out results\\udcff is not UTF-8;"),
        (["--out", "a" * 300], f"--out {'a' * 77}... is too long; a name can have 255 bytes"),
        (["--out", "a/" * 2000], f"--out {'a/' * 38}a... is too long; a path can have 4096 bytes"),
        (["--out", __file__], f"--out {__file__} cannot be a folder, since it is a file;"),
        (["--out", f"{__file__}/below"], f"--out {__file__}/below cannot be a folder, since {__file__} is a file;"),
        (["-fingerpad_snes_rtol", "1e-6", "1e-7"], "1e-7 is not an option;"),
        (["--scene", str(SCENES / "voltage_while_sliding.toml"), "--f-ext", "50"], "f_ext is 50 and history is given"),
        (["--scene", "none.toml"], "scene file none.toml cannot be read:"),
    ],
)
def test_bad_command_line(argv, message, capsys):
    with pytest.raises(SystemExit) as stop:
        command_line(*argv)
    assert stop.value.code == 2
    printed = capsys.readouterr().err
    assert printed.startswith(f"fingerpad: {message}")
    assert printed.count("\n") == 1


def test_folder_that_is_read_only(tmp_path, monkeypatch, capsys):
    """Root may write anywhere but on a file system that is read-only; the system says so."""
    monkeypatch.setattr("os.access", lambda path, mode: Path(path) != tmp_path)
    with pytest.raises(SystemExit):
        command_line("--out", str(tmp_path / "new" / "results"))
    assert "cannot be written to: " in capsys.readouterr().err
    command_line("--out", str(tmp_path.parent / "results"))


def test_folder_is_not_made(tmp_path):
    """To look at it leaves no trace."""
    command_line("--out", str(tmp_path / "new" / "results"))
    assert not list(tmp_path.iterdir())


def test_quiet_ranks(capsys):
    for argv in (["--voltage", "high"], ["--f-ext"]):
        with pytest.raises(SystemExit) as stop:
            command_line(*argv, quiet=True)
        assert stop.value.code == 2
    assert capsys.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("kind", "text", "words"),
    [
        (int, "0", "0 is not allowed; it must be a whole number greater than 0"),
        (int, "two", "two is not allowed; it must be a whole number greater than 0"),
        (float, "-1", "-1 is not allowed; it must be a number greater than 0"),
        (float, "nan", "nan is not allowed; it must be a number greater than 0"),
        (float, "inf", "inf is not allowed; it must be a number greater than 0"),
    ],
)
def test_positive_arguments(kind, text, words):
    with pytest.raises(argparse.ArgumentTypeError) as refused:
        positive(kind)(text)
    assert str(refused.value) == words
    assert positive(kind)("3") == 3
