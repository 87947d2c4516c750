"""``fingerpad microscale``: air gap, attraction and real area of contact of a rough ridge over its pressure."""

from argparse import ArgumentTypeError
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from fingerpad.cli import ranges, tables
from fingerpad.cli.arguments import Parser, echo, quantity, scene_of, several
from fingerpad.model.cautions import on_closure
from fingerpad.results.quantities import QUANTITIES, Output
from fingerpad.scene import Scene
from fingerpad.scene.messages import SceneError
from fingerpad.scene.remarks import remarks
from variational.roughness.bam import STICKING, BearingArea

_PRESSURES = "1e3:1e6:13:log"
_COLUMNS = (
    QUANTITIES["voltage"],
    Output("p_c", "kPa", words="pressure", digits=2),
    Output("u_bar", "µm", words="separation"),
    Output("d_eq", "µm", words="air gap"),
    Output("p_el", "kPa", words="attraction"),
    Output("p_ext", "kPa", words="external"),
    Output("area", "%", words="real area"),
)
_EXAMPLES = """
    fingerpad microscale --voltage 100,200 --p 1e3:1e6:50:log --plot micro.png
    fingerpad microscale --set roughness.h_rms=2e-6 --csv micro.csv
"""


def main(argv: Sequence[str]) -> int:
    """Print the microscale over pressure; return the exit code."""
    parser = Parser("microscale", _EXAMPLES)
    parser.add_scene()
    parser.add_ranges("voltage")
    parser.add_argument("--p", metavar="RANGE", default=_PRESSURES, help=f"pressures (Pa); default {_PRESSURES}")
    tables.add_files(parser, _COLUMNS, "picture")
    args = parser.read(argv)
    scene = scene_of(args, meshed=False)
    if args.voltage is None and scene.history is not None:
        raise SceneError("history is given, whose loads have their own voltages; name those wanted by --voltage")
    rows = table(scene, several(args, scene, "voltage"), _pressures(args.p))
    closure = bearing_area(scene)
    echo(
        f"A ridge of rms roughness {closure.h_rms * 1e6:.3g} µm, largest wavelength "
        f"{closure.wavelength * 1e6:.3g} µm; insulators: h_0 = {scene.h_0 * 1e6:.3g} µm.\n"
    )
    echo(tables.text(_COLUMNS, rows))
    echo("\npressure: mean contact pressure of the ridge; external: that less the attraction, what the finger presses")
    echo("with; separation: mean, of skin and screen; air gap: equivalent one; real area: of the nominal area.")
    echo(f"The air gap stays constant below {closure.p_floor * 1e-3:g} kPa (roughness.p_floor) and above")
    echo(f"{closure.full_pressure * 1e-3:.4g} kPa, the pressure at zero separation.")
    echo(_sticking(closure))
    for text in remarks(scene):
        echo(f"{text}.")
    for text in on_closure(closure, [(row["p_c"], 1.0, row["voltage"]) for row in rows], "pressures and voltages"):
        echo(f"{text[0].upper()}{text[1:]}.")
    tables.write_files(args, _COLUMNS, rows, draw)
    return 0


def _pressures(text: str) -> list[float]:
    try:
        return [quantity(str(value), "Pa") for value in ranges.read("--p", text)]
    except ArgumentTypeError as error:
        raise SceneError(f"--p: {error}") from None


def _sticking(closure: BearingArea) -> str:
    """Return from which voltage on a ridge sticks, in a sentence."""
    voltage = closure.sticking_voltage()
    if voltage is None:
        return "The insulators are thick for this roughness: the model has no voltage from which a ridge would stick."
    stress = f"{STICKING * 1e-3:g} kPa"
    return f"From {voltage:.3g} V a ridge would stick: to pull it off takes {stress} or more (a convention)."


def bearing_area(scene: Scene) -> BearingArea:
    """Return the closure of a scene.

    Raises:
        SceneError: it is another model than the bearing area's, which alone has a separation and a real area.
    """
    closure = scene.closure()
    if not isinstance(closure, BearingArea):
        raise SceneError(f"roughness is a {type(closure).__name__}; the microscale is that of the law 'BearingArea'")
    return closure


def table(scene: Scene, voltages: Sequence[float], pressures: Sequence[float]) -> list[dict[str, Any]]:
    """Return a row for each voltage (V) and mean contact pressure (Pa), in SI units.

    Pressures beyond the one at zero mean separation, where the law of repulsion ends, are held there as in a run.
    """
    closure = bearing_area(scene)
    p_c = np.array(pressures)
    u_bar = closure.separation(np.clip(p_c, closure.p_floor, closure.full_pressure)) + 0.0  # no negative zero
    d_eq, area = closure(p_c).d_eq, closure.contact_area(u_bar)
    rows = []
    for voltage in voltages:
        p_el = closure.attraction(u_bar, voltage)
        for k, p in enumerate(pressures):
            row = {"p_c": p, "u_bar": u_bar[k], "d_eq": d_eq[k], "p_el": p_el[k], "p_ext": p - p_el[k]}
            rows.append({"voltage": voltage} | {name: float(v) for name, v in row.items()} | {"area": float(area[k])})
    return rows


def draw(file: Path, rows: Sequence[dict[str, Any]]) -> None:
    """Draw lengths, attraction and real area over pressure."""
    from fingerpad.cli import plot
    from fingerpad.results import style

    voltages = list(dict.fromkeys(row["voltage"] for row in rows))
    first = [row for row in rows if row["voltage"] == voltages[0]]
    p = [row["p_c"] * 1e-3 for row in first]
    with plot.panels(file, "Microscale of a ridge: bearing area model", 3) as (_, (gaps, stress, area)):
        plot.curve(gaps, 0, p, [row["d_eq"] * 1e6 for row in first], "equivalent air gap $d_{eq}$")
        plot.curve(gaps, 1, p, [row["u_bar"] * 1e6 for row in first], r"mean separation $\bar u$")
        gaps.set(ylabel="length (µm)", ylim=(0, None))
        for k, voltage in enumerate(voltages):
            found = [row["p_el"] * 1e-3 for row in rows if row["voltage"] == voltage]
            plot.curve(stress, k, p, found, f"{voltage:g} V", style.voltage(voltage, max(voltages, key=abs)))
        stress.set(ylabel="attraction $p_{el}$ (kPa)", ylim=(0, None))
        plot.curve(area, 0, p, [100 * row["area"] for row in first], "")
        area.set(ylabel="real area of contact (% of the nominal)", yscale="log")
        for ax in (gaps, stress, area):
            ax.set(xlabel="mean contact pressure $p_c$ (kPa)", xscale="log")
        for ax in (gaps, stress):
            ax.legend()
