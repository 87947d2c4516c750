"""The calculator: one HTML file with its program, its numbers and its style, and a table that stands without them.

Keys of a scene have their bounds and defaults from the scene itself. What is said here of a field is how it is shown:
its words, its unit and the ends of its slider, within its bounds.
"""

import html
import json
import re
from collections.abc import Iterator
from dataclasses import asdict, dataclass
from importlib.resources import files
from typing import Any, get_args

from numpy.polynomial.legendre import leggauss
from pydantic import BaseModel, WrapValidator

from fingerpad.installed import version
from fingerpad.reduced import cylinder_errors, cylinders
from fingerpad.reduced.model import STATES
from fingerpad.results.quantities import PER_LENGTH
from fingerpad.results.states import WORDS
from fingerpad.scene import Scene
from fingerpad.scene.law_keys import keys_of
from fingerpad.scene.materials import BEARING_AREA, LARGEST_GAP
from fingerpad.scene.remarks import LEAKAGE, skin_modulus
from fingerpad.slices import traces
from geometry.parameters import Fingertip, MeshSize
from geometry.units import Range
from variational.attraction.electroadhesion import VACUUM_PERMITTIVITY
from variational.contact.friction import Coulomb

_TABLE = (20.0, 50.0, 75.0, 100.0, 150.0), (0.0, 50.0, 100.0, 150.0, 200.0)  # N/m, V


@dataclass(frozen=True)
class Field:
    """A field of the page; numbers in its own unit."""

    key: str
    """Of the scene, dotted."""
    words: str
    unit: str
    per: float
    """Units in one SI unit: 1e6 for µm."""
    slider: tuple[float, float]
    """Ends of the slider."""
    group: str
    low: float = 0.0
    high: float = 0.0
    zero: bool = False
    """Whether zero is allowed besides values from ``low`` to ``high``."""
    value: float = 0.0
    """The default."""
    whole: bool = False
    """Whether only whole numbers are allowed."""


_FORCE = 0.5  # N, of the field that a scene has no default of
_SHOWN = (
    Field("voltage", "voltage U", "V", 1.0, (0.0, 250.0), "Load"),
    Field("f_ext", "normal force f_ext, per metre of finger", "N/m", 1.0, (5.0, 150.0), "Load"),
    Field("force", "normal force F_ext on the whole finger", "N", 1.0, (0.05, 1.0), "Load"),
    Field("friction", "friction coefficient µ_0 without voltage", "", 1.0, (0.05, 1.0), "Load"),
    Field("electric.d_i", "thickness d_i", "µm", 1e6, (0.1, 10.0), "Coating of the screen"),
    Field("electric.eps_i", "relative permittivity ε_i", "", 1.0, (1.0, 30.0), "Coating of the screen"),
    Field("roughness.h_rms", "root mean square height h_rms", "µm", 1e6, (1.0, 10.0), "Roughness of the skin"),
    Field("roughness.wavelength", "largest wavelength λ_0", "µm", 1e6, (20.0, 500.0), "Roughness of the skin"),
    Field("roughness.young", "elastic modulus of the surface E", "MPa", 1e-6, (0.1, 10.0), "Roughness of the skin"),
    Field("roughness.gamma", "decay of the repulsion γ", "", 1.0, (0.3, 0.8), "More of the model"),
    Field("roughness.beta", "prefactor of the repulsion β", "", 1.0, (0.5, 2.0), "More of the model"),
    Field("roughness.p_floor", "pressure below which the gap is held", "Pa", 1.0, (10.0, 1e4), "More of the model"),
    Field("electric.eps_sc", "relative permittivity of the skin ε_sc", "", 1.0, (100.0, 1e4), "More of the model"),
)


def fields() -> Iterator[Field]:
    """Yield the fields of a scene's keys, with bounds and defaults from the scene."""
    for field in _SHOWN:
        model, _, name = field.key.rpartition(".")
        table: Any = getattr(Scene(), model) if model else Scene()
        allowed = bounds(type(table), name) if field.key != "friction" else bounds(Coulomb, "mu_f")
        value = _in_unit(_FORCE if name == "force" else getattr(table, name), field.per)
        low, high = (_in_unit(end, field.per) for end in (allowed.low, allowed.high))
        yield Field(**asdict(field) | {"low": low, "high": high, "zero": allowed.zero, "value": value})


def contact() -> Iterator[Field]:
    """Yield the fields of a contact as given; the values shown first are the default finger's at full slip."""
    default, group = cylinders.solve(Scene()).full_slip, "Finger"
    assert default is not None
    low, high = bounds(MeshSize, "contact").low, bounds(Fingertip, "width").high  # a finger's facet, and its width
    length = round(default.contact_length * 1e3, 3)
    yield Field("length", "contact length L_R", "mm", 1e3, (0.2, 4.0), group, low * 1e3, high * 1e3, False, length)
    ends = {type(end).__name__: end for end in Fingertip.model_fields["ridge_count"].metadata}
    low, high, ridges = float(ends["Ge"].ge), float(ends["Le"].le), float(default.ridges_in_contact)
    yield Field("ridges", "ridges in contact", "", 1.0, (1.0, 25.0), group, low, high, False, ridges, True)


