"""The deformed finger and its skin state by state, as the page's program steps through them.

Energy densities become an image on a grid, log10 of kPa in hundredths as 16-bit integers: a tenth of the size of the
triangles.
"""

import base64
import math
from collections.abc import Iterator
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fingerpad.report import page as html
from fingerpad.results.fields import ALONG, View, views_of
from fingerpad.results.raster import along, cells_at, pieces
from fingerpad.results.result import Result
from fingerpad.results.states import called, shown
from fingerpad.scene.messages import counted
from variational.state import ContactState

Array = NDArray[np.float64]
_MM, _UM, _KPA = 1e3, 1e6, 1e-3
_COLUMNS = 520  # of the grid
_MAX_FRAMES = 12  # states with an image
_EMPTY = 32767
_STRAIGHT = 0.25  # of a column: bend of a cell's edge that is straight in the image
_NEAR, _PLACES = 0.2e-3, 1e4  # mm, between a line and its segments; places a mm, to which these are rounded
_BELOW, _ABOVE, _BESIDE = -0.15, 1.25, 0.6  # mm of the view around the contact


class _Frame(NamedTuple):
    label: str
    state: ContactState
    view: View | None
    """Its skin and its finger; None where a folder has neither."""


def frames(result: Result) -> dict[str, Any]:
    """Return the states that a folder has arrays of, ready for JSON; empty without any."""
    if result.folder is None or not result.steps:
        return {}
    found = [(frame, _skin(frame)) for frame in _listed(result, result.folder)]
    view = _view([skin for _, skin in found if skin])
    if view is None:
        return {}
    images = _chosen([frame.label for frame, _ in found if frame.view is not None and frame.view.snapshot is not None])
    drawn = []
    for frame, skin in found:
        finger = _finger(frame.view.snapshot, view) if frame.view is not None and frame.label in images else None
        if skin or finger:
            about = html.typeset(f"{frame.label}. {_about(frame.state)}")
            drawn.append({"label": frame.label, "about": about, "skin": skin, "finger": finger})
    return {"view": view, "frames": drawn} if drawn else {}


def slider(shown: dict[str, Any]) -> str:
    """Return the slider over the states with the finger near the contact and its skin; nothing without a state.

    Args:
        shown: of :func:`frames`.
    """
    if not shown:
        return ""
    labels = [frame["label"] for frame in shown["frames"]]
    last = len(labels) - 1
    options = "".join(f'<option value="{k}">{html.text(label)}</option>' for k, label in enumerate(labels))
    return f"""<section id="finger"><div class="controls needs-js">
<label for="state">State</label><button type="button" id="back" aria-label="state before">◀</button>
<input type="range" id="state" min="0" max="{last}" step="1" value="{last}">
<button type="button" id="forth" aria-label="next state">▶</button>
<select id="states" aria-label="state by name">{options}</select>
</div><p class="about needs-js" id="about" aria-live="polite"></p>
{html.chart("body", "Strain energy density in the deformed finger near the contact")}
{html.chart("skin", "Contact pressure, attraction and shear traction along the skin")}
<noscript><p class="note">The slider and charts need JavaScript; numbers and pictures do not.</p></noscript>
</section>"""


def section(shown: dict[str, Any]) -> str:
    """Return the section of one ridge, with a table of extremes of each state; nothing without a state.

    Args:
        shown: of :func:`frames`.
    """
    if not shown:
        return ""
    controls = """<div class="controls needs-js"><label for="ridge">Ridge</label>
<select id="ridge"></select><output id="under" aria-live="polite"></output></div>"""
    rows = [(frame["label"], peak, gap) for frame in shown["frames"] for peak, gap in [_extremes(frame["skin"])]]
    heads = ("state", "highest point of the pressure above (kPa)", "air gap d_eq of the ridges in contact (µm)")
    return html.section(
        "ridge-by-ridge",
        "One ridge, in the state of the slider above",
        html.paragraph("Choose a ridge here, or point at it above.", "needs-js"),
        controls,
        html.chart("one", "Contact pressure, attraction and height above the screen along one ridge"),
        html.table(heads, rows),
    )


def _extremes(skin: list[dict[str, Any]]) -> tuple[str, str]:
    peak = max((value for ridge in skin for value in ridge["p"] if value is not None), default=None)
    gaps = [ridge["gap"] for ridge in skin if ridge["length"] > 0 and ridge["gap"] is not None]
    return ("–" if peak is None else f"{peak:.1f}", f"{min(gaps):.2f} to {max(gaps):.2f}" if gaps else "–")


