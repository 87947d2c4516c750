"""``fingerpad estimate``: friction over force and voltage by the closed form, without finite elements."""

from collections.abc import Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

from fingerpad.cli import output
from fingerpad.cli.arguments import Parser, echo, scene_of, several
from fingerpad.model.cautions import on_states
from fingerpad.reduced import cylinder_errors, cylinders
from fingerpad.results.quantities import FINGER, PER_LENGTH, QUANTITIES
from fingerpad.results.result import Result
from fingerpad.runs.context import RunContext
from fingerpad.runs.drive import drive
from fingerpad.runs.solve import solved
from fingerpad.scene import Scene
from fingerpad.scene.messages import SceneError
from fingerpad.scene.remarks import LEAKAGE, coefficient, remarks, used
from fingerpad.slices import errors

_SECTION = ("f_ext", "voltage", "mu_app", "f_t", "f_electrostatic", "contact_length", "ridges_in_contact")
_COLUMNS = tuple(QUANTITIES[key] for key in _SECTION)
_WHOLE = ("mu_app", "f_t", "f_electrostatic", "contact_area", "gross_area")
_NEWTONS = (
    replace(FINGER["f_ext"], name="force"),
    QUANTITIES["voltage"],
    *(FINGER[key] for key in _WHOLE),
    replace(QUANTITIES["f_ext"], words="f_ext of section"),
    replace(QUANTITIES["mu_app"], name="mu_app_of_section", words="µ_app of section"),
)
_EXAMPLES = """
    fingerpad estimate --force "0.1, 0.3, 0.5 N" --voltage 0,100,200
    fingerpad estimate --f-ext 20:75:3 --voltage 0:200:41 --plot mu.png
    fingerpad estimate --set friction=0.3 --f-ext 50 --voltage 0,100,200 --csv mu.csv
"""


def main(argv: Sequence[str]) -> int:
    """Estimate friction over a grid; return the exit code."""
    parser = Parser("estimate", _EXAMPLES)
    parser.add_scene()
    parser.add_ranges("force", "f_ext", "voltage")
    output.add_files(parser, _COLUMNS, "picture: one curve a force")
    args = parser.read(argv)
    if args.force is not None and args.f_ext is not None:
        raise SceneError("--force is given and --f-ext too; give newtons on the whole finger or N/m at its centre")
    scene = scene_of(args, meshed=False)
    cylinders.Cylinders().check(scene)
    key = "force" if args.force is not None or (scene.force is not None and args.f_ext is None) else "f_ext"
    forces = several(args, scene, key)
    over = scene.supply is not None and args.voltage is None
    voltages = [scene.volts] if over else several(args, scene, "voltage")
    rows, lost = grid(scene, forces, voltages, key)
    columns = _COLUMNS if key == "f_ext" else _NEWTONS
    of = "Friction" if key == "f_ext" else "Friction of the whole finger"
    echo(f"{of} at full slip by a closed form, every ridge in contact the same charged cylinder.")
    mu_0 = coefficient(scene)
    echo(f"Friction coefficient {mu_0:g}.\n" if mu_0 is not None else f"Friction {used(scene)['friction']}.\n")
    echo(output.text(columns, rows))
    if key == "f_ext":
        echo("\nµ_app is friction over force, at full slip; L_R is the length of skin on the screen.")
    else:
        echo("\nµ_app is friction over force of the whole finger, at full slip; the last two columns are of the")
        echo("section at the centre of the finger.")
    states = [row["state"] for row in rows if "state" in row]
    limits = (f"{text[0].upper()}{text[1:]}." for text in on_states(states, scene.closure()))
    if over:
        for force in forces:
            echo(f"\nAt {force:g} {'N' if key == 'force' else 'N/m'}. {drive(scene.replace(**{key: force}))}")
    said = (*([LEAKAGE] if any(voltages) and not over else []), *(f"{text}." for text in remarks(scene)), *limits)
    notes = [PER_LENGTH] if key == "f_ext" else errors.remarks(forces)
    for note in (*notes, *_known(scene, rows), *said, *lost):
        echo(note)
    output.write_files(args, columns, rows, draw)
    return 0