def bounds(model: type, name: str) -> Range:
    """Return the range of a key of a table, or of a law."""
    if not issubclass(model, BaseModel):
        return Range(*keys_of(model)[name].metadata["range"])
    field = model.model_fields[name]
    choices = (field.annotation, *get_args(field.annotation))  # of a key that may be left out, too
    parts = (*field.metadata, *(part for each in choices for part in getattr(each, "__metadata__", ())))
    return next(p.func for p in parts if isinstance(p, WrapValidator) and isinstance(p.func, Range))


def _in_unit(value: float, per: float) -> float:
    """Return an SI value in another unit, without the last digits of the conversion."""
    return float(f"{value * per:.12g}")


def data() -> dict[str, Any]:
    """Return all numbers that the page has from Python, ready for JSON; SI units but for those of the fields."""
    scene, error = Scene(), cylinder_errors.KNOWN_ERROR["full_slip"]
    nodes, weights = (each.tolist() for each in leggauss(scene.slices.count))
    return {
        "fields": [asdict(field) for field in (*fields(), *contact())],
        "eps_0": VACUUM_PERMITTIVITY,
        "sc_thickness": scene.geometry.sc_thickness,
        "tip_radius": cylinders.tip_radius(scene.geometry),
        "skin_modulus": skin_modulus(scene),
        "largest_gap": LARGEST_GAP,
        "forces": cylinders.FORCES,
        "lengths": cylinders.LENGTHS,
        "ridges": cylinders.RIDGES,
        "indentations": cylinders.INDENTATIONS,
        "wavelength": scene.geometry.ridge_wavelength,
        "slices": {"radius": scene.slices.radius, "length": scene.slices.length, "nodes": nodes, "weights": weights},
        "traces": traces.CONSTANTS,
        "words": {state: WORDS[state] for state in STATES},
        "known": {"error": error, "runs": cylinder_errors.KNOWN_RUNS}
        | {"forces": cylinder_errors.KNOWN_FORCES, "voltages": cylinder_errors.KNOWN_VOLTAGES},
    }


def page() -> str:
    """Return the page."""
    own = files("fingerpad.calculator")
    style, closed_form, plot, program = (
        (own / name).read_text(encoding="utf-8").rstrip()
        for name in ("page.css", "closed_form.js", "plot.js", "page.js")
    )
    values = {
        "error": f"{100 * cylinder_errors.KNOWN_ERROR['full_slip']['mu_app']:.1f} %",
        "runs": str(cylinder_errors.KNOWN_RUNS),
        "where": cylinder_errors.where(),
        "leakage": html.escape(LEAKAGE),
        "table": _table(),
        "defaults": _defaults(),
        "per_length": html.escape(PER_LENGTH),
        "version": version(),
        "style": style,
        # Inside a script "</" could end it.
        "data": json.dumps(data(), ensure_ascii=False).replace("</", "<\\/"),
        "closed_form": closed_form,
        "plot": plot,
        "page": program,
    }
    template = (own / "page.html").read_text(encoding="utf-8")
    return re.sub(r"\{\{(\w+)\}\}", lambda name: values[name[1]], template)


def _table() -> str:
    """Return µ_app of the default finger over force and voltage."""
    forces, voltages = _TABLE
    head = "".join(f'<th scope="col">{voltage:g} V</th>' for voltage in voltages)
    rows = []
    for f_ext in forces:
        found = (cylinders.solve(Scene(f_ext=f_ext, voltage=voltage)).full_slip for voltage in voltages)
        cells = "".join(f"<td>{state.mu_app:.3f}</td>" for state in found if state is not None)
        rows.append(f'<tr><th scope="row">{f_ext:g} N/m</th>{cells}</tr>')
    caption = "<caption>µ_app at full slip, by force per metre of finger and voltage</caption>"
    body = "\n".join(rows)
    return f'<table id="default">{caption}\n<thead><tr><td></td>{head}</tr></thead>\n<tbody>\n{body}\n</tbody></table>'


def _defaults() -> str:
    """Return the values that the table is of."""
    scene = Scene()
    coating, rough = scene.electric, BEARING_AREA
    return (
        f"Friction coefficient without voltage {scene.friction:g}; coating of {coating.d_i * 1e6:g} µm with a relative "
        f"permittivity of {coating.eps_i:g}; roughness of {rough.h_rms * 1e6:g} µm (root mean square), wavelengths up "
        f"to {rough.wavelength * 1e6:g} µm, elastic modulus {rough.young * 1e-6:g} MPa."
    )