def _listed(result: Result, folder: Path) -> Iterator[_Frame]:
    loads, states = views_of(folder, result.steps, result.named)
    partial = shown(result.steps).get("partial") if result.charged is not None else None
    for load in result.loads:
        if partial is not None and load.end.step > partial.step:
            yield _Frame("partial slip", partial, states.get("partial"))
            partial = None
        yield _Frame(f"end of {load.name}", load.end, loads.get(load.name))
    for name in ("charged", "full_slip"):
        state, view = result.named.get(name), states.get(name)
        if state is not None and view is not None and view.snapshot is not None:
            yield _Frame(f"{called(name, state.voltage)}, final mesh", state, view)


def conditions_of(state: ContactState) -> str:
    """Return force, voltage and the bone's place in a state in words."""
    return f"{state.f_ext:.4g} N/m, {state.voltage:.4g} V, bone at {_MM * state.bone_x + 0.0:.4g} mm"


def _about(state: ContactState) -> str:
    slides = abs(state.f_t) > 1e-9 * abs(state.f_ext) and not math.isnan(state.mu_app)
    slip = f", µ_app = {state.mu_app:.3f} of the middle section" if slides else ""
    count = state.ridges_in_contact
    length = f"L_R = {_MM * state.contact_length:.3f} mm, {counted(count, 'ridge')} in contact"
    return f"{conditions_of(state)}{slip}, {length}"


def _skin(frame: _Frame) -> list[dict[str, Any]]:
    """Return the ridges of a state, each with its places (mm, height in µm), stresses (kPa) and gap (µm)."""
    if frame.view is None or frame.view.skin is None:
        return []
    along: Any = frame.view.skin
    x, y, p, t, p_el, d_eq, ridge = (along[name] for name in ALONG)
    ridges = frame.state.ridges
    at = {} if ridges is None else {int(j): k for k, j in enumerate(ridges.number)}
    found = []
    for number in np.unique(ridge[np.isfinite(ridge)]):
        mine = ridge == number
        gap = float(d_eq[mine][0])
        k = at.get(int(number))
        length, mean = (0.0, 0.0) if ridges is None or k is None else (ridges.length[k], ridges.p_c[k])
        found.append(
            {
                "ridge": int(number),
                "x": _rounded(_MM * x[mine], 4),
                "y": _rounded(_UM * y[mine], 2),
                "p": _rounded(_KPA * p[mine], 2),
                "t": _rounded(_KPA * t[mine], 2),
                "p_el": _rounded(_KPA * p_el[mine], 2),
                "gap": round(_UM * gap, 4) if np.isfinite(gap) else None,
                "length": round(_MM * float(length), 4),
                "mean": round(_KPA * float(mean), 2),
            }
        )
    return found


def _rounded(values: Array, digits: int) -> list[float | None]:
    return [value if math.isfinite(value) else None for value in map(float, np.round(values, digits) + 0.0)]


def _view(skins: list[list[dict[str, Any]]]) -> list[float] | None:
    """Return left, right, lower and upper end (mm) of one view for all states: the skin that touches in any of them."""
    touching = [x for skin in skins for ridge in skin if ridge["length"] > 0 for x in ridge["x"] if x is not None]
    if not touching:
        return None
    return [round(min(touching) - _BESIDE, 3), round(max(touching) + _BESIDE, 3), _BELOW, _ABOVE]


def _chosen(stems: list[str]) -> set[str]:
    """Return the states that get an image, spread over all."""
    count = min(len(stems), _MAX_FRAMES)
    places = np.unique(np.linspace(0, len(stems) - 1, count).round().astype(int)) if stems else []
    return {stems[int(k)] for k in places}


def _finger(body: Any, view: list[float]) -> dict[str, Any] | None:
    """Return the energy density of a snapshot on a grid and the lines between layers; None without one."""
    if body is None:
        return None
    xy = np.asarray(_MM * (body.x + body.u), dtype=float)
    left, right, bottom, top = view
    x = np.linspace(left, right, _COLUMNS, dtype=np.float64)
    pixel = float(x[1] - x[0])
    y = np.arange(0.5 * pixel, top, pixel, dtype=np.float64)  # the screen is at 0
    corners, cells = pieces(xy, body.triangles, body.lines, body.beside, _STRAIGHT * pixel)
    level = np.round(100 * np.log10(np.maximum(_KPA * body.sed, 1e-9)))
    image = np.append(level[cells], _EMPTY)[cells_at(corners, x, y)].astype("<i2")
    points = xy[body.lines]
    low, high = np.array([left, bottom]), np.array([right, top])
    inside = ((points.max(axis=1) > low) & (points.min(axis=1) < high)).all(axis=1)
    segments = np.round(_PLACES * along(xy, body.lines[inside], _NEAR)).astype(int)
    known = image[image != _EMPTY]
    return {
        "image": base64.b64encode(image.tobytes()).decode(),
        "shape": list(image.shape),
        "x": [round(left, 5), round(pixel, 7)],
        "y": [round(float(y[0]), 5), round(pixel, 7)],
        "highest": float(np.quantile(known, 0.999)) / 100 if known.size else 0.0,
        "lines": segments.reshape(-1, 4).tolist(),
    }
