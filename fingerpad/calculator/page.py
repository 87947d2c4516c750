"""The calculator: one HTML file with its program, its numbers and its style, and a table that stands without them.

Keys of a scene have their bounds and defaults from the scene itself. What is said here of a field is how it is shown:
its words, its unit and the ends of its slider, within its bounds.

A preset is a coating. The page has the default finger alone: other names of fingers have other shapes.
"""

import html
import json
import re
from collections.abc import Iterator, Mapping
from dataclasses import asdict, dataclass, replace
from importlib.resources import files
from typing import Any

from numpy.polynomial.legendre import leggauss

from fingerpad.launcher import version
from fingerpad.reduced import cylinder_errors, cylinders, press
from fingerpad.reduced.model import STATES
from fingerpad.results.quantities import PER_LENGTH, Output
from fingerpad.results.result import Result
from fingerpad.results.states import WORDS
from fingerpad.scene import Scene
from fingerpad.scene.keys import by_name
from fingerpad.scene.materials import BEARING_AREA, LARGEST_GAP
from fingerpad.scene.remarks import LEAKAGE
from fingerpad.slices import traces
from geometry.units import Range
from variational.attraction.dielectric import VACUUM_PERMITTIVITY

SCRIPTS = (
    "numerics.js", "closed_form.js", "whole.js", "errors.js", "state.js", "commands.js",
    "plot.js", "heat.js", "files.js", "form.js", "page.js",
)  # fmt: skip
"""In order; those before ``plot.js`` need no page."""
_TABLE = (0.1, 0.3, 0.5, 1.0, 2.0), (0.0, 50.0, 100.0, 150.0, 200.0)  # N, V


@dataclass(frozen=True)
class Field:
    """A field of the page; numbers in its own unit."""

    key: str
    """Of the scene, dotted."""
    words: str
    unit: str
    slider: tuple[float, float]
    """Ends of the slider."""
    group: str
    low: float = 0.0
    high: float = 0.0
    zero: bool = False
    """Whether zero is allowed besides values from ``low`` to ``high``."""
    value: float = 0.0
    """The default."""
    per: float = 1.0
    """Units in one SI unit: 1e6 for µm."""


_FORCE, _VOLTAGE = 0.5, 200.0  # N, of the field that a scene has no default of; V
_SHOWN = (
    Field("voltage", "voltage U", "V", (0.0, 400.0), "Load"),
    Field("force", "normal force F_ext on the whole finger", "N", (0.05, 3.0), "Load"),
    Field("f_ext", "normal force f_ext, per metre of finger", "N/m", (5.0, 150.0), "Load"),
    Field("friction", "friction coefficient µ_0 without voltage", "", (0.1, 1.0), "Load"),
    Field("electric.d_i", "thickness d_i of the coating", "µm", (0.1, 100.0), "Coating of the screen"),
    Field("electric.eps_i", "relative permittivity ε_i", "", (2.0, 30.0), "Coating of the screen"),
    Field("roughness.h_rms", "root mean square height h_rms", "µm", (1.0, 10.0), "Roughness of the skin"),
    Field("roughness.wavelength", "largest wavelength λ_0", "µm", (20.0, 500.0), "Roughness of the skin"),
    Field("roughness.young", "elastic modulus of the surface E", "MPa", (0.1, 10.0), "Roughness of the skin"),
    Field("roughness.gamma", "decay of the repulsion γ", "", (0.3, 0.8), "More of the model"),
    Field("roughness.beta", "prefactor of the repulsion β", "", (0.5, 2.0), "More of the model"),
    Field("roughness.p_floor", "pressure below which the gap is held", "Pa", (10.0, 1e4), "More of the model"),
    Field("electric.eps_sc", "relative permittivity of the skin ε_sc", "", (100.0, 1e4), "More of the model"),
)


