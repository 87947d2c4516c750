"""Roughness: ``fingerpad microscale`` of a ridge over pressure, ``fingerpad topography`` of a height map."""

import argparse
import math
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from pydantic import ValidationError

from fingerpad.cli import output
from fingerpad.cli.arguments import Parser, echo, path, quantities, scene_of, several
from fingerpad.model.cautions import examine
from fingerpad.results.quantities import QUANTITIES, Output
from fingerpad.scene import Scene, from_data, override
from fingerpad.scene.materials import CLOSURES, Topography
from fingerpad.scene.messages import SceneError, clip, first_error
from fingerpad.scene.remarks import on_waves
from variational.attraction.electroadhesion import VACUUM_PERMITTIVITY
from variational.roughness.bam import BearingArea
from variational.roughness.closure import STICKING
from variational.roughness.heightfile import Found, scan
from variational.roughness.spectrum import HURST, Fit, power_spectrum, roughness_table
from variational.roughness.tabulated import TabulatedClosure

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
_MICROSCALE = """
    fingerpad microscale --voltage 100,200 --p 1e3:1e6:50:log --plot micro.png
    fingerpad microscale --set roughness.h_rms=2e-6 --csv micro.csv
    fingerpad microscale --set roughness.law=BoundaryElements --voltage 0,100 --p 1e3:5e5:30:log
"""
_TOPOGRAPHY = """
    fingerpad topography skin.csv --unit um --size "100 um" "100 um"
    fingerpad topography skin.vk4
"""


# -- microscale ----------------------------------------------------------------------------------------
def microscale(argv: Sequence[str]) -> int:
    """Print the microscale over pressure; return the exit code."""
    parser = Parser("microscale", _MICROSCALE)
    parser.add_scene()
    parser.add_ranges("voltage")
    parser.add_argument("--p", metavar="RANGE", default=_PRESSURES, help=f"pressures (Pa); default {_PRESSURES}")
    output.add_files(parser, _COLUMNS, "picture")
    args = parser.read(argv)
    scene = scene_of(args, meshed=False)
    if args.voltage is None and scene.history is not None:
        raise SceneError("history is given, whose loads have their own voltages; name those wanted by --voltage")
    rows = table(scene, several(args, scene, "voltage"), quantities("--p", args.p, "Pa"))
    closure = _microscopic(scene)
    um, low, high = 1e6, *(p * 1e-3 for p in closure.pressures)
    echo(
        f"A ridge of rms roughness {closure.h_rms * um:.3g} µm, largest wavelength {closure.wavelength * um:.3g} µm; "
        f"insulators: h_0 = {scene.h_0 * um:.3g} µm.\n"
    )
    echo(output.text(_COLUMNS, rows))
    begin = "roughness.p_floor" if low == closure.p_floor * 1e-3 else "the beginning of the table of gaps"
    echo(
        "\npressure: mean contact pressure of the ridge; external: pressure less attraction; separation: mean.\n"
        f"The air gap stays constant below {low:.4g} kPa ({begin}) and above {high:.4g} kPa, {closure.end}."
    )
    pressures = [row["p_c"] for row in rows]
    shares = 100 * closure.spread(pressures) / closure(pressures).d_eq
    if shares.any():
        ends = " to ".join(dict.fromkeys(f"{share:.2g}" for share in (shares.min(), shares.max())))
        echo(f"From one surface of four by four largest waves to the next the air gap scatters by {ends} % (rms).")
    sticking = closure.sticking_voltage()
    least = f"From {sticking or 0:.3g} V a ridge would stick: to pull it off takes {STICKING * 1e-3:g} kPa or more."
    echo(least if sticking else "No voltage makes a ridge stick: the insulators are thick for this roughness.")
    for text in examine("scene", scene):
        echo(f"{text}.")
    for each in closure.cautions([(row["p_c"], 1.0, row["voltage"]) for row in rows], "pressures and voltages"):
        echo(f"{each.text[0].upper()}{each.text[1:]}.")
    output.write_files(args, _COLUMNS, rows, _draw_microscale)
    return 0


def _microscopic(scene: Scene) -> BearingArea | TabulatedClosure:
    """Return the closure of a scene.

    Raises:
        SceneError: it is a law of one's own, which has no separation and no real area.
    """
    closure = scene.closure()
    if not closure.shared:
        names = " or ".join(CLOSURES.laws)
        raise SceneError(f"roughness is a {type(closure).__name__}; the microscale is that of a law {names}")
    return closure  # type: ignore[return-value]  # those with parameters of a surface


