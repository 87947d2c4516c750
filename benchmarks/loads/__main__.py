"""How far the closed form of charged cylinders holds: seeded scenes over the loads of people, beside the full model.

environment/run python3 -m benchmarks.loads [--minutes 20] [--draw]     one process; the same command goes on later

A scene is a force on the finger, a voltage, a friction coefficient and a coating: a point of a scrambled Sobol
sequence in these five keys. Its full slip is followed over growing forces of the section, up to that at the centre of
the finger. So a scene has errors of the section at several forces, and one of the sum over slices. States are solved
for from neighbours, without a path. Writes docs/loads.json, docs/closed_form.md, its picture, and the known errors into
fingerpad/reduced/cylinder_errors.json; prints the contact lengths that fingerpad/reduced/presses.json has of them,
and the number of shear of fingerpad/reduced/cylinders.py.
"""

import argparse
import json
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.figure import Figure

from benchmarks import harness
from benchmarks.loads import fresh
from benchmarks.loads.compared import (
    BANDS,
    PULLED,
    Band,
    Compared,
    Level,
    both,
    covered,
    fingers,
    fits,
    levels,
    regions,
    sections,
)
from benchmarks.loads.meshes import errors, without
from benchmarks.loads.scenes import COUNT, MESHES, Data, scenes, section
from benchmarks.loads.shear import fitted, points
from benchmarks.loads.states import by_scene, pressed, short, solved
from fingerpad.reduced import press
from fingerpad.reduced.cylinder_errors import REGIONS, WHOLE, find
from fingerpad.reduced.cylinders import SHEAR
from fingerpad.results.files import replace
from fingerpad.scene import Scene

REGIONS_FILE = harness.ROOT / "fingerpad" / "reduced" / "cylinder_errors.json"
_MINUTES = 20.0
_LAST = 150.0  # N/m, largest force of a full run in the tables of fingerpad/reduced


def compute(args: argparse.Namespace) -> None:
    """Solve for what is missing, and keep the numbers."""
    folder = args.out / "loads"
    states, far = solved(folder, args.minutes), _pressed(folder)
    kept = by_scene(scenes(), states)
    checked = [short(each) for which in range(len(MESHES)) for each in states[f"mesh {which}"]]
    slipped = [short(each) for each in states["far"]]
    numbers = {"scenes": kept, "mesh": checked, "far": {"full_slip": slipped, "charged": far}, "count": COUNT}
    harness.keep("loads", numbers, harness.made(), args.docs)
    better = without(kept, errors(checked, harness.kept("models", args.docs).numbers["scenes"]))
    found = regions(levels(sections(better), fingers(better)))
    replace(REGIONS_FILE, json.dumps(found, indent=1) + "\n")
    print(f"{in_the_program(numbers)}\nSHEAR {fitted(points(better)):.2f}")


def _pressed(folder: Path) -> list[Data]:
    """Return the states of :func:`pressed`, kept in a file in the folder."""
    file = folder / "pressed.json"
    if not file.exists():
        replace(file, json.dumps([short(each) for each in pressed()]) + "\n")
    found: list[Data] = json.loads(file.read_text(encoding="utf-8"))
    return found


# -- numbers -------------------------------------------------------------------------------------------------
def far(numbers: Mapping[str, Any]) -> dict[str, dict[str, list[float]]]:
    """Return contact lengths and indentations (m) beyond :data:`_LAST` by state, as the tables continue there.

    They are the tables' last value of a full run, times the ratio of states on the coarser mesh.
    """
    found: dict[str, dict[str, list[float]]] = {}
    own = press.of(Scene())
    k = own.forces.index(_LAST)
    for state, lengths in own.lengths.items():
        first, *others = numbers["far"][state]
        found[state] = {
            "lengths": [lengths[k] * each["contact_length"] / first["contact_length"] for each in others],
            "indentations": [
                own.indentations[state][k] * each["bone_height"] / first["bone_height"] for each in others
            ],
            "ridges": [each["ridges_in_contact"] for each in others],
        }
    return found


def in_the_program(numbers: Mapping[str, Any]) -> str:
    """Return what the default finger's press has of kept numbers."""
    lines = []
    for state, each in far(numbers).items():
        for key in ("lengths", "indentations"):
            lines += [f"{key.upper()} {state}: {', '.join(f'{1e3 * value:.4f}e-3' for value in each[key])}"]
        lines += [f"RIDGES {state}: {', '.join(map(str, each['ridges']))}"]
    return "\n".join(lines)


# -- page ----------------------------------------------------------------------------------------------------
def spread(compared: Sequence[Compared]) -> list[float]:
    """Return in per cent: mean, rms, 90 % and worst error of the attraction, and the worst of friction."""
    errors = np.array([each.error for each in compared])
    parts = [errors.mean(), np.sqrt((errors**2).mean()), np.quantile(abs(errors), 0.9), abs(errors).max()]
    return [100 * float(each) for each in (*parts, max(abs(each.of_friction) for each in compared))]