def fields() -> Iterator[Field]:
    """Yield the fields of the page, with bounds and defaults from the keys of a scene."""
    keys = by_name(Scene)
    for field in _SHOWN:
        key = keys[field.key]
        yield _bounded(field, key.limits, _FORCE if key.name == "force" else key.default)


def _bounded(field: Field, limits: Range | None, value: float) -> Field:
    """Return a field with its bounds and its default, which are in SI units, in its own unit."""
    assert limits is not None
    per = Output("", field.unit).scale
    low, high, shown = (_in_unit(float(each), per) for each in (limits.low, limits.high, value))
    return replace(field, low=low, high=high, zero=limits.zero, value=shown, per=per)


def _in_unit(value: float, per: float) -> float:
    """Return an SI value in another unit, without the last digits of the conversion."""
    return float(f"{value * per:.12g}")


def data() -> dict[str, Any]:
    """Return all numbers that the page has from Python, ready for JSON; SI units but for those of the fields."""
    scene, shown = Scene(), [*fields()]
    default = press.of(scene)
    nodes, weights = (each.tolist() for each in leggauss(scene.slices.count))
    return {
        "fields": [asdict(field) for field in shown],
        "eps_0": VACUUM_PERMITTIVITY,
        "sc_thickness": scene.geometry.sc_thickness,
        "tip_radius": cylinders.tip_radius(scene.geometry),
        "friction": scene.friction,
        "shear": cylinders.SHEAR,
        "largest_gap": LARGEST_GAP,
        "forces": default.forces,
        "lengths": default.lengths,
        "ridges": default.ridges,
        "indentations": default.indentations,
        "wavelength": scene.geometry.ridge_wavelength,
        "slices": {"radius": scene.slices.radius, "length": scene.slices.length, "nodes": nodes, "weights": weights},
        "traces": traces.CONSTANTS,
        "words": {state: WORDS[state] for state in STATES},
        "presets": [*_preset_data({field.key: field.per for field in shown})],
        "known": {"regions": cylinder_errors.data(field.key for field in shown)},
    }


def page() -> str:
    """Return the page."""
    values = {
        "finding": _finding(),
        "regions": _regions(),
        "leakage": html.escape(LEAKAGE),
        "table": _table(),
        "defaults": _defaults(),
        "per_length": html.escape(PER_LENGTH),
        "version": version(),
        "style": part("page.css"),
        # Inside a script "</" could end it.
        "data": json.dumps(data(), ensure_ascii=False).replace("</", "<\\/"),
        "script": "\n".join(map(part, SCRIPTS)),
    }
    return re.sub(r"\{\{(\w+)\}\}", lambda name: values[name[1]], part("page.html"))


def part(name: str) -> str:
    """Return the text of a file of this folder."""
    return (files("fingerpad.calculator") / name).read_text(encoding="utf-8").rstrip()


def _whole(force: float, voltage: float) -> Result:
    """Return the default finger under a force (N) and a voltage (V)."""
    scene = Scene(force=force, voltage=voltage)
    return cylinders.Cylinders().whole(scene, cylinders.solve)


def _mu_app(force: float, voltage: float) -> float:
    finger = _whole(force, voltage).finger
    assert finger is not None
    return finger.states["full_slip"].mu_app


def _finding() -> str:
    """Return the first sentence of the page."""
    low, high = (_mu_app(_FORCE, voltage) for voltage in (0.0, _VOLTAGE))
    return (
        f"At {_FORCE:g} N, {_VOLTAGE:g} V raise the friction coefficient of the default finger from {low:.2f} to "
        f"{high:.2f}: a voltage attracts the skin to the screen."
    )


