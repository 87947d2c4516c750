"""Scenes drawn anew, by the full model: they test the closed form's error, and nothing is fitted to them.

environment/run python3 -m benchmarks.loads.fresh [--minutes 10]     one process; the same command goes on later

Their sequence is that of :mod:`benchmarks.loads.scenes` with another seed. Writes docs/fresh.json.
"""

import sys
from collections.abc import Iterable
from typing import Any, NamedTuple

from benchmarks import harness
from benchmarks.loads import meshes
from benchmarks.loads.scenes import Data, of_scenes, scenes, section
from benchmarks.loads.states import by_scene, solved
from fingerpad.reduced import cylinders

COUNT, SEED = 8, 58
_MINUTES = 10.0


def fresh() -> list[Data]:
    """Return the values of the scenes by key."""
    return scenes(SEED, COUNT)


class Beside(NamedTuple):
    """A quantity of a section by the closed form beside the full model."""

    scene: int
    f_ext: float
    off: float
    """The full model's value over that of the closed form, less 1."""
    error: float
    """Relative ± of the closed form; NaN where that is not known."""

    @property
    def inside(self) -> bool:
        """Whether the ± covers the full model's value."""
        return abs(self.off) <= self.error


def beside(kept: Iterable[Data], key: str, known: list[list[meshes.Checked]]) -> list[Beside]:
    """Return a quantity of every state that the full model reached, without the error of its mesh.

    Args:
        kept: scenes with their states.
        key: of the quantity at full slip.
        known: of the meshes, as of :func:`benchmarks.loads.meshes.errors`.
    """
    found = []
    for each in meshes.without(kept, known):
        for state in (state for state in each["states"] if "failure" not in state):
            number = cylinders.solve(section(each["values"], state["f_ext"])).number("full_slip", key)
            found.append(
                Beside(each["scene"], state["f_ext"], state[key] / number.value - 1, number.error / number.value)
            )
    return found


def main() -> int:
    """Solve for what is missing, and keep the numbers."""
    given = harness.parser(__doc__, "")
    given.add_argument("--minutes", type=float, default=_MINUTES, help="processor time after which no scene is begun")
    args = given.parse_args()
    every = fresh()
    states: dict[str, list[Any]] = solved(args.out / "fresh", args.minutes, of_scenes(every))
    kept = by_scene(every, states)
    harness.keep("fresh", {"scenes": kept, "count": COUNT, "seed": SEED}, harness.made(), args.docs)
    return 0


if __name__ == "__main__":
    sys.exit(main())
