"""Files as nobody should write them, each read or refused in one sentence; see :mod:`tests.fuzz`.

A mutant is a small file that is whole, of a map, a mesh, voltages or measurements, with a few changes at random: cut,
bytes turned, numbers replaced, parts doubled, the beginning of another format. Each is read in a process of its own,
since gmsh and HDF5 could end it.
"""

import contextlib
import io
import os
import random
import re
import signal
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import gmsh
import numpy as np
import scipy.io
from mpi4py import MPI

import geometry
from fingerpad.cli import refuse, roughness
from fingerpad.measurements import table as measurements
from fingerpad.scene import SceneError, from_data
from geometry.mesh import load
from geometry.profiles import GeometryError
from geometry.shape import session

SLOW = 60  # s, of a mutant that hangs; most take some ms
SIZE = (32, 24)  # pixels of a map, which are squares
_NUMBERS = (b"nan", b"inf", b"-1", b"0", b"1e308", b"5e-324", b"99999999999999999999", b"1,5", b"x", b"", b"4294967295")


@dataclass(frozen=True)
class Mutant:
    """The content of a file, and what its name ends with."""

    number: int
    ending: str
    content: bytes


# -- files that are whole ------------------------------------------------------------------------------
@cache
def whole() -> tuple[tuple[str, bytes], ...]:
    """Return files of every kind that is read, the ends of their names first; the same bytes each time."""
    x, y = np.meshgrid(*map(np.arange, SIZE), indexing="ij")
    walk = np.random.default_rng(1).normal(size=SIZE).cumsum(axis=0).cumsum(axis=1)
    heights = walk / walk.std()
    plain = [(".npy", _npy((9 * heights).astype(kind))) for kind in (float, complex, np.int16, ">f4")]
    matrix = "\n".join(";".join(f"{z:.6f}" for z in row) for row in heights)
    points = "\n".join(f"{a} {b} {z:.6f}" for a, b, z in zip(x.ravel(), y.ravel(), heights.ravel(), strict=True))
    header = "# Channel: Height\n# Width: 32 µm\n# Height: 24 µm\n# Value units: µm\n"
    gwyddion = header + matrix.replace(";", " ")
    plain += [(".csv", matrix.encode()), (".xyz", points.encode()), (".txt", gwyddion.encode())] * 3
    voltages = "time (s),voltage (V)\n" + "".join(f"{k / 10},{20 * k % 150}\n" for k in range(8))
    table = "# source: Surname 2020\n# people: 5\nforce (N/m), voltage (V), friction (1), spread (1)\n"
    table += "".join(f"{10 * k}, 100, 0.{k}, 0.0{k}\n" for k in range(1, 8))
    lab = "Proband;force [N/m];voltage [V];friction [%];spread [%];Temperatur (°C)\n"
    lab += "".join(f"{'AB'[k % 2]};{10 * k};{50 * (k % 3)};{-k}0,5;{k};22,5\n" for k in range(1, 8))
    tables = [(".volts", voltages.encode()), (".measured", table.encode()), (".measured", lab.encode("latin-1"))]
    return (*plain, *_instruments(heights), *_meshes() * 2, *tables * 4)


def _npy(values: np.ndarray) -> bytes:
    stream = io.BytesIO()
    np.save(stream, values)
    return stream.getvalue()


def _instruments(heights: np.ndarray) -> list[tuple[str, bytes]]:
    """Return maps in formats that SurfaceTopography reads, none without it."""
    try:
        from SurfaceTopography import Topography
    except ImportError:
        return []
    found = []
    topography = Topography(heights, (3.2, 2.4), unit="um")
    with tempfile.TemporaryDirectory() as name:
        for ending, write in (
            (".nc", topography.to_netcdf),
            (".mat", lambda file: scipy.io.savemat(file, {"z": heights}, format="4")),
            (".npz", lambda file: np.savez(file, z=heights)),
        ):
            write(f"{name}/map{ending}")
            found += [(ending, Path(f"{name}/map{ending}").read_bytes())] * 4
    return found


@cache
def _meshes() -> tuple[tuple[str, bytes], ...]:
    """Return a ridge as gmsh writes it: text and binary, of both versions."""
    found = []
    with tempfile.TemporaryDirectory() as name, session("ridge"):
        geometry.ridge(size=60e-6)()
        gmsh.option.setNumber("Mesh.ScalingFactor", 1e-3)
        for version in (2.2, 4.1):
            for binary in (0, 1):
                gmsh.option.setNumber("Mesh.MshFileVersion", version)
                gmsh.option.setNumber("Mesh.Binary", binary)
                gmsh.write(f"{name}/ridge.msh")
                found.append((".msh", Path(f"{name}/ridge.msh").read_bytes()))
    return tuple(found)


