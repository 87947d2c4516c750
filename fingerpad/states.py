"""Which accepted states of a history have a name, and what each of its loads came to; plain rows, no dolfinx.

A row is what :class:`fingerpad.simulation.Simulation` reports of an accepted step, as ``steps.csv`` holds it.

* *uncharged*: the last state in contact before a voltage is switched on and before the bone first moves sideways,
* *normal*: normal contact, the last state in contact before the bone first moves sideways with skin on the screen; a
  way through the air before does not count, and a bone that comes back later makes no other one,
* *slip*: full slip. Every point in contact slips one way, and goes on so with the same forces while the bone slides a
  further 0.2 mm. A full slip begins at its first state, and the last one that was held counts.
"""

from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from typing import Any

Row = Mapping[str, Any]

STILL = 1e-12  # m, below which the bone has not moved sideways
SLIDE_ON = 0.2e-3  # m, further sliding that must not change the forces of full slip
STATES = ("uncharged", "normal", "slip")
WORDS = {"uncharged": "uncharged contact", "normal": "normal contact", "slip": "full slip"}
CONDITIONS = ("step", "load", "f_ext", "voltage", "bone_x")
RESULTS = ("f_t", "mu_app", "f_electrostatic", "f_contact", "bone_height", "ridges_in_contact", "contact_length")
_EXTREMES = ("mu_app", "f_t", "contact_length", "f_electrostatic")
_ROUNDOFF = 1e-9  # relative, of a way or a voltage


def before_sliding(rows: Sequence[Row]) -> Sequence[Row]:
    """Return the rows before the bone first moves sideways with skin on the screen."""
    touch = next((k for k, row in enumerate(rows) if row["ridges_in_contact"] > 0), len(rows))
    place = rows[touch - 1]["bone_x"] if touch else 0.0
    moving = (k for k in range(touch, len(rows)) if abs(rows[k]["bone_x"] - place) >= STILL)
    return rows[: next(moving, len(rows))]


def full_slip(rows: Sequence[Row], row: Row, steady: float, least: float) -> tuple[int, bool]:
    """Return the step at which the full slip of a new state began, zero without, and whether it was held since.

    Args:
        rows: the states before it, with ``slip_began`` and ``slip_held``.
        row: the new state.
        steady: relative change of the forces that means nothing.
        least: change of the forces (N/m) that means nothing.
    """
    if not row["all_slip"] or len(before_sliding([*rows, row])) > len(rows):
        return 0, False
    last: Row = rows[-1] if rows else {"slip_began": 0}
    first = next((r for r in reversed(rows) if r["step"] == last["slip_began"]), None)
    if first is None or not unchanged(first, row, steady, least):
        return row["step"], False
    far = abs(row["bone_x"] - first["bone_x"]) >= SLIDE_ON * (1 - _ROUNDOFF)
    return first["step"], bool(last["slip_held"] or far)


def unchanged(first: Row, row: Row, steady: float, least: float) -> bool:
    """Return whether two states have the same voltage and forces; arguments as of :func:`full_slip`."""
    same = abs(row["voltage"] - first["voltage"]) <= _ROUNDOFF * abs(first["voltage"])
    pairs = ((first[name], row[name]) for name in ("f_t", "f_ext"))
    return bool(same and all(abs(b - a) <= steady * abs(a) + least for a, b in pairs))


def named(rows: Sequence[Row]) -> dict[str, Row]:
    """Return the rows of the states of :data:`STATES` that a history has so far, by name."""
    still = [row for row in before_sliding(rows) if row["ridges_in_contact"] > 0]
    uncharged = still[: next((k for k, row in enumerate(still) if row["voltage"] > 0), len(still))]
    held = next((row["slip_began"] for row in reversed(rows) if row["slip_held"]), None)
    found = {"uncharged": uncharged[-1:], "normal": still[-1:], "slip": [r for r in rows if r["step"] == held][:1]}
    return {name: part[0] for name, part in found.items() if len(part)}


def partial_slip(rows: Sequence[Row]) -> Row | None:
    """Return the state nearest to half of the points slipping on the way to the last full slip or to the end, if any.

    States in which every point slips are none.
    """
    found = named(rows)
    last = (found["slip"] if "slip" in found else rows[-1])["step"]
    way = rows[len(before_sliding(rows)) :]
    some = [row for row in way if row["step"] <= last and not row["slip_began"]]
    return min(some, key=lambda row: abs(row["slipping"] - 0.5)) if some else None


def by_load(rows: Sequence[Row]) -> Iterator[tuple[str, list[Row]]]:
    """Yield each load's name and its rows, those of the first touch with the load that it is on the way to."""
    for _, group in groupby(rows, key=lambda row: row["load_number"]):
        mine = list(group)
        yield mine[-1]["load"], mine


def summary(name: str, mine: Sequence[Row], stable: bool | None) -> dict[str, Any]:
    """Return what a load came to, ready for JSON.

    Args:
        name: of the load.
        mine: its rows.
        stable: whether the state at its end is, None where that was not examined.
    """
    end = mine[-1]
    extremes = {}
    for quantity in _EXTREMES:
        least, most = min(mine, key=lambda row: row[quantity]), max(mine, key=lambda row: row[quantity])
        extremes[quantity] = {
            "min": least[quantity],
            "min_step": least["step"],
            "max": most[quantity],
            "max_step": most["step"],
        }
    return {
        "name": name,
        "end": {key: end[key] for key in (*CONDITIONS, *RESULTS) if key != "load"},
        "extremes": extremes,
        "full_slip_reached": any(row["slip_began"] for row in mine),
        "full_slip_held": any(row["slip_held"] for row in mine),
        "stable": stable,
    }
