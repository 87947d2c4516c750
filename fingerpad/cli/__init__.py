"""The command ``fingerpad``: a module a subcommand, imported when it is called.

Each module has a function ``main(argv) -> int``; a second command in it has a function of its name. They return the
exit code: 0, 1 for a run that failed, 2 for a refusal, 128 and the number of the signal for a run that was stopped.
"""

import errno
import importlib
import io
import os
import sys
from collections.abc import Sequence
from difflib import get_close_matches

from fingerpad import launcher
from fingerpad.launcher import OPTIONAL, needed_by, version

COMMANDS = {
    "estimate": "friction over force and voltage by a closed form, in seconds, without finite elements",
    "run": "contact and friction of a finger that is pressed, charged and slid: tables, pictures, fields",
    "sweep": "a scene over values of its keys: a table; a stopped sweep continues, and no run is repeated",
    "report": "a run or a sweep as one HTML file; a run's animation or spikes; the closed form as a page with sliders",
    "compare": "tables of measurements beside a run or a sweep: misfit as a ratio, picture",
    "uncertainty": "budget of friction: people, rough contact, friction law, coating, and numerical errors of a run",
    "sensitivities": "what moves a run's friction, contact length or pressure: slopes by its numbers; ranked",
    "calibrate": "values of keys of a scene by a table of measurements on fingers: regions, evidence for laws, report",
    "check": "what a run contains, omits and costs, with a picture of its mesh, or the mesh for gmsh; solves nothing",
    "solve": "the voltage, coating or other key at which friction has a given value, by the closed form, at once",
    "drive": "friction over the period of an alternating voltage, its spectrum, and whether it is felt, in a second",
    "microscale": "air gap, attraction and real area of contact of a ridge over its pressure",
    "topography": "roughness of a scene from a measured height map",
    "params": "every key of a scene: unit, default, range and meaning",
}
_BESIDE = {"solve": "estimate", "microscale": "roughness", "topography": "roughness"}
"""Modules of the commands that have none of their own name."""
_COLLECTIVE = ("run",)  # use all ranks; the others are answered by rank 0


def main(argv: Sequence[str] | None = None) -> int:
    """Run a subcommand; return the exit code.

    Args:
        argv: words after ``fingerpad``; those of the process if None.
    """
    words = sys.argv[1:] if argv is None else list(argv)
    for stream in (sys.stdout, sys.stderr):  # of terminals without µ and ²
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")
    try:
        with needed_by(words[0] if words else "help"):
            code = _call(words)
        sys.stdout.flush()
        return code
    except ImportError as error:
        if error.name not in OPTIONAL:
            raise
        return refuse(str(error))
    except KeyboardInterrupt:
        return 130
    except BrokenPipeError:  # of `fingerpad params | head`
        _drop_output()
        return 1
    except OSError as error:  # as of a disk that is full, or was taken out
        if error.filename is None and error.errno in (errno.ENOSPC, errno.EDQUOT):  # of `fingerpad params > file`
            _drop_output()
            return refuse(f"the output cannot be written: {error.strerror}")
        if error.filename is None:
            raise
        from fingerpad.scene.messages import clip

        return refuse(f"{clip(str(error.filename), 80)} cannot be used: {error.strerror}")


def _drop_output() -> None:
    """Write no more to the standard output, which Python would try at its end, too."""
    os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())


def refuse(message: str) -> int:
    """Print a message on rank 0; return the exit code of a refusal."""
    if launcher.rank() == 0:
        print(f"fingerpad: {message}", file=sys.stderr)
    return 2


def _call(words: list[str]) -> int:
    if not words or words[0] in ("-h", "--help"):
        if launcher.rank() == 0:
            print(_help())
        return 0 if words else 2
    if words[0] == "--version":
        if launcher.rank() == 0:
            print(f"fingerpad {version()}")
        return 0
    from fingerpad.scene.messages import SceneError  # with all keys of a scene, which the help does not need

    try:
        return _command(words)
    except SceneError as error:
        return refuse(str(error))


def _command(words: list[str]) -> int:
    name = words[0]
    if name not in COMMANDS:
        from fingerpad.scene.messages import SceneError, clip

        near = get_close_matches(name[:60], COMMANDS, n=1)
        instead = f"did you mean {near[0]}?" if near else f"commands are {', '.join(COMMANDS)}"
        raise SceneError(f"{clip(name) or 'an empty text'} is not a command; {instead}")
    if launcher.rank() and name not in _COLLECTIVE:
        return 0
    own = importlib.import_module(f"fingerpad.cli.{_BESIDE.get(name, name)}")
    try:
        return int(getattr(own, name if name in _BESIDE else "main")(words[1:]))
    except SystemExit as stop:  # of --help
        return int(stop.code or 0)


def _help() -> str:
    commands = "\n".join(f"  {name:12s} {what}" for name, what in COMMANDS.items())
    return f"""usage: fingerpad COMMAND [SCENE] [--set KEY=VALUE ...]

How a fingertip sticks and slides on a touchscreen under electroadhesion, and spikes of its nerve fibres.

commands:
{commands}

A scene is a TOML file; without one it is the default press, charge and slide. Every key of a scene can be given as an
option, with or without a unit: --set f_ext="50 N/m" --set roughness.h_rms=2e-6. Forces f_ext are per metre of finger
along its axis: 75 N/m at the centre of the default finger correspond to about 0.5 N in all. run --force takes newtons.

examples:
  fingerpad estimate --f-ext 20:75:3 --voltage 0:200:5
  fingerpad run --set voltage=150 --out results/mine

fingerpad COMMAND --help lists the options of a command. --version prints the version."""