def grid(
    scene: Scene, forces: Sequence[float], voltages: Sequence[float], key: str = "f_ext"
) -> tuple[list[dict[str, Any]], list[str]]:
    """Return a row for each force and voltage, and a message for each point that was refused.

    Args:
        scene: of all points.
        forces: N/m, or N on the whole finger.
        voltages: (V).
        key: of the forces, ``f_ext`` or ``force``.

    Raises:
        SceneError: every point is refused.
    """
    rows, lost, model, unit = [], [], cylinders.Cylinders(), "N/m" if key == "f_ext" else "N"
    for force in forces:
        for voltage in voltages:
            row: dict[str, Any] = {key: force, "voltage": voltage}
            asked = (
                {key: force}
                if scene.supply is not None and voltage == scene.volts
                else {key: force, "voltage": voltage}
            )
            try:
                found = solved(scene.replace(**asked), model, RunContext())
                row |= _row(found)
            except SceneError as error:
                lost.append(f"At {force:g} {unit} and {voltage:g} V: {error}.")
            rows.append(row)
    if len(lost) == len(rows):
        raise SceneError(lost[0].partition(": ")[2].rstrip("."))
    return rows, lost


def _row(found: Result) -> dict[str, Any]:
    """Return what the columns show of a result."""
    slip, finger = found.full_slip, found.finger
    if finger is None or not found.whole:
        return {key: getattr(slip, key) for key in _SECTION} | {"state": slip}
    total = finger.values(list(finger.states)[-1])
    values = {key: total[key] for key in _WHOLE if key in total}
    section = slip or found.charged
    assert section is not None
    return values | {"f_ext": section.f_ext, "mu_app_of_section": section.mu_app, "state": section}


def _known(scene: Scene, rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return what is known of the error of these rows."""
    bands = cylinder_errors.KNOWN_ERROR["full_slip"]
    mu, length, pull = (f"within {100 * bands[key]:.1f} %" for key in ("mu_app", "contact_length", "f_electrostatic"))
    runs = f"{cylinder_errors.KNOWN_RUNS} full runs at {cylinder_errors.where()}"
    of = "" if "force" not in rows[0] else " of the section"
    said = [f"Known error{of}: µ_app and f_T {mu}, f_el {pull}, L_R {length} of {runs}."]
    beyond = sum(cylinder_errors.outside(row["f_ext"], row["voltage"]) for row in rows if "f_ext" in row)
    if beyond:
        said.append(f"{beyond} of {len(rows)} points are outside of that; their error is not known.")
    if keys := cylinder_errors.changed(scene):
        said.append(f"Those runs have the default {', '.join(keys)}; here the error is not known.")
    return said


def draw(file: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Draw friction over voltage, one curve a force; over force where there is one voltage."""
    key = "force" if "force" in rows[0] else "f_ext"
    forces, voltages = (list(dict.fromkeys(row[each] for row in rows)) for each in (key, "voltage"))
    over, each = ("voltage", key) if len(voltages) > 1 or len(forces) == 1 else (key, "voltage")
    label = {"voltage": "{:g} V", "f_ext": "{:g} N/m", "force": "{:g} N"}
    axis = {
        "voltage": "voltage U (V)",
        "f_ext": "normal force per length $f_{ext}$ (N/m)",
        "force": "force on the whole finger $F_{ext}$ (N)",
    }
    of = " of the whole finger" if key == "force" else ""
    with output.panels(file, f"Friction{of} at full slip, closed form") as (_, (ax,)):
        from fingerpad.results import style

        for k, value in enumerate(voltages if each == "voltage" else forces):
            points = [row for row in rows if row[each] == value and "mu_app" in row]
            colour = style.voltage(value, max(voltages, key=abs)) if each == "voltage" else None
            x, mu = ([point[key] for point in points] for key in (over, "mu_app"))
            output.curve(ax, k, x, mu, label[each].format(value), colour)
        ax.set(xlabel=axis[over], ylabel=r"apparent friction coefficient $\mu_{app}$ (–)")
        ax.legend(title={"f_ext": "$f_{ext}$", "force": "$F_{ext}$", "voltage": "U"}[each])