def draw(docs: Path) -> Path:
    """Draw the page and its picture from the kept numbers."""
    numbers, drawn = harness.kept("loads", docs).numbers, harness.kept("fresh", docs).numbers
    mesh = errors(numbers["mesh"], harness.kept("models", docs).numbers["scenes"])
    better = without(numbers["scenes"], mesh)
    compared, whole = sections(better), fingers(better)
    every, both_have = both(compared), points(better)
    beyond = [each for each in every if not find(section(each.values, each.force), each.attraction / each.force)]
    states = [state for each in numbers["scenes"] for state in each["states"]]
    harness.picture(docs / "loads.png", (9.5, 4.2), lambda figure: _paint(figure, every))
    names = {
        "every": every, "beyond": beyond, "states": states,
        "regions": (rows := [*judged_levels(levels(compared, whole))]),
        "known_all": [each.error for each in rows if each.error is not None],
        "near": [each.error for each in rows if each.error is not None and each.pull == PULLED[0]],
        "known_friction": Scene().friction, "kappa": fitted(both_have), "SHEAR": SHEAR,
        "fresh": {key: fresh.beside(drawn["scenes"], key, mesh) for key in ("mu_app", "contact_length")},
        "known": [REGIONS[0].errors[key]["f_electrostatic"] for key in ("full_slip", WHOLE)],
        "lost": [each for each in states if "failure" in each],
    }  # fmt: skip
    return harness.page(docs, "loads", "python3 -m benchmarks.loads", globals() | names, "models", "fresh")


class Judged(NamedTuple):
    """A band of the friction coefficient on the page."""

    friction: str
    pull: float
    """Of :data:`benchmarks.loads.compared.PULLED`: that of its level."""
    limits: tuple[float, ...]
    """Largest force of a section (N/m), voltage (V) and attraction over force."""
    made: int
    """States that make an error."""
    error: float | None
    """Of the attraction (%); None where there are too few."""
    tests: int
    inside: int | None
    """Of the states that test the error."""
    without: int
    """States that the full model did not reach."""
    of_finger: float | None
    """Error of the attraction of a finger (%)."""
    fingers: int
    """Fingers that test it."""
    fingers_inside: int | None


def judged_levels(every: Sequence[Level]) -> Iterator[Judged]:
    """Yield the bands of the first level, and those of the others that have a region of their own."""
    for level in every:
        for k, (band, region) in enumerate(zip(level.bands, level.regions, strict=True)):
            if level is every[0] or region is not None:
                yield judged(band, region, f"{BANDS[k]:g} to {BANDS[k + 1]:g}", level.pull)


def judged(band: Band, region: Mapping[str, Any] | None, words: str, pull: float) -> Judged:
    """Return what the page has of a band and its region."""
    tests = [each for each in band.whole if not fits(each)]
    places = [(each.force, each.values["voltage"], each.attraction / each.force) for each in band.some]
    limits = tuple(max(values) for values in zip(*places, strict=True))
    numbers = len(band.made), len(band.tests), len(band.without), len(tests)
    if region is None:
        return Judged(words, pull, limits, numbers[0], None, numbers[1], None, numbers[2], None, numbers[3], None)
    errors = [region["errors"][state]["f_electrostatic"] for state in ("full_slip", WHOLE)]
    inside = [covered(some, error) for some, error in zip((band.tests, tests), errors, strict=True)]
    return Judged(words, pull, limits, numbers[0], 100 * errors[0], numbers[1], inside[0], numbers[2], 100 * errors[1],
                  numbers[3], inside[1])  # fmt: skip


def _paint(figure: Figure, every: Sequence[Compared]) -> None:
    """Paint the errors of friction over the share of the attraction, and those of the attraction over friction."""
    panels = figure.subplots(1, 2)
    for test, marker in ((False, "o"), (True, "s")):
        some = [each for each in every if fits(each) != test]
        colours = [each.values["friction"] for each in some]
        friction = [each.values["friction"] * (each.force + each.attraction) for each in some]
        shares = [each.share for each in some], [100 * each.of_friction for each in some]
        places = [shares, (friction, [100 * each.error for each in some])]
        for ax, (x, y) in zip(panels, places, strict=True):
            shown = ax.scatter(x, y, s=28, marker=marker, c=colours, cmap="viridis", vmin=0.1, vmax=1.0)
    panels[0].set(
        xlabel="share of the attraction in the contact force (–)", ylabel="full model's µ_app, difference (%)"
    )
    panels[1].set(xlabel="friction force $f_T$ (N/m)", ylabel="full model's attraction, difference (%)", xscale="log")
    figure.colorbar(shown, ax=panels[1], label="friction coefficient µ_0 (–)")
    for letter, ax in zip("AB", panels, strict=True):
        ax.axhline(0, color="black", lw=0.8)
        ax.set_title(letter, loc="left", fontweight="bold")


if __name__ == "__main__":
    minutes = {"type": float, "default": _MINUTES, "help": "processor time after which no scene is begun"}
    harness.main(__doc__, compute, draw, out="", minutes=minutes)
