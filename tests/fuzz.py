"""Scenes, command lines and files as nobody should write them, each run-ready or refused in one sentence.

environment/run python3 -m tests.fuzz [--count 10000] [--seed 1] [--first 0] [--files]

A mutant is made from a scene that comes along, or from the defaults, by a few changes at random: of values, keys, bytes
and arguments. It is fixed by the seed and its number alone, so that ``--first N --count 1`` repeats one of them. What
is accepted has passed everything that a run does before it meshes; nothing is computed. With ``--files`` the mutants
are files that a scene or a command names: maps, meshes, voltages, measurements (:mod:`tests.fuzz_files`).
"""

import argparse
import contextlib
import io
import json
import os
import random
import signal
import sys
import tempfile
import time
import warnings
from collections import Counter
from collections.abc import Callable, Iterator
from dataclasses import dataclass
from pathlib import Path
from typing import Any, get_args

import numpy as np
from pydantic import BaseModel

from fingerpad.cli import refuse
from fingerpad.cli.arguments import Parser, scene_of
from fingerpad.model import options
from fingerpad.model.options import by_rule, refuse_sizes
from fingerpad.reduced.cylinders import tip_of
from fingerpad.results.files import check_folder
from fingerpad.scene import Scene, SceneError
from fingerpad.scene.controls import ends_of
from tests import fuzz_files
from variational.attraction.cylinder import Cylinder, NoEquilibriumError

SCENES = sorted((Path(__file__).parent.parent / "demos/scenes").glob("*.toml"))
LONGEST = 500  # characters of a refusal
_NUMBERS = tuple("0 -1 1 nan inf -inf 1e308 5e-324 -0.0 1e-9 1e9 16 1.97 75e3 2e14".split())
_WHOLE = ("9" * 400, "0x" + "f" * 5000, "-" + "9" * 30, "9223372036854775808", "0b1", "1_000")
_TEXTS = (
    '"200"', '"high"', '""', '"a/b"', '"../../etc"', '"/"', '"."', '".hidden"', '"CON"', '"a\\u0000b"', '"line\\nend"',
    '"' + "n" * 300 + '"', '"' + "long " * 20000 + '"', '"Größe bei 200 V"', '"压"', '"\\u202Ename"', "'''x'''",
    '"press"', '"50 N/m"', '"5 µm"', '"0.2 kV"', '"25 kPa"', '"1e999 m"', '"20 degC"', '"9**9**9 V"', '"5 {0} ("',
    '"/dev/zero"', '"=1+1"', '"@press"', '{file = "/dev/zero"}', '{file = "/dev/stdin"}', '{file = "/"}',
    '{waveform = "file", file = "/dev/zero"}',
)  # fmt: skip
_OTHERS = (
    "true", "false", "[]", "[1.0]", "[nan]", "[[[]]]", "{}", "{a = 1}", "1979-05-27", "07:32:00",
    "[" * 100 + "]" * 100, "[" * 5000 + "]" * 5000, "[" + "1, " * 5000 + "]", "[1.0, -0.6]", "[-1]", "[inf]", "",
)  # fmt: skip
_OPTIONS = ("f_ext", "voltage", "mesh.contact", "friction", "roughness.h_rms", "f_ext.x", "mesh", "", " ")
_STRAY = (
    "-voltage", "-f_ext", "-snes_monitor", "--volts", "--f", "results", "-", "--", "---", "-5", "", "\udcff",
    "x" * 5000,
    "-fingerpad_", "-fingerpad_snes_rtol", "-h_rms", "--set", "--set=", "--set=voltage", "--voltage=3",
    "-fingerpad_ksp_type=\n", "--set=voltage=200 V",
)  # fmt: skip
_ODD_FILES = ("/dev/zero", "/dev/null", "/dev/stdout", "/", "none.toml", "n" * 300, "n/" * 3000, "\udcff.toml", "")
_ODD_FOLDERS = (*"out a/b/c /dev/null /proc/1 file file/below . -o".split(), "n" * 300, "n/" * 3000, "\udcff", "")


@dataclass(frozen=True)
class Mutant:
    """A scene file, none if it is None, and a command line in which ``{folder}`` is where the file is."""

    number: int
    file: bytes | None
    argv: tuple[str, ...]


# -- making them ---------------------------------------------------------------------------------------
def mutant(seed: int, number: int) -> Mutant:
    chance = random.Random(f"{seed}-{number}")
    file, argv = None, []
    if chance.random() < 0.85:
        file = _file(chance)
        argv += ["{folder}/scene.toml"]
    elif chance.random() < 0.3:
        argv += [chance.choice((*_ODD_FILES, "{folder}", "{folder}/pipe", "{folder}/large.toml"))]
    if chance.random() < 0.3:
        argv += _arguments(chance)
    return Mutant(number, file, tuple(argv))


