"""``fingerpad estimate``: friction over force and voltage by the closed form, without finite elements."""

import itertools
import math
from collections import Counter
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import Any

from fingerpad.cli import output
from fingerpad.cli.arguments import Parser, echo, scene_of, several
from fingerpad.model import breakdown
from fingerpad.model.cautions import on_states
from fingerpad.reduced import cylinder_errors, cylinders
from fingerpad.results.quantities import FINGER, FRICTION, PER_LENGTH, QUANTITIES, Output, plus_minus_of
from fingerpad.results.result import Number, Result
from fingerpad.results.terminal import watched
from fingerpad.runs.axis import refuse_many
from fingerpad.runs.batch import progress
from fingerpad.runs.closed_form import ClosedForm
from fingerpad.runs.drive import drive
from fingerpad.scene import Scene
from fingerpad.scene.messages import SceneError
from fingerpad.scene.remarks import LEAKAGE, coefficient, remarks, used
from fingerpad.slices import errors
from fingerpad.slices.traces import NO_NEWTONS

_WHOLE = ("mu_app", "f_t", "f_electrostatic", "contact_area", "gross_area")
_SECTION = ("f_ext", "mu_app", "f_t", "f_electrostatic", "contact_length", "ridges_in_contact")


def _of_section(key: str) -> Output:
    quantity = QUANTITIES[key]
    return replace(quantity, name=f"{key}_of_section", words=f"{quantity.symbol} of section")


_OF_SECTION = {key: _of_section(key) for key in _SECTION}
_ERROR = "_error"


_GIVEN = ("voltage", _OF_SECTION["f_ext"].name, _OF_SECTION["ridges_in_contact"].name)  # without an error


def _with_error(quantity: Output) -> tuple[Output, ...]:
    error = replace(quantity, name=quantity.name + _ERROR, words=f"± {quantity.symbol}")
    return (quantity,) if quantity.name in _GIVEN else (quantity, error)


_QUANTITIES = (*(FINGER[key] for key in _WHOLE), *_OF_SECTION.values())
_COLUMNS = (replace(FINGER["f_ext"], name="force"), QUANTITIES["voltage"],
            *(each for one in _QUANTITIES for each in _with_error(one)))  # fmt: skip
_OF_FILES = ("f_t_of_section", "f_electrostatic_of_section", "ridges_in_contact_of_section")
_SHOWN = tuple(each for each in _COLUMNS if each.name not in _OF_FILES and not each.name.endswith(_ERROR))
_NAME = {"force": "force", "f_ext": "f_ext_of_section"}
"""Columns of the keys of forces."""
_EXAMPLES = """
    fingerpad estimate --force "0.1, 0.3, 0.5 N" --voltage 0,100,200
    fingerpad estimate --force "0.5 N" --voltage 0:200:41 --plot mu.png
    fingerpad estimate --over voltage --over electric.d_i --target mu_app=2x --plot map.png --csv map.csv
    fingerpad estimate --set friction=0.3 --f-ext 50 --voltage 0,100,200 --csv mu.csv
"""


