"""States of the page on the microscale by closures and readings of a voltage, beside published numbers."""

from collections.abc import Mapping, Sequence
from typing import Any, NamedTuple

from benchmarks import harness
from variational.roughness.closure import BALANCED

LOAD, PAPER, NEAR = "75", 0.55, 0.1
"""The paper's force (N/m) and µ_app, and what counts as equal to it."""
GAPS = (1.5e-6, 2.5e-6)
"""Published equivalent air gaps (m)."""


class Read(NamedTuple):
    """Full slip of a closure by one reading of the voltage."""

    words: str
    reading: str
    states: Mapping[str, Mapping[str, float] | None]
    """By force; None without a number: no equilibrium, or ridges that adhere beyond the table of gaps."""

    @property
    def gaps(self) -> list[str]:
        """Forces at which the air gap is within the published ones."""
        return [f for f, found in self.states.items() if found and GAPS[0] <= found["d_eq"] <= GAPS[1]]

    @property
    def friction(self) -> bool:
        """Whether µ_app is the paper's, at the paper's force."""
        found = self.states[LOAD]
        return found is not None and abs(found["mu_app"] / PAPER - 1) <= NEAR

    def cells(self) -> str:
        """Return µ_app at the forces, and pressure, air gap and area in contact at the paper's, as cells."""
        bound = ("≤ " if found and found["balanced"] >= BALANCED else "" for found in self.states.values())
        mu = (f"{found['mu_app']:.2f}" if found else "" for found in self.states.values())
        at = self.states[LOAD]
        rest = at and [f"{at['p_c'] * 1e-3:.0f}", f"{at['d_eq'] * 1e6:.2f}", f"{100 * at['area']:.0f}"]
        return harness.cells(*(f"{a}{b}" or "adheres" for a, b in zip(bound, mu, strict=True)), *(rest or 3 * [None]))


def read(numbers: Mapping[str, Any]) -> list[Read]:
    """Return the states by closures and readings."""
    return [
        Read(words, reading, {f: None if found is None or found["beyond"] else found for f, found in states.items()})
        for words, row in numbers["read"].items()
        for reading, states in row.items()
    ]


def span(states: Sequence[Read], reading: str) -> dict[str, Any]:
    """Return least and largest µ_app by one reading at the paper's force, and how many closures have no number."""
    found = [each.states[LOAD] for each in states if each.reading == reading]
    values = [each["mu_app"] for each in found if each]
    return {"low": min(values), "high": max(values), "none": len(found) - len(values), "of": len(found)}