def _regions() -> str:
    """Return the table of where the closed form's error is known, the default screen's first."""
    head = ("", "µ_0", "attraction over force up to", "whole finger (%)", "its section (%)")
    rows = []
    for region in cylinder_errors.REGIONS:
        low, high = region.ranges.get("friction", (Scene().friction,) * 2)
        kind = "default screen" if region is cylinder_errors.REGIONS[0] else "other screens"
        section, whole = (100 * region.errors[key]["f_electrostatic"] for key in ("full_slip", cylinder_errors.WHOLE))
        friction = f"{low:.2g}" if low == high else f"{low:.2g} to {high:.2g}"
        cells = (friction, f"{region.ranges[cylinder_errors.PULL][1]:.2g}", f"{whole:.1f}", f"{section:.1f}")
        rows.append(f'<tr><th scope="row">{kind}</th>{"".join(f"<td>{each}</td>" for each in cells)}</tr>')
    caption = "<caption>Known error of the attraction of the closed form, beside full runs</caption>"
    top = "".join(f'<th scope="col">{each}</th>' if each else "<td></td>" for each in head)
    body = "\n".join(rows)
    return f'<table id="regions">{caption}\n<thead><tr>{top}</tr></thead>\n<tbody>\n{body}\n</tbody></table>'


def _table() -> str:
    """Return µ_app of the default finger over force and voltage."""
    forces, voltages = _TABLE
    head = "".join(f'<th scope="col">{voltage:g} V</th>' for voltage in voltages)
    rows = []
    for force in forces:
        cells = "".join(f"<td>{_mu_app(force, voltage):.3f}</td>" for voltage in voltages)
        rows.append(f'<tr><th scope="row">{force:g} N</th>{cells}</tr>')
    caption = "<caption>µ_app of the whole finger at full slip, by force and voltage</caption>"
    body = "\n".join(rows)
    top = f"<thead><tr><td></td>{head}</tr></thead>"
    return f'<table id="default">{caption}\n{top}\n<tbody>\n{body}\n</tbody></table>'


def _defaults() -> str:
    """Return the values that the table is of."""
    scene = Scene()
    coating, rough = scene.electric, BEARING_AREA
    return (
        f"Friction coefficient without voltage {scene.friction:g}; coating of {coating.d_i * 1e6:g} µm with a relative "
        f"permittivity of {coating.eps_i:g}; roughness of {rough.h_rms * 1e6:g} µm (root mean square), wavelengths up "
        f"to {rough.wavelength * 1e6:g} µm, elastic modulus {rough.young * 1e-6:g} MPa."
    )


# -- presets ---------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class _Preset:
    """Values of some fields."""

    group: str
    """Of the choice that it is in."""
    name: str
    values: Mapping[str, float]
    """By dotted key, in SI units."""
    source: str


_THICK = "Assumption: a common thickness; relative permittivity of handbooks."
SCREENS = (
    _Preset("Screen", "default", {"electric.d_i": 1e-6, "electric.eps_i": 3.9}, "The screen of the paper."),
    _Preset("Screen", "silicon dioxide, 0.2 µm", {"electric.d_i": 0.2e-6, "electric.eps_i": 3.9}, _THICK),
    _Preset("Screen", "aluminium oxide, 1 µm", {"electric.d_i": 1e-6, "electric.eps_i": 9.0}, _THICK),
    _Preset("Screen", "parylene C, 5 µm", {"electric.d_i": 5e-6, "electric.eps_i": 3.1}, _THICK),
    _Preset("Screen", "polyester film, 12 µm", {"electric.d_i": 12e-6, "electric.eps_i": 3.2}, _THICK),
)
"""Coatings of screens."""


def _preset_data(scales: Mapping[str, float]) -> Iterator[dict[str, Any]]:
    """Yield the presets ready for JSON, in the units of the fields.

    Args:
        scales: units in one SI unit, by the keys of the fields.
    """
    for each in SCREENS:
        values = {key: float(f"{value * scales[key]:.12g}") for key, value in each.values.items()}
        source = f"{each.name[0].upper()}{each.name[1:]}: {each.source}"
        yield {"group": each.group, "name": each.name, "values": values, "source": source}
