"""The page: one HTML file that holds its program, its numbers and its style, and a table that stands without them."""

import html
import json
import re
from importlib.resources import files

from fingerpad.calculator.fields import data
from fingerpad.installed import version
from fingerpad.io.quantities import PER_LENGTH
from fingerpad.reduced import cylinder_errors, cylinders
from fingerpad.scene import Scene
from fingerpad.scene.materials import BEARING_AREA
from fingerpad.scene.remarks import LEAKAGE

_TABLE = (20.0, 50.0, 75.0, 100.0, 150.0), (0.0, 50.0, 100.0, 150.0, 200.0)  # N/m, V


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