def main(argv: Sequence[str]) -> int:
    """Estimate friction over a grid; return the exit code."""
    parser = Parser("estimate", _EXAMPLES)
    parser.add_scene()
    parser.add_ranges("force", "f_ext", "voltage")
    words = "a key of a heat map, given for two keys; its range as in --over voltage=0:400:11 may be left out"
    parser.add_argument("--over", action="append", default=[], metavar="KEY[=RANGE]", help=words)
    words = "line of the heat map, as mu_app=2x (twice the value without voltage), 'F_T=0.3 N', 'contrast=10 %%'"
    parser.add_argument("--target", metavar="QUANTITY=VALUE", help=words)
    mapped = any(word.partition("=")[0] == "--over" for word in argv)
    columns = (output.ERROR_KNOWN,) if mapped else _COLUMNS
    output.add_files(parser, columns, "picture: one curve a force, or the heat map", more=mapped)
    args = parser.read(argv)
    if args.force is not None and args.f_ext is not None:
        raise SceneError("--force is given and --f-ext too; give newtons on the whole finger or N/m at its centre")
    scene = scene_of(args, meshed=False)
    cylinders.Cylinders().check(scene)
    if args.over:
        from fingerpad.cli import estimate_map

        return estimate_map.main(args, scene)
    if args.target is not None:
        raise SceneError("--target is given without --over; a map draws it, and fingerpad solve finds its value")
    key = "force" if args.force is not None or (scene.force is not None and args.f_ext is None) else "f_ext"
    forces = several(args, scene, key)
    over = scene.supply is not None and args.voltage is None
    voltages = [scene.volts] if over else several(args, scene, "voltage")
    rows, lost = grid(scene, forces, voltages, key)
    most = scene if over else scene.replace(voltage=max(voltages, key=abs))
    whole = any("mu_app" in row for row in rows)
    echo("Friction of the whole finger" if whole else "Friction of the section", end="")
    echo(" at full slip by a closed form, every ridge in contact the same charged cylinder.")
    mu_0 = coefficient(scene)
    echo(f"Friction coefficient {mu_0:g}.\n" if mu_0 is not None else f"Friction {used(scene)['friction']}.\n")
    echo(output.text(_SHOWN, [row | _shown(row) for row in rows]))
    echo("\nµ_app is friction over force, at full slip: first of the whole finger, as a sum of slices, then of the")
    echo("section at its centre. L_R is the length of skin on the screen.")
    if key == "f_ext":
        echo("F_ext has that f_ext at the finger's centre at full slip, as in fingerpad run --model cylinders. The")
        echo("full model has indentations of its own, and so another F_ext.")
    states = [row["state"] for row in rows if "state" in row]
    found = (*on_states(states, scene.closure()), *breakdown.ahead(most))
    limits = (f"{text[0].upper()}{text[1:]}." for text in found)
    if over:
        for force in forces:
            echo(f"\nAt {force:g} {'N' if key == 'force' else 'N/m'}. {drive(scene.replace(**{key: force}))}")
    said = (*([LEAKAGE] if any(voltages) and not over else []), *(f"{text}." for text in remarks(scene)), *limits)
    notes = errors.remarks([row["force"] for row in rows if "force" in row])
    notes = [PER_LENGTH, *notes] if key == "f_ext" else notes
    for note in (*notes, *_known(rows), *said, *lost):
        echo(note)
    output.write_files(args, _COLUMNS, rows, partial(draw, key))
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
    rows, lost, form, unit = [], [], ClosedForm(cylinders.Cylinders()), "N/m" if key == "f_ext" else "N"
    scene = scene.resolved()
    refuse_many(len(forces) * len(voltages), "table")
    with progress(not watched()) as bar:
        for force, voltage in bar.track([*itertools.product(forces, voltages)], description="points"):
            changed = {} if scene.supply is not None and voltage == scene.volts else {"voltage": voltage}
            row: dict[str, Any] = {_NAME[key]: force, "voltage": voltage}
            try:
                given: dict[str, Any] = {"force": force} if key == "force" else {"force": None, "f_ext": force}
                row = _row(found := form.result(scene.replace(**given, **changed))) | row
                at = f"At {force:g} {unit} there is no whole finger: "
                lost += [at + note.partition(": ")[2] + "." for note in found.notes if note.startswith(NO_NEWTONS)]
            except SceneError as error:
                lost.append(f"At {force:g} {unit} and {voltage:g} V: {error}.")
            rows.append(row)
    if not any("state" in row for row in rows):
        beyond = breakdown.ahead(scene if scene.supply is not None else scene.replace(voltage=max(voltages, key=abs)))
        raise SceneError("; ".join([*beyond, lost[-1].partition(": ")[2].rstrip(".")]))
    return rows, list(dict.fromkeys(lost))