def _file(chance: random.Random) -> bytes:
    """Return a scene with some of its values, keys or bytes changed."""
    base = chance.choice(SCENES).read_text(encoding="utf-8") if chance.random() < 0.5 else ""
    lines = base.splitlines()
    for _ in range(chance.choice((0, 1, 1, 1, 2, 3))):
        _change_line(chance, lines)
    data = "\n".join(lines).encode()
    return _change_bytes(chance, data) if chance.random() < 0.2 else data


def _change_line(chance: random.Random, lines: list[str]) -> None:
    kind = chance.random()
    values = [k for k, line in enumerate(lines) if "=" in line and not line.startswith("#")]
    if kind < 0.25 and values:
        k = chance.choice(values)
        key = lines[k].partition("=")[0].strip()
        lines[k] = f"{_misspelt(chance, key) if chance.random() < 0.3 else key} = {_value(chance)}"
    elif kind < 0.35 and lines:
        k = chance.randrange(len(lines))
        lines[k : k + 1] = chance.choice(([], [lines[k]] * 2))
    elif kind < 0.45:
        loads = [f"[[history]]\nname = {_value(chance, _TEXTS)}\nf_ext = {_value(chance, ('5', '0', '1e3'))}"]
        lines += loads * chance.choice((1, 1, 2, 1500))
    else:
        table, key, default = chance.choice(_KEYS)
        name = _misspelt(chance, key) if chance.random() < 0.15 else key
        value = _scaled(chance, default) if default and chance.random() < 0.6 else _value(chance)
        # in front, where no table has begun yet; as a dotted key it may be anywhere
        lines.insert(0, f"{'.'.join([*table, name])} = {value}")


def _change_bytes(chance: random.Random, data: bytes) -> bytes:
    changes: tuple[Callable[[], bytes], ...] = (
        lambda: b"\xef\xbb\xbf" + data,
        lambda: data.decode().encode("utf-16"),
        lambda: data[: chance.randrange(len(data) + 1)],
        lambda: data.replace(b"=", b"==", 1),
        lambda: data + bytes(chance.randrange(256) for _ in range(20)),
        lambda: b"".join(bytes([b ^ 1 << chance.randrange(8)]) if chance.random() < 0.02 else bytes([b]) for b in data),
        lambda: data.replace(b"\n", b"\r\n"),
        lambda: b"#" * 2_000_000 + data,
        lambda: b"a." * 3000 + b"a = 1\n" + data,
        lambda: b'"' + b"k" * 100_000 + b'" = 1\n' + data,
        lambda: b'"" = 1\n' + data,
        lambda: b'"a\\nb"."" = 1\n' + data,
    )
    return chance.choice(changes)()


def _arguments(chance: random.Random) -> list[str]:
    found: list[str] = []
    for _ in range(chance.choice((1, 1, 2, 3))):
        kind = chance.random()
        if kind < 0.45:
            value = _value(chance).strip('"').replace("\0", "")
            given = f"{chance.choice(_OPTIONS)}={value}"
            found += [f"--set={given}"] if chance.random() < 0.5 else ["--set", given]
        elif kind < 0.7:
            found += ["--out", "{folder}/" + chance.choice(_ODD_FOLDERS) if kind < 0.6 else chance.choice(_ODD_FOLDERS)]
        else:
            found.append(chance.choice(_STRAY))
    return found


def _value(chance: random.Random, among: tuple[str, ...] = ()) -> str:
    if among and chance.random() < 0.8:
        return chance.choice(among)
    return chance.choice(chance.choice((_NUMBERS, _NUMBERS, _WHOLE, _TEXTS, _OTHERS)))


def _scaled(chance: random.Random, default: float) -> str:
    """Return a number near or far from a default."""
    factor = 10 ** chance.choice((chance.uniform(-0.3, 0.3), chance.uniform(-3, 3), chance.uniform(-12, 12)))
    return repr(default * factor)


def _misspelt(chance: random.Random, key: str) -> str:
    k = chance.randrange(len(key))
    return chance.choice((key[:k] + key[k + 1 :] or "x", key[:k] + "x" + key[k:], key.replace("_", "-"), key.upper()))


def _keys(model: type[BaseModel], table: tuple[str, ...] = ()) -> Iterator[tuple[tuple[str, ...], str, Any]]:
    """Yield table, key and default, where that is a number, of everything that a scene has."""
    for name, field in model.model_fields.items():
        kinds = (field.annotation, *get_args(field.annotation))
        inner = next((kind for kind in kinds if isinstance(kind, type) and issubclass(kind, BaseModel)), None)
        default = field.default
        yield table, name, default if isinstance(default, int | float) and not isinstance(default, bool) else None
        if inner is not None:
            yield from _keys(inner, (*table, name))


_KEYS = tuple(_keys(Scene))


# -- trying them ---------------------------------------------------------------------------------------
def prepare(folder: Path) -> None:
    """Make what odd paths of mutants lead to."""
    os.mkfifo(folder / "pipe")
    (folder / "file").write_bytes(b"")
    with (folder / "large.toml").open("wb") as file:
        file.truncate(10**9)  # without taking that much of the disk


