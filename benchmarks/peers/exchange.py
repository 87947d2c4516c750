"""What programs are told and what they answer, as files; NumPy alone, since every peer runs in its own interpreter.

Lengths in mm, forces per length in N/mm, stresses in MPa, stiffnesses of the screen in N/mm^3: the units in which these
programs are used.
"""

import argparse
import json
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray

Array = NDArray[Any]
DELTA = 1e-6  # of the stretches: keeps the root's derivatives finite where two coincide
TOLERANCE, MOST = 1e-12, 60  # N/mm, norm of the nodal imbalance at which a solve ends; iterations a step
_PRESS, _STEPS = -0.06, 20  # mm
_SLIDES = ((0.005, 10), (0.05, 15))  # mm, steps


def nearest(places: Array, points: Array) -> list[int]:
    """Return the index of the place nearest to each point; shapes (n, 2) and (m, 2)."""
    return [int(np.argmin(np.linalg.norm(places - point, axis=1))) for point in points]


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

    @property
    def bulk_modulus(self) -> float:
        """K = 2/D (MPa)."""
        return 2 * self.shear_modulus * (1 + self.poisson) / (3 * (1 - 2 * self.poisson))

    def steps(self) -> Iterator[tuple[Load, Load]]:
        """Yield each load with the one before it."""
        return zip((Load(0.0, 0.0), *self.loads), self.loads, strict=False)

    @classmethod
    def read(cls, path: Path) -> "Case":
        """Read a case that :func:`write` wrote."""
        data = json.loads(path.read_text(encoding="utf-8"))
        return cls(**{**data, "loads": tuple(Load(**load) for load in data["loads"])})


def cases() -> dict[str, Case]:
    """Return the two histories of load."""
    press = [Load(0.0, _PRESS * k / _STEPS) for k in range(1, _STEPS)]
    loads, x = [*press, Load(0.0, _PRESS, "pressed with friction")], 0.0
    for end, count in _SLIDES:
        loads += [Load(x + (end - x) * k / count, _PRESS) for k in range(1, count)]
        loads += [Load(end, _PRESS, f"moved {1e3 * end:g} µm")]
        x = end
    frictionless = Case(0.0, (*press, Load(0.0, _PRESS, "pressed without friction")))
    return {"frictionless": frictionless, "friction": Case(0.25, tuple(loads))}


def timed() -> Case:
    """Return the history that is timed: pressed by 25 µm in five steps, moved to full slip in five; all reported."""
    press = [Load(0.0, -0.005 * k, f"pressed {5 * k} µm") for k in range(1, 6)]
    return Case(0.25, (*press, *(Load(0.0035 * k, -0.025, f"moved {3.5 * k:g} µm") for k in range(1, 6))))


@dataclass(frozen=True)
class Ridge:
    """Six-node triangles, with straight edges where every program is to take them.

    Attributes:
        points: nodes (mm), shape (nodes, 2), vertices first.
        triangles: three vertices, counter-clockwise, then the middles of the edges 01, 12, 20; shape (cells, 6).
        skin: edges that can touch: two vertices, the body on the left from the first to the second, and the middle;
            from left to right, shape (edges, 3).
        top, sides: nodes.
    """

    points: Array
    triangles: Array
    skin: Array
    top: Array
    sides: Array

    @property
    def vertices(self) -> int:
        """How many nodes are vertices."""
        return int(self.triangles[:, :3].max()) + 1

    @property
    def curved(self) -> bool:
        """Whether an edge's middle is not half-way along it, beyond roundoff."""
        corners = self.points[self.triangles[:, :3]]
        middles = (corners + corners[:, [1, 2, 0]]) / 2
        return bool(np.abs(self.points[self.triangles[:, 3:]] - middles).max() > 1e-12)

    @property
    def held(self) -> Array:
        """Nodes that are held in x."""
        return np.union1d(self.top, self.sides)

    @property
    def skin_pairs(self) -> set[frozenset[int]]:
        """Vertices of the edges that can touch."""
        return {frozenset((int(a), int(b))) for a, b in self.skin[:, :2]}

    def save(self, path: Path) -> None:
        """Write the mesh as .npz."""
        np.savez_compressed(path, **self.__dict__)

    @classmethod
    def read(cls, path: Path) -> "Ridge":
        """Read what :meth:`save` wrote."""
        with np.load(path) as data:
            return cls(**data)


def left_to_right(edges: Array, x: Array) -> Array:
    """Return edges, two ends and a middle each, from left to right.

    Args:
        edges: shape (edges, 3, ...).
        x: abscissae of the three, shape (edges, 3).
    """
    turned, backwards = edges.copy(), x[:, 0] > x[:, 1]
    turned[backwards, :2] = edges[backwards, 1::-1]
    return turned[np.argsort(x[:, 2])]


@dataclass
class State:
    """A reported equilibrium."""

    name: str
    """Of the load."""
    f_n: float
    """Normal force on the ridge's top (N/mm)."""
    f_t: float
    """Friction on the skin (N/mm), positive towards x > 0."""
    displacement: list[list[float]]
    """Of the skin's nodes (mm), in the order of ``Ridge.skin``, shape (3 edges, 2)."""
    p_n: float
    """Highest pressure at the program's own contact points (MPa of reference area)."""


@dataclass
class Answer:
    """What a program gives for a case."""

    program: str
    states: list[State] = field(default_factory=list)
    iterations: int = 0

    def report(self, load: Load, f_n: float, f_t: float, displacement: Array, p_n: Array) -> None:
        """Add a state if the load has a name."""
        if load.name:
            shown: list[list[float]] = [[float(x), float(y)] for x, y in displacement]
            self.states.append(State(load.name, float(f_n), float(f_t), shown, float(np.max(p_n))))

    @classmethod
    def read(cls, path: Path) -> "Answer":
        """Read an answer that :func:`write` wrote."""
        data = json.loads(path.read_text(encoding="utf-8"))
        return cls(**{**data, "states": [State(**state) for state in data["states"]]})


def write(record: Case | Answer, path: Path) -> None:
    """Write JSON, whole or not at all: an answer that is there is not computed again."""
    partial = path.with_name(f"{path.name}.part")
    partial.write_text(json.dumps(asdict(record)) + "\n", encoding="utf-8")
    partial.replace(path)


def main(solve: Callable[[Case, Ridge], Answer]) -> None:
    """Run a program as a command: CASE.json MESH.npz ANSWER.json."""
    parser = argparse.ArgumentParser()
    for name in ("case", "mesh", "answer"):
        parser.add_argument(name, type=Path)
    args = parser.parse_args()
    answer = solve(Case.read(args.case), Ridge.read(args.mesh))
    write(answer, args.answer)
    print(f"{answer.program}: {answer.iterations} iterations", flush=True)
