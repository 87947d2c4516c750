"""``fingerpad estimate``: friction over force and voltage by the closed form, without finite elements."""

from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

from fingerpad.cli import tables
from fingerpad.cli.arguments import Parser, echo, scene_of, several
from fingerpad.io.quantities import PER_LENGTH
from fingerpad.model.cautions import on_states
from fingerpad.reduced import cylinders, known
from fingerpad.scene import Scene, from_data
from fingerpad.scene.messages import SceneError
from fingerpad.scene.remarks import LEAKAGE, remarks

_COLUMNS = (
    tables.Column("f_ext", "force", "N/m"),
    tables.Column("voltage", "voltage", "V"),
    tables.Column("mu_app", "mu_app", digits=".3f"),
    tables.Column("f_t", "friction", "N/m"),
    tables.Column("f_electrostatic", "attraction", "N/m"),
    tables.Column("contact_length", "contact", "mm", 1e3, ".3f"),
    tables.Column("ridges_in_contact", "ridges", digits=".0f"),
)
_EXAMPLES = """
    fingerpad estimate --f-ext 20:75:3 --voltage 0:200:41 --plot mu.png
    fingerpad estimate --set friction=0.3 --f-ext 50 --voltage 0,100,200 --csv mu.csv
"""


def main(argv: Sequence[str]) -> int:
    """Estimate friction over a grid; return the exit code."""
    parser = Parser("estimate", _EXAMPLES)
    parser.add_scene()
    parser.add_ranges("f_ext", "voltage")
    tables.add_files(parser, _COLUMNS, "picture: one curve a force")
    args = parser.read(argv)
    scene = scene_of(args, meshed=False)
    cylinders.Cylinders().check(scene)
    forces, voltages = (several(args, scene, key) for key in ("f_ext", "voltage"))
    rows, lost = grid(scene, forces, voltages)
    echo("Friction at full slip by a closed form, every ridge in contact the same charged cylinder.")
    echo(f"Friction coefficient {scene.friction:g}.\n")
    echo(tables.text(_COLUMNS, rows))
    echo("\nmu_app is friction over force, at full slip; contact is the length of skin on the screen.")
    states = [row["state"] for row in rows if "state" in row]
    limits = (f"{text[0].upper()}{text[1:]}." for text in on_states(states, scene.closure()))
    said = (*([LEAKAGE] if any(voltages) else []), *(f"{text}." for text in remarks(scene)), *limits)
    for note in (PER_LENGTH, *_known(scene, rows), *said, *lost):
        echo(note)
    tables.write_files(args, _COLUMNS, rows, draw)
    return 0


def grid(scene: Scene, forces: Sequence[float], voltages: Sequence[float]) -> tuple[list[dict[str, Any]], list[str]]:
    """Return a row for each force (N/m) and voltage (V), and a message for each point that was refused.

    Raises:
        SceneError: every point is refused.
    """
    rows, lost = [], []
    for f_ext in forces:
        for voltage in voltages:
            row: dict[str, Any] = {"f_ext": f_ext, "voltage": voltage}
            try:
                found = cylinders.solve(from_data(scene.parameters() | {"f_ext": f_ext, "voltage": voltage}))
                row |= {c.key: getattr(found.full_slip, c.key) for c in _COLUMNS if c.key not in row}
                row["state"] = found.full_slip
            except SceneError as error:
                lost.append(f"At {f_ext:g} N/m and {voltage:g} V: {error}.")
            rows.append(row)
    if len(lost) == len(rows):
        raise SceneError(lost[0].partition(": ")[2].rstrip("."))
    return rows, lost


def _known(scene: Scene, rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return what is known of the error of these rows."""
    bands = known.KNOWN_ERROR[cylinders.Cylinders.name]["full_slip"]
    mu, length, pull = (f"within {100 * bands[key]:.1f} %" for key in ("mu_app", "contact_length", "f_electrostatic"))
    runs = f"{known.KNOWN_RUNS} full runs at {known.where()}"
    said = [f"Known error: mu_app and friction {mu}, attraction {pull}, contact {length} of {runs}."]
    beyond = sum(known.outside(row["f_ext"], row["voltage"]) for row in rows)
    if beyond:
        said.append(f"{beyond} of {len(rows)} points are outside of that; their error is not known.")
    if keys := known.changed(scene):
        said.append(f"Those runs have the default {', '.join(keys)}; here the error is not known.")
    return said


def draw(file: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Draw friction over voltage, one curve a force; over force where there is one voltage."""
    from fingerpad.cli import plot
    from fingerpad.io import style

    forces, voltages = (list(dict.fromkeys(row[key] for row in rows)) for key in ("f_ext", "voltage"))
    over, each = ("voltage", "f_ext") if len(voltages) > 1 or len(forces) == 1 else ("f_ext", "voltage")
    label = {"voltage": "{:g} V", "f_ext": "{:g} N/m"}
    axis = {"voltage": "voltage U (V)", "f_ext": "normal force per length $f_{ext}$ (N/m)"}
    with plot.panels(file, "Friction at full slip, closed form") as (_, (ax,)):
        for k, value in enumerate(forces if each == "f_ext" else voltages):
            points = [row for row in rows if row[each] == value and "mu_app" in row]
            colour = style.voltage(value, max(voltages, key=abs)) if each == "voltage" else None
            x, mu = ([point[key] for point in points] for key in (over, "mu_app"))
            plot.curve(ax, k, x, mu, label[each].format(value), colour)
        ax.set(xlabel=axis[over], ylabel=r"apparent friction coefficient $\mu_{app}$ (–)")
        ax.legend(title={"f_ext": "$f_{ext}$", "voltage": "U"}[each])