def fault(case: Mutant, folder: Path) -> tuple[str, str]:
    """Return what is wrong with how a mutant is taken, empty if nothing, and "ready" or what it is refused for.

    Args:
        case: a mutant.
        folder: one that was prepared.
    """
    if case.file is not None:
        (folder / "scene.toml").write_bytes(case.file)
    argv = [word.replace("{folder}", str(folder)) for word in case.argv]
    parser = Parser("run", "fingerpad run")
    parser.add_scene()
    parser.add_out("results", "folder of the results")
    out, err = io.StringIO(), io.StringIO()
    signal.signal(signal.SIGALRM, _hang)
    signal.alarm(fuzz_files.SLOW)
    try:
        with contextlib.redirect_stdout(out), contextlib.redirect_stderr(err), warnings.catch_warnings():
            warnings.simplefilter("error")
            try:
                args = parser.read(argv, petsc=True)
                scene = scene_of(args)
                check_folder(args.out)
                return _unready(scene), "ready"
            except SceneError as error:
                code = refuse(str(error))
        return bad_refusal(code, err.getvalue()), err.getvalue()
    except SystemExit as stop:
        helped = stop.code == 0 and out.getvalue().startswith("usage: ")
        return ("", "help") if helped else (f"exit code {stop.code}", "")
    except Exception as error:  # noqa: BLE001 (whatever it is, it is what is looked for)
        return f"{type(error).__name__}: {error}"[:500], ""
    except _Hang:
        return f"more than {fuzz_files.SLOW} s", ""
    finally:
        signal.alarm(0)


class _Hang(BaseException):
    """A mutant takes too long."""


def _hang(*_: Any) -> None:
    raise _Hang


def bad_refusal(code: Any, text: str) -> str:
    """Return what is wrong with a refusal, empty if nothing."""
    if code != 2:
        return f"exit code {code}"
    if not (text.startswith("fingerpad: ") and text.endswith("\n") and text.count("\n") == 1):
        return f"not one line: {text[:500]!r}"
    sentence = text.removeprefix("fingerpad: ")
    if len(text) > LONGEST:
        return f"{len(text)} characters: {text[:500]!r}"
    if not sentence.rstrip("\n").isprintable():
        return f"not printable: {text!r}"
    key = sentence.split(";")[0].replace(" ...", "")  # of a text that was cut
    if sentence.startswith((" ", ".", "is ")) or " ." in key or "Invalid JSON" in sentence:
        return f"no key: {text!r}"
    return ""


def _unready(scene: Scene) -> str:
    """Return why an accepted scene is not ready for a run, empty if it is."""
    if scene.geometry.file is None:
        refuse_sizes(scene.geometry, by_rule(scene).mesh, scene.numerics, options.plan(scene))
    json.dumps(scene.parameters(), allow_nan=False)
    closure = scene.closure()
    gaps = closure(np.geomspace(scene.roughness.p_floor, closure.full_pressure, 20)).d_eq
    if not (np.isfinite(gaps).all() and (gaps >= 0).all()):
        return f"air gaps {gaps}"
    try:
        horny = scene.materials.stratum_corneum
        tip = tip_of(scene.geometry, np.array([scene.geometry.ridge_wavelength / 4]))
        ridge = Cylinder(tip, 2 * horny.shear_modulus / (1 - horny.poisson), scene.h_0, closure)
        voltages = (load.drive.peak if load.drive else load.level or 0.0 for load in scene.loads())
        ridge.under_loads([max(ends_of(load.f_ext)[1] or 1.0 for load in scene.loads()) / 9], max(voltages))[0]
    except (NoEquilibriumError, SceneError) as error:
        return "" if len(str(error)) < LONGEST else str(error)
    return ""


def main(argv: list[str] | None = None) -> int:
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    for name, default in (("--count", 10000), ("--seed", 1), ("--first", 0)):
        parser.add_argument(name, type=int, default=default)
    parser.add_argument("--files", action="store_true")
    args = parser.parse_args(argv)
    kinds, wrong, start = Counter[str](), 0, time.monotonic()
    with tempfile.TemporaryDirectory() as name:
        prepare(Path(name))
        for k in range(args.first, args.first + args.count):
            if args.files:
                what, how = fuzz_files.fault(fuzz_files.mutant(args.seed, k), Path(name), bad_refusal)
            else:
                what, how = fault(mutant(args.seed, k), Path(name))
            kinds["ready" if how == "ready" else "refused"] += 1
            if what:
                wrong += 1
                print(f"mutant {k}: {what}", flush=True)
            if (k + 1 - args.first) % 500 == 0:
                print(
                    f"{k + 1 - args.first} of {args.count}, {time.monotonic() - start:.0f} s: {dict(kinds)}", flush=True
                )
    print(f"{args.count} mutants: {kinds['ready']} run-ready, {kinds['refused']} refused, {wrong} wrong")
    return 1 if wrong else 0


if __name__ == "__main__":
    sys.exit(main())
