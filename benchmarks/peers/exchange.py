"""What programs are told and what they answer, as files; NumPy alone, since every peer runs in its own interpreter.

Lengths in mm, forces per length in N/mm, stresses in MPa, stiffnesses of the screen in N/mm^3: the units in which these
programs are used.
"""

import argparse
import json
import os
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]


VARIANTS = {
    "as FElupe": "skin integrated by Simpson's rule, whose points are nodes; new points drag since they touched",
    "as CalculiX": "stiffnesses per current area; new points drag since the unloaded state",
    "as installed": "the program's own element, known to be wrong",
}


@dataclass(frozen=True)
class Load:
    """Where the top is taken by a step, and the sides, in x, with it; a load with a name is reported."""

    x: float
    y: float
    name: str = ""


@dataclass(frozen=True)
class Case:
    r"""One ridge pressed on the plane y = 0 and moved over it, in plane strain.

    .. math:: W = \frac{2 G_0}{a^2} (\bar\lambda_1^a + \bar\lambda_2^a + \bar\lambda_3^a - 3) + \frac K2 (J - 1)^2

    The contact pressure is eps_n times the penetration and friction that of springs eps_t, dragged where they would
    bear more than mu_f times the pressure; all per reference area.
    """

    mu_f: float
    loads: tuple[Load, ...]
    shear_modulus: float = 0.08676
    exponent: float = 14.53
    poisson: float = 0.48
    eps_n: float = 1000.0
    eps_t: float = 100.0
    variant: str = ""
    """A deviation that explains another program's: one of VARIANTS, for the programs that can."""

    def __post_init__(self) -> None:
        if self.variant and self.variant not in VARIANTS:
            raise ValueError(f"variant is {self.variant!r}; it must be one of {', '.join(VARIANTS)}")

    @property
    def bulk_modulus(self) -> float:
        """K = 2/D (MPa)."""
        return 2 * self.shear_modulus * (1 + self.poisson) / (3 * (1 - 2 * self.poisson))


@dataclass(frozen=True)
class Ridge:
    """Six-node triangles with straight edges.

    Attributes:
        points: nodes (mm), shape (nodes, 2), vertices first.
        vertices: how many of them are vertices.
        triangles: three vertices, counter-clockwise, then the middles of the edges 01, 12, 20; shape (cells, 6).
        skin: edges that can touch: two vertices, the body on the left from the first to the second, and the middle;
            from left to right, shape (edges, 3).
        top, sides: nodes.
    """

    points: Array
    vertices: int
    triangles: Array
    skin: Array
    top: Array
    sides: Array

    def save(self, path: Path) -> None:
        """Write the mesh as .npz."""
        np.savez_compressed(path, **self.__dict__)

    @classmethod
    def read(cls, path: Path) -> "Ridge":
        """Read what :meth:`save` wrote."""
        with np.load(path) as data:
            arrays = {name: data[name] for name in data.files}
        return cls(**{**arrays, "vertices": int(arrays["vertices"])})


@dataclass
class State:
    """A reported equilibrium."""

    name: str
    f_n: float
    """Normal force on the ridge's top (N/mm)."""
    f_t: float
    """Friction on the skin (N/mm), positive towards x > 0."""
    displacement: list[list[float]]
    """Of the skin's nodes (mm), in the order of ``Ridge.skin``: shape (3 edges, 2)."""
    x: list[float]
    """Current abscissae (mm) of the program's own contact points."""
    p_n: list[float]
    """Pressure there (MPa of reference area)."""
    t_t: list[float]
    """Friction there (MPa of reference area)."""


@dataclass
class Answer:
    """What a program gives for a case."""

    program: str
    version: str
    licence: str
    states: list[State] = field(default_factory=list)
    iterations: int = 0
    seconds: float = 0.0
    """Processor time, that of starting the program included."""


def plain(values: Array) -> Any:
    """Return an array as lists of Python's own numbers, which JSON takes."""
    return values.tolist()


def write_case(case: Case, path: Path) -> None:
    """Write a case as JSON."""
    path.write_text(json.dumps(asdict(case), indent=1) + "\n", encoding="utf-8")


def read_case(path: Path) -> Case:
    """Read what :func:`write_case` wrote."""
    data = json.loads(path.read_text(encoding="utf-8"))
    return Case(**{**data, "loads": tuple(Load(**load) for load in data["loads"])})


def write_answer(answer: Answer, path: Path) -> None:
    """Write an answer as JSON, whole or not at all: an answer that is there is not asked for again."""
    partial = path.with_name(f"{path.name}.part")
    partial.write_text(json.dumps(asdict(answer)) + "\n", encoding="utf-8")
    partial.replace(path)


def read_answer(path: Path) -> Answer:
    """Read what :func:`write_answer` wrote."""
    data = json.loads(path.read_text(encoding="utf-8"))
    return Answer(**{**data, "states": [State(**state) for state in data["states"]]})


def steps(case: Case) -> Iterator[tuple[Load, Load]]:
    """Yield each load with the one before it."""
    return zip((Load(0.0, 0.0), *case.loads), case.loads, strict=False)


def main(solve: Callable[[Case, Ridge], Answer]) -> None:
    """Run a program as a command: CASE.json MESH.npz ANSWER.json."""
    parser = argparse.ArgumentParser()
    for name in ("case", "mesh", "answer"):
        parser.add_argument(name, type=Path)
    args = parser.parse_args()
    answer = solve(read_case(args.case), Ridge.read(args.mesh))
    answer.seconds = sum(os.times()[:4])
    write_answer(answer, args.answer)
    print(f"{answer.program} {answer.version}: {answer.iterations} iterations, {answer.seconds:.1f} s", flush=True)
    for s in answer.states:
        print(f"  {s.name}: F_n {s.f_n:.8f}, F_t {s.f_t:.8f} N/mm, peak pressure {max(s.p_n):.6f} MPa", flush=True)
