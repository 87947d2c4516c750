"""The deformed finger and its skin state by state, through which the slider of a report steps."""

import math
from collections.abc import Iterator
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from markupsafe import Markup
from matplotlib.figure import Figure
from numpy.typing import NDArray

from fingerpad.report.charts import Panel, Series, chart
from fingerpad.report.page import linked
from fingerpad.results.fields import ALONG, View, views_of
from fingerpad.results.pictures.finger import DECADES, Scales, density, scales
from fingerpad.results.result import Result
from fingerpad.results.states import called, shown
from fingerpad.scene.messages import counted
from variational.state import ContactState

Array = NDArray[np.float64]
_MM, _UM, _KPA = 1e3, 1e6, 1e-3
_MAX_FRAMES = 12
_BELOW, _ABOVE, _BESIDE = -0.1, 1.25, 0.6  # mm of the view around the contact
_HIGHEST = 0.4  # of its width
_WIDE, _DPI = 500.0, 160  # px of the panel with the finger where a page is narrow; of its picture
_STRESSES = (("p", "contact pressure", "ink", ""), ("p_el", "attraction", "blue", "6 3"),
             ("t", "shear traction", "orange", "2 3"))  # fmt: skip


class Frame(NamedTuple):
    """A state of the slider."""

    label: str
    about: str
    """Its conditions and its contact, in words."""
    drawn: Markup


def frames(result: Result) -> tuple[list[Frame], list[str]]:
    """Return the states that a folder has arrays of, a dozen at most, and the ends of their colours (kPa)."""
    if result.folder is None or not result.steps:
        return [], []
    found = [each for each in _listed(result, result.folder) if each[2].skin is not None]
    found = [found[int(k)] for k in np.unique(np.linspace(0, len(found) - 1, _MAX_FRAMES).round())] if found else []
    skins = [{name: np.asarray(view.skin[name]) for name in ALONG} for *_, view in found]  # type: ignore[index]
    touching = np.concatenate([skin["x"][skin["p"] > 0] for skin in skins]) if skins else np.empty(0)
    if not len(touching):
        return [], []
    ends = float(_MM * touching.min()) - _BESIDE, float(_MM * touching.max()) + _BESIDE
    stresses = [_KPA * values for skin in skins for values in (skin["p"], skin["p_el"], skin["t"])]
    low, high = (float(each) for each in (np.nanmin(np.concatenate(stresses)), np.nanmax(np.concatenate(stresses))))
    scale = 1.05 * min(low, 0.0), 1.08 * max(high, 1e-9)
    bodies = [view.snapshot for *_, view in found if view.snapshot is not None]
    most = scales(bodies).highest if bodies else 1e3
    return [
        Frame(label, _about(state, skin), _drawn(state, view, skin, ends, scale, most))
        for (label, state, view), skin in zip(found, skins, strict=True)
    ], [f"{_KPA * most / DECADES:.2g}", f"{_KPA * most:.2g}"]


def _listed(result: Result, folder: Path) -> Iterator[tuple[str, ContactState, View]]:
    loads, states = views_of(folder, result.steps, result.named)
    partial = shown(result.steps).get("partial") if result.charged is not None else None
    for load in result.loads:
        if partial is not None and load.end.step > partial.step:
            if "partial" in states:
                yield "partial slip", partial, states["partial"]
            partial = None
        if load.name in loads:
            yield f"end of {load.name}", load.end, loads[load.name]
    for name in ("charged", "full_slip"):
        state, view = result.named.get(name), states.get(name)
        if state is not None and view is not None and view.snapshot is not None:
            yield f"{called(name, state.voltage)}, final mesh", state, view


def conditions_of(state: ContactState) -> str:
    """Return force, voltage and the bone's place in a state in words."""
    return f"{state.f_ext:.4g} N/m, {state.voltage:.4g} V, bone at {_MM * state.bone_x + 0.0:.4g} mm"


def _about(state: ContactState, skin: dict[str, Array]) -> str:
    slides = abs(state.f_t) > 1e-9 * abs(state.f_ext) and not math.isnan(state.mu_app)
    slip = f", µ_app = {state.mu_app:.3f} of the middle section" if slides else ""
    length = f"L_R = {_MM * state.contact_length:.3f} mm, {counted(state.ridges_in_contact, 'ridge')} in contact"
    return f"{conditions_of(state)}{slip}, {length}, p_max = {_KPA * float(np.nanmax(skin['p'])):.1f} kPa"


def _drawn(
    state: ContactState, view: View, skin: dict[str, Array], ends: tuple[float, float], scale: tuple[float, float],
    most: float,
) -> Markup:  # fmt: skip
    """Return the finger near the contact above the stresses along its skin, with words on each ridge."""
    x = _MM * skin["x"]
    lines = [Series(name, x, _KPA * skin[key], "line", colour, dash) for key, name, colour, dash in _STRESSES]
    panels = [Panel("stress (kPa)", lines, ends=scale)]
    if view.snapshot is not None:
        top = min(_ABOVE, _BELOW + _HIGHEST * (ends[1] - ends[0]))
        high = _WIDE * (top - _BELOW) / (ends[1] - ends[0])
        panels.insert(
            0, Panel("y (mm)", [], high, (_BELOW, top), image=_finger(view.snapshot, (*ends, _BELOW, top), most))
        )
    words = "The deformed finger near the contact, and contact pressure, attraction and shear traction along its skin"
    return chart(panels, "x on the screen (mm)", words, ends=ends, spans=_ridges(state, skin))


def _ridges(state: ContactState, skin: dict[str, Array]) -> list[tuple[float, float, str]]:
    """Return the ends (mm) of each ridge along x, and its contact in words."""
    at = {} if state.ridges is None else {int(j): k for k, j in enumerate(state.ridges.number)}
    found = []
    for number in np.unique(skin["ridge"][np.isfinite(skin["ridge"])]):
        mine = skin["ridge"] == number
        words, k, gap = f"ridge {number:.0f}", at.get(int(number)), _UM * float(skin["d_eq"][mine][0])
        if k is not None and state.ridges is not None and state.ridges.length[k] > 0:
            length, mean = _MM * state.ridges.length[k], _KPA * state.ridges.p_c[k]
            words += f": contact length {length:.3f} mm, mean pressure {mean:.1f} kPa"
        words += f", air gap {gap:.2f} µm" if math.isfinite(gap) else ""
        x = _MM * skin["x"][mine]
        found.append((round(float(x.min()), 4), round(float(x.max()), 4), words))
    return found


def _finger(body: Any, view: tuple[float, float, float, float], most: float) -> str:
    """Return a link of an image: the energy density of a snapshot near the contact, and lines between layers."""
    from PIL import Image

    figure = Figure(figsize=(5.0, 5.0 * (view[3] - view[2]) / (view[1] - view[0])), dpi=_DPI)
    axes = figure.add_axes((0, 0, 1, 1))
    axes.axis("off")
    density(axes, body, Scales(view, view, most))
    data = BytesIO()
    figure.savefig(data, format="png", facecolor="#ebebeb")
    return linked(Image.open(data).convert("RGB"))