def _row(found: Result) -> dict[str, Any]:
    """Return what the columns show of a result: of the whole finger where it has one, and of its section."""
    state = "charged" if found.full_slip is None else "full_slip"
    values: dict[str, Any] = {"state": found.named[state]}
    for key, column in _OF_SECTION.items():
        values |= {column.name: getattr(found.named[state], key)} if column.name in _GIVEN else {}
        values |= _numbers(column.name, found.number(state, key)) if column.name not in _GIVEN else {}
    parts = found.parts()
    if found.finger is not None:
        last, values["force"] = list(found.finger.states)[-1], found.finger.f_ext
        for key in _WHOLE:
            values |= _numbers(key, found.number(last, key, whole=True)) if key not in FRICTION or last == state else {}
        parts = (*found.finger.parts(last), *parts)
    force, pull = found.named[state].f_ext, found.named[state].f_electrostatic
    if found.scene.force is not None and found.finger is not None:
        force, pull = found.finger.f_ext, values["f_electrostatic"]
    outside = cylinder_errors.in_short(cylinder_errors.outside(found.scene, pull / force))
    return values | {"outside": outside, "parts": parts}


def _numbers(name: str, number: Number) -> dict[str, float]:
    """Return a value, and its error where that is known, by column."""
    known = {} if math.isnan(number.error) else {name + _ERROR: number.error}
    return {name: number.value} | known


def _shown(row: Mapping[str, Any]) -> dict[str, str]:
    """Return the values of a row that have an error with it, as they are printed."""
    columns = {column.name: column for column in _COLUMNS}
    names = [name.removesuffix(_ERROR) for name in row if name.endswith(_ERROR)]
    return {name: columns[name].shown(row[name], row[name + _ERROR]) for name in names if name in row}


def _known(rows: Sequence[Mapping[str, Any]]) -> list[str]:
    """Return what the errors of these rows are of, and for which keys they are not known."""
    said = [plus_minus_of(part for row in rows for part in row.get("parts", ()))] if _has_errors(rows) else []
    beyond = Counter(each._replace(value="") for row in rows for each in row.get("outside", []))
    for each, count in beyond.items():
        points = f"At {count} of {len(rows)} points" if count < len(rows) else "Here"
        said.append(f"{points} the error is not known; it is known for {each.key} {each.known}.")
    return said


def _has_errors(rows: Sequence[Mapping[str, Any]]) -> bool:
    return any(name.endswith(_ERROR) for row in rows for name in row)


def draw(key: str, file: Path, rows: Sequence[Mapping[str, Any]]) -> None:
    """Draw friction over voltage, one curve a force; over force where there is one voltage.

    Args:
        key: of the forces, ``f_ext`` or ``force``.
        file: picture.
        rows: of :func:`grid`.
    """
    name, whole = _NAME[key], any("mu_app" in row for row in rows)
    mu_app = "mu_app" if whole else "mu_app_of_section"
    forces, voltages = (list(dict.fromkeys(row[each] for row in rows)) for each in (name, "voltage"))
    over, each = ("voltage", name) if len(voltages) > 1 or len(forces) == 1 else (name, "voltage")
    label = {"voltage": "{:g} V", name: "{:g} N/m" if key == "f_ext" else "{:g} N"}
    axis = {
        "voltage": "voltage U (V)",
        "f_ext_of_section": "normal force per length at the centre $f_{ext}$ (N/m)",
        "force": "force on the whole finger $F_{ext}$ (N)",
    }
    of = "whole finger" if whole else "section"
    with output.panels(file, f"Friction of the {of} at full slip, closed form") as (_, (ax,)):
        from fingerpad.results import style

        for k, value in enumerate(voltages if each == "voltage" else forces):
            points = [row for row in rows if row[each] == value and mu_app in row]
            colour = style.voltage(value, max(voltages, key=abs)) if each == "voltage" else None
            x, mu, error = ([point.get(key, 0.0) for point in points] for key in (over, mu_app, mu_app + _ERROR))
            output.curve(ax, k, x, mu, label[each].format(value), colour, error)
        ax.set(xlabel=axis[over], ylabel=r"apparent friction coefficient $\mu_{app}$ (–)")
        title = {"f_ext_of_section": "$f_{ext}$", "force": "$F_{ext}$", "voltage": "U"}[each]
        ax.legend(title=f"{title}; band: ± error" if _has_errors(rows) else title)
