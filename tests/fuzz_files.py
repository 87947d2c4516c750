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
import zipfile
from collections.abc import Callable
from dataclasses import dataclass
from functools import cache
from pathlib import Path

import gmsh
import numpy as np
import scipy.io
from mpi4py import MPI

import geometry
from fingerpad.cli import refuse, topography
from fingerpad.measurements import table as measurements
from fingerpad.scene import SceneError, from_data
from geometry.mesh import load
from geometry.profiles import GeometryError
from geometry.session import session

SLOW = 60  # s, of a mutant that hangs; most take some ms
SIZE = (32, 24)  # pixels of a map, which are squares
_HEADERS = (  # of .npy, each before 400 bytes
    "{'descr': '<f8', 'fortran_order': False, 'shape': (1000000, 1000000), }",
    "{'descr': '<f8', 'fortran_order': False, 'shape': (-5, 10), }",
    "{'descr': '<f8', 'fortran_order': False, 'shape': (0, 5), }",
    "{'descr': '|V8', 'fortran_order': True, 'shape': (5, 10), }",
    "{'descr': '|O', 'fortran_order': True, 'shape': (5, 10), }",
    "{'descr': 'nonsense', 'shape': 5}",
    "[" * 5000,
    "{'descr': '<f8', 'fortran_order': False, 'shape': (5, 10), }" + " " * 60_000,
)
_KINDS = ("<c16", "<c8", "<U5", "|S3", "|b1", "<M8[s]", "<f2", ">f4", "|i1", "<u8", "|V4", [("z", "<f8")], "<f8")
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
    plain += [(".npy", _npy(np.zeros(SIZE, dtype=kind))) for kind in _KINDS]
    plain += [(".npy", b"\x93NUMPY\x02\x00" + len(h).to_bytes(4, "little") + h.encode() + bytes(400)) for h in _HEADERS]
    matrix = "\n".join(";".join(f"{z:.6f}" for z in row) for row in heights)
    points = "\n".join(f"{a} {b} {z:.6f}" for a, b, z in zip(x.ravel(), y.ravel(), heights.ravel(), strict=True))
    header = "# Channel: Height\n# Width: 32 µm\n# Height: 24 µm\n# Value units: µm\n"
    gwyddion = header + matrix.replace(";", " ")
    plain += [(".csv", matrix.encode()), (".xyz", points.encode()), (".txt", gwyddion.encode())] * 3
    voltages = "time (s),voltage (V)\n" + "".join(f"{k / 10},{20 * k % 150}\n" for k in range(8))
    table = "# source: Surname 2020\n# people: 5\nforce (N/m), voltage (V), friction (1), spread (1)\n"
    table += "".join(f"{10 * k}, 100, 0.{k}, 0.0{k}\n" for k in range(1, 8))
    tables = [
        (".volts", voltages.encode()),
        *((".measured", table.replace(", ", mark).encode()) for mark in (", ", ";")),
    ]
    return (*plain, *_instruments(heights), *_meshes() * 2, *tables * 4)


def _npy(values: np.ndarray) -> bytes:
    stream = io.BytesIO()
    np.save(stream, values)
    return stream.getvalue()


def _instruments(heights: np.ndarray) -> list[tuple[str, bytes]]:
    """Return maps in the formats of instruments, none without SurfaceTopography."""
    try:
        from SurfaceTopography import Topography
        from SurfaceTopography.IO import readers
    except ImportError:
        return []
    import h5py
    from PIL import Image

    found = [(f".{reader.format()}", start) for reader in readers for start in _magic(reader)]
    topography = Topography(heights, (3.2, 2.4), unit="um")
    with tempfile.TemporaryDirectory() as name:
        for ending, write in (
            (".nc", topography.to_netcdf),
            (".gwy", topography.to_gwy),
            (".x3p", topography.to_x3p),
            (".mat", lambda file: scipy.io.savemat(file, {"z": heights}, format="4")),
            (".npz", lambda file: np.savez(file, z=heights)),
            (".tif", lambda file: Image.fromarray((100 * heights + 300).astype(np.uint16)).save(file)),
        ):
            write(f"{name}/map{ending}")
            found += [(ending, Path(f"{name}/map{ending}").read_bytes())] * 4
        with h5py.File(f"{name}/map.h5", "w") as file:
            file["z"] = heights
        found += [(".h5", Path(f"{name}/map.h5").read_bytes())] * 4
    nx, ny = SIZE
    whole_numbers = (1000 * heights).astype("<i2").T.tobytes()
    bcr = f"fileformat = bcrstm\nxpixels = {nx}\nypixels = {ny}\nxlength = 3200\nylength = 2400\n".encode()
    sdf = f"aISO-1.0\nNumPoints = {nx}\nNumProfiles = {ny}\nXscale = 1e-6\nYscale = 1e-6\nZscale = 1e-6\n"
    sdf += "DataType = 7\n*\n"
    nms = bytearray(3468)
    nms[16:32] = np.array([0.0, 5.0]).tobytes()
    nms[1368:1392] = np.array(SIZE, dtype="<u4").tobytes() + np.array([1e-3, 1e-3]).tobytes()
    found += [(".bcr", bcr.ljust(2048) + whole_numbers), (".nms", bytes(nms) + whole_numbers)] * 4
    found += [(".sdf", sdf.encode() + " ".join(f"{z:.5f}" for z in heights.T.ravel()).encode() + b"\n*\n")] * 4
    return [(ending, _without_date(content)) for ending, content in found]


def _magic(reader: type) -> list[bytes]:
    return [start for place, start in getattr(reader, "_magic", None) or () if place == 0]


def _without_date(content: bytes) -> bytes:
    """Return the archives among the files with the same dates each time."""
    if not content.startswith(b"PK\x03\x04") or len(content) < 30:
        return content
    stream = io.BytesIO()
    with zipfile.ZipFile(io.BytesIO(content)) as archive, zipfile.ZipFile(stream, "w") as copy:
        for name in archive.namelist():
            copy.writestr(zipfile.ZipInfo(name), re.sub(rb"(<Date>).*?(</Date>)", rb"\1\2", archive.read(name)))
    return stream.getvalue()


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
    """Return one mutant."""
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
            given = {ending: unit + size for ending in (".npy", ".csv", ".xyz")}
            given |= {ending: unit + size for ending in (".mat", ".npz", ".h5", ".tif")}
            return topography.main([str(path), *given.get(path.suffix, [])])
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