# -- mutants -------------------------------------------------------------------------------------------
def mutant(seed: int, number: int) -> Mutant:
    chance = random.Random(f"file-{seed}-{number}")
    ending, content = chance.choice(whole())
    for _ in range(chance.choice((0, 1, 1, 1, 2, 3))):
        content = _changed(chance, content)
    return Mutant(number, ending, content)


def _changed(chance: random.Random, content: bytes) -> bytes:
    a, b = sorted(chance.randrange(len(content) + 1) for _ in range(2))
    near = min(a + chance.choice((1, 2, 4, 8, 30)), len(content))
    numbers = [match.span() for match in re.finditer(rb"(?<![\w.])[-\d.][\d.e+-]*", content[a : a + 2000])]
    first, last = chance.choice(numbers) if numbers else (0, 0)
    lines = content.split(b"\n")
    k = chance.randrange(len(lines))
    changes: tuple[Callable[[], bytes], ...] = (
        lambda: content[:a],
        lambda: content[:a] + content[b:],
        lambda: content[:b] + content[a:],
        lambda: content[:a] + bytes(near - a) + content[near:],
        lambda: content[:a] + b"\xff" * (near - a) + content[near:],
        lambda: content[:a] + chance.randbytes(near - a) + content[near:],
        lambda: content[:a] + chance.randbytes(20) + content[a:],
        lambda: bytes(c ^ 1 << chance.randrange(8) if chance.random() < 0.01 else c for c in content),
        lambda: content[: a + first] + chance.choice(_NUMBERS) + content[a + last :],
        lambda: content[: a + first] + chance.choice(_NUMBERS) + content[a + last :],
        lambda: b"\n".join(lines[:k] + lines[k + 1 :]),
        lambda: b"\n".join(lines[:k] + [lines[k]] * 3 + lines[k + 1 :]),
        lambda: chance.choice(whole())[1][: chance.choice((4, 16, 64, 1000))] + content[a:],
        lambda: content + chance.randbytes(600),
        lambda: content[:a] + chance.choice((b"9", b" ", b"a,", b'"', b"\n")) * 200_000 + content[a:],
    )
    return chance.choice(changes)()


# -- reading them --------------------------------------------------------------------------------------
def fault(case: Mutant, folder: Path, refusal: Callable[[int, str], str]) -> tuple[str, str]:
    """Return what is wrong with how a file is taken, empty if nothing, and "ready" or what it is refused for.

    Args:
        case: a mutant.
        folder: one in which nothing is kept.
        refusal: what is wrong with an exit code and a text, empty if nothing.
    """
    path = folder / f"mutant{case.ending}"
    path.write_bytes(case.content)
    code, text = _apart(lambda: _read(path))
    path.unlink()
    if code == 0:
        return "", "ready"
    if code < 0:
        words = f"more than {SLOW} s" if code == -signal.SIGALRM else f"signal {-code}"
        return f"{words}: {text[-300:]!r}", ""
    return (f"exit code {code}: {text[-500:]!r}" if code != 2 else refusal(code, text)), text


def _read(path: Path) -> int:
    """Read a file as the command does; return the exit code."""
    try:
        if path.suffix == ".msh":
            load(MPI.COMM_SELF, geometry.file(path))
        elif path.suffix == ".volts":
            wave = {"waveform": "file", "file": str(path)}
            press, over_time = {"name": "press", "f_ext": 5.0}, {"name": "wave", "duration": 0.1, "voltage": wave}
            from_data({"history": [press, over_time]})
        elif path.suffix == ".measured":
            measurements.read(path)
        else:
            unit, size = ["--unit", "um"], ["--size", "32 um", "24 um"]
            given = {ending: unit + size for ending in (".npy", ".csv", ".xyz", ".mat", ".npz")}
            return roughness.topography([str(path), *given.get(path.suffix, [])])
    except (SceneError, GeometryError) as error:
        return refuse(str(error))
    return 0


def _apart(call: Callable[[], int]) -> tuple[int, str]:
    """Return the exit code of a call in a process of its own, negative for a signal's number, and what it printed."""
    with tempfile.TemporaryFile() as printed:
        child = os.fork()
        if child == 0:
            with contextlib.suppress(BaseException):
                signal.alarm(SLOW)
                os.dup2(os.open(os.devnull, os.O_WRONLY), 1)
                os.dup2(printed.fileno(), 2)
                sys.stdout, sys.stderr = open(1, "w"), open(2, "w", buffering=1)  # noqa: SIM115 (they end with it)
                try:
                    os._exit(call())
                except BaseException as error:  # noqa: BLE001 (whatever it is, it is what is looked for)
                    os.write(2, f"{type(error).__name__}: {error}"[-500:].encode(errors="replace"))
            os._exit(70)
        _, status = os.waitpid(child, 0)
        printed.seek(0)
        return os.waitstatus_to_exitcode(status), printed.read().decode(errors="replace")