def table(scene: Scene, voltages: Sequence[float], pressures: Sequence[float]) -> list[dict[str, Any]]:
    """Return a row for each voltage (V) and mean contact pressure (Pa), in SI units.

    Pressures beyond the closure's range are held at its ends, as in a run.
    """
    closure = _microscopic(scene)
    gaps = closure.statistics(np.clip(np.array(pressures), *closure.pressures))
    rows = []
    for voltage in voltages:
        p_el = VACUUM_PERMITTIVITY * voltage**2 / 2 * gaps.inverse_square
        for k, p in enumerate(pressures):
            u_bar = gaps.u_bar[k] + 0.0  # no negative zero
            row = {"p_c": p, "u_bar": u_bar, "d_eq": gaps.d_eq[k], "p_el": p_el[k], "p_ext": p - p_el[k]}
            rows.append({"voltage": voltage} | {n: float(v) for n, v in row.items()} | {"area": float(gaps.area[k])})
    return rows


def _draw_microscale(file: Path, rows: Sequence[dict[str, Any]]) -> None:
    """Draw lengths, attraction and real area over pressure."""
    voltages = list(dict.fromkeys(row["voltage"] for row in rows))
    first = [row for row in rows if row["voltage"] == voltages[0]]
    p = [row["p_c"] * 1e-3 for row in first]
    with output.panels(file, "Microscale of a ridge", 3) as (_, axes):
        from fingerpad.results.pictures import style

        gaps, stress, area = axes
        output.curve(gaps, 0, p, [row["d_eq"] * 1e6 for row in first], "equivalent air gap $d_{eq}$")
        output.curve(gaps, 1, p, [row["u_bar"] * 1e6 for row in first], r"mean separation $\bar u$")
        for k, voltage in enumerate(voltages):
            found = [row["p_el"] * 1e-3 for row in rows if row["voltage"] == voltage]
            output.curve(stress, k, p, found, f"{voltage:g} V", style.voltage(voltage, max(voltages, key=abs)))
        output.curve(area, 0, p, [100 * row["area"] for row in first], "")
        gaps.set(ylabel="length (µm)", ylim=(0, None))
        stress.set(ylabel="attraction $p_{el}$ (kPa)", ylim=(0, None))
        area.set(ylabel="real area of contact (% of the nominal)", yscale="log")
        for ax in axes:
            ax.set(xlabel="mean contact pressure $p_c$ (kPa)", xscale="log")
        for ax in (gaps, stress):
            ax.legend()


# -- topography ----------------------------------------------------------------------------------------
def topography(argv: Sequence[str]) -> int:
    """Print the table of roughness that a height map gives; return the exit code."""
    parser = Parser("topography", _TOPOGRAPHY)
    parser.add_argument("file", type=path, metavar="FILE", help="matrix of heights, or a file of an instrument")
    parser.add_table("roughness.topography")
    args = parser.read(argv)
    found = _scan(args)
    try:
        table, fit = roughness_table(found.map), power_spectrum(found.map.detrended("curvature"), window="hann").fit()
    except ValueError as error:
        raise SceneError(f"{clip(str(args.file), 80)}: {error}") from None
    echo("\n".join(_report(args.file, found, table, fit)))
    return 0


def _scan(args: argparse.Namespace) -> Found:
    """Return the height map of the file in the options.

    Raises:
        SceneError: it cannot be read.
    """
    given: dict[str, Any] = {name: getattr(args, name, None) for name in Topography.model_fields}
    for name in ("size", "pixel"):
        if given[name] is not None:
            given[name] = [override(f"{name}={length}")[1] for length in given[name]]
    try:
        return scan(**dict(Topography.model_validate(given | {"file": str(args.file)})))
    except OSError as error:
        raise SceneError(f"{clip(str(args.file), 80)} cannot be read: {error.strerror or error}") from None
    except ValidationError as error:
        raise SceneError(f"--{first_error(error, Topography, ())}") from None
    except (ValueError, ImportError) as error:
        raise SceneError(re.sub(r"'(unit|size|pixel|missing)'", r"--\1", str(error))) from None


def _report(file: Path, found: Found, table: dict[str, float], fit: Fit) -> Iterator[str]:
    """Yield the table of a scene, and as comments what was found."""
    (lx, ly), um, missing = found.map.size, 1e6, found.missing
    lost = f", {missing} pixels missing and filled" if missing else ""
    yield f"# {clip(str(file), 80)}: {found.layout}, {lx * um:.4g} µm x {ly * um:.4g} µm{lost}"
    long, short = (2e6 * math.pi / q for q in fit.q_range)
    hurst = f"{fit.hurst:.2f}" if fit.hurst_found else f"not found within {HURST[0]:g} to {HURST[1]:g}"
    yield f"# Hurst exponent {hurst}, fitted between wavelengths of {long:.3g} µm and {short:.3g} µm"
    if not fit.resolved:
        yield "# no roll-off within the map: the shorter side of the map stands for the largest wavelength"
    for remark in on_waves(table["wavelength"], min(found.map.size), Scene().geometry.ridge_wavelength):
        yield f"# {remark}"
    try:
        from_data({"roughness": {key: float(f"{value:.4g}") for key, value in table.items()}})
    except SceneError as error:
        yield f"# a scene refuses these values: {error}; is the unit of the heights right?"
    yield "\n[roughness]"
    yield from (f"{key} = {value:.4g}" for key, value in table.items())
