"""An animation of a run: the finger on the screen, its ridges with pressure and attraction, and the forces.

Every state of the motion in ``fields.npz`` is a frame: lines of the finger, and its skin with pressure and attraction.
Frames between two states are linear in displacements and stresses, which is no solution of the model; over a jump there
are none. A state takes some 50 kB. Long runs keep every second, fourth, … of their states.
"""

import math
from collections.abc import Callable, Mapping, MutableMapping, Sequence
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
from matplotlib.axes import Axes
from matplotlib.backends.backend_agg import FigureCanvasAgg
from matplotlib.figure import Figure
from matplotlib.lines import Line2D
from matplotlib.patches import Patch, PathPatch, Rectangle
from numpy.typing import NDArray
from PIL import Image

from fingerpad.results import fields
from fingerpad.results.data import ResultData
from fingerpad.results.files import replace
from fingerpad.results.pictures import style
from fingerpad.results.pictures.finger import LAYER_COLOURS, curve
from fingerpad.results.quantities import STEPS
from fingerpad.results.states import by_load
from fingerpad.scene.messages import SceneError, clip
from fingerpad.scene.remarks import coefficient
from variational.snapshot import Snapshot, loops
from variational.state import ContactState

Array = NDArray[np.float64]
Numbers = NDArray[np.int64]
Moved = Mapping[str, NDArray[np.float32]]
"""A state: ``u``, displacement of the points on lines (m), shape (points, 2); ``skin``, shape (rows, skin points)."""
ROWS = ("x", "p", "t", "p_el")
"""Rows of the skin: place (m), contact pressure, shear traction and attraction (Pa)."""
_KEPT = 160  # states of a run, at most
ENDINGS = (".webp", ".gif")
_FRAMES, _LOAD = 160, 16  # of an animation, about at most; of each load, at least
_DPI, _HEIGHT = 90, 6.0  # of a frame; in
_MS, _LAST = 90, 2000  # of a frame, and of the last one
_QUALITY = 55  # of WebP, of 100
_COLOURS = 64  # of GIF
_MM, _KPA = 1e3, 1e-3
_LOW, _HIGH = -0.18, 1.55  # mm, of the view near the contact
_LEGEND: dict[str, Any] = {
    "loc": "lower left", "bbox_to_anchor": (0, 1), "ncols": 3, "fontsize": 8, "borderaxespad": 0.1
}  # fmt: skip
_SLIPS = 1e-3  # relative: a traction this near the limit of friction counts as on it


def moved(snapshot: Snapshot, skin: Mapping[str, Array]) -> Moved:
    """Return a state in single precision.

    Args:
        snapshot: the body.
        skin: along the skin by the names in :data:`ROWS`, a NaN between ridges.
    """
    u = snapshot.u[np.unique(snapshot.lines)]
    return {"u": u.astype(np.float32), "skin": np.stack([skin[name] for name in ROWS]).astype(np.float32)}


def thin(states: MutableMapping[int, Moved]) -> None:
    """Drop every second state but the last where there are too many; they are by step, in order."""
    if len(states) > _KEPT:
        for step in list(states)[-2::-2]:
            del states[step]


def group(snapshot: Snapshot, states: Mapping[int, Moved]) -> dict[str, NDArray[Any]]:
    """Return the group ``motion`` of ``fields.npz``.

    Args:
        snapshot: the body in any state.
        states: by step.
    """
    points, lines = np.unique(snapshot.lines, return_inverse=True)
    layers = np.where(snapshot.beside >= 0, snapshot.tag[snapshot.beside], 0)
    arrays = {name: np.stack([state[name] for state in states.values()]) for name in ("u", "skin")}
    about = {"x": snapshot.x[points], "lines": lines.reshape(-1, 3), "layers": layers}
    return {"step": np.array(list(states)), **about, **arrays}


@dataclass(frozen=True)
class Motion:
    """The motion of a finger."""

    step: Numbers
    """Of each state, shape (states,)."""
    x: Array
    """Reference places of points on lines (m), shape (points, 2)."""
    u: Array
    """Their displacements (m), shape (states, points, 2)."""
    lines: Numbers
    """Points where each line begins, has its middle and ends, shape (lines, 3)."""
    layers: Numbers
    """Tags on the left and on the right of each, 0 outside, shape (lines, 2)."""
    skin: Array
    """The rows of :data:`ROWS`, shape (states, rows, skin points)."""

    def between(self, k: int, part: float) -> tuple[Array, Array]:
        """Return places of points (m), shape (points, 2), and rows of the skin, on the way from a state to the next.

        Args:
            k: number of the first of both.
            part: of the way, 0 to 1; values are linear in between.
        """
        after = min(k + 1, len(self.step) - 1)
        u, skin = ((1 - part) * each[k] + part * each[after] for each in (self.u, self.skin))
        return self.x + u, skin


def motion_of(folder: Path) -> Motion:
    """Return the motion of the finger of a run.

    Raises:
        SceneError: the folder has none; one sentence.
    """
    found: dict[str, Any] = fields.read(folder).get("motion", {})
    try:
        made = Motion(**{name: found[name] for name in Motion.__dataclass_fields__})
        states, points = len(made.step), len(made.x)
        whole = made.u.shape == (states, points, 2) and made.skin.shape[:2] == (states, len(ROWS)) and states > 0
        whole &= made.lines.shape[1:] == (3,) and made.layers.shape == (len(made.lines), 2)
        whole &= all(each.dtype.kind == "i" for each in (made.step, made.lines, made.layers))
        whole = bool(whole and np.all((made.lines >= 0) & (made.lines < points)))
    except (KeyError, TypeError):
        whole = False
    if not whole:
        where = clip(str(folder), 80)
        raise SceneError(
            f"{where} has no motion of a run in {fields.FILE}, which is written at the end of a full run with "
            "output.each_load = true; make the run again"
        )
    return made


class _Scene(NamedTuple):
    """What all frames have in common."""

    states: Sequence[ContactState]
    motion: Motion
    mu_0: float | None
    half: float
    """Of the width of the view near the contact (mm)."""
    highest: float
    """Stress (kPa)."""


def animate(result: ResultData, path: Path, on_frame: Callable[[int, int], None] = lambda done, count: None) -> Path:
    """Write the animation of a run that has a folder; return the file, which is there as a whole or not at all.

    Args:
        result: of a full run.
        path: of the file, whose name ends with ``.webp`` or ``.gif``.
        on_frame: called with the number of frames that are drawn, and of all.

    Raises:
        SceneError: the run has no motion, or the name another ending; one sentence.
    """
    if path.suffix not in ENDINGS:
        raise SceneError(f"{clip(str(path), 80)} must end with {' or '.join(ENDINGS)}, the formats of animations")
    if result.folder is None:
        raise SceneError("a run without a folder has no motion to animate; give fingerpad.run an out")
    found = motion_of(result.folder)
    by_step = {state.step: state for state in result.steps}
    if missing := [int(step) for step in found.step if step not in by_step]:
        raise SceneError(f"step {missing[0]} of the motion is not in the run; make the run again")
    states = [by_step[int(step)] for step in found.step]
    places = _MM * np.where(found.skin[:, 1] > 0, found.skin[:, 0], np.nan)
    half = 1.0 + (float(np.nanmax(np.abs(places))) if np.isfinite(places).any() else 4.0)
    highest = _KPA * max(float(np.nanmax(found.skin[:, [1, 3]])), 1.0)
    scene = _Scene(states, found, coefficient(result.scene), half, highest)
    frames, figure, pictures = _frames(states), style.figure(_HEIGHT), list[Image.Image]()
    rows: Any = [["whole"] * 2 + ["forces"] * 3, ["near"] * 5, ["stress"] * 5]
    figure.subplot_mosaic(rows, height_ratios=(6, 4, 4))
    for k, part in frames:
        pictures.append(_drawn(scene, k, part, figure))
        on_frame(len(pictures), len(frames))
    _save(path, pictures)
    return path


def _frames(states: Sequence[ContactState]) -> list[tuple[int, float]]:
    """Return of each frame its state and how far it is on the way to the next one, 0 to 1.

    Each load has some at least; there is none within a jump, and the last state is at the end.
    """
    found = list[tuple[int, float]]()
    for _, mine in by_load(states):
        parts = max(math.ceil(_LOAD / len(mine)), min(3, _FRAMES // len(states)), 1)
        for state in mine:
            k = states.index(state)
            jumps = k + 1 < len(states) and (after := states[k + 1].record) is not None and after.jump
            found += [(k, 0.0 if jumps or k + 1 == len(states) else j / parts) for j in range(parts)]
    return found[: len(found) - parts + 1]


def _drawn(scene: _Scene, k: int, part: float, figure: Figure) -> Image.Image:
    """Return the picture of a part of the way from a state to the next one, drawn on a figure with panels."""
    xy, skin = scene.motion.between(k, part)
    with style.look():
        whole, forces, near, stress = figure.axes
        for ax in figure.axes:
            ax.clear()
        figure.suptitle(_words(scene.states[k]))
        _draw_finger(whole, scene, _MM * xy, None)
        _draw_finger(near, scene, _MM * xy, scene.half)
        whole.add_artist(Rectangle((-scene.half, _LOW), 2 * scene.half, _HIGH - _LOW, fill=False, ls="--"))
        _draw_change(near, scene, k)
        _draw_stress(stress, scene, skin)
        _draw_forces(forces, scene.states, k + part)
        style.save(figure, None)
        figure.set_dpi(_DPI)
        canvas = FigureCanvasAgg(figure)
        canvas.draw()
        figure.set_layout_engine("none")  # the panels of the first frame keep their places
        return Image.fromarray(np.asarray(canvas.buffer_rgba())[:, :, :3].copy())


def _words(state: ContactState) -> str:
    place = f"bone at x = {_MM * state.bone_x + 0.0:.2f} mm"
    force = f"f_ext = {state.f_ext:.1f} N/m, U = {state.voltage:.0f} V, {place}"
    slip = "full slip" if state.slip_began else f"{100 * state.slipping:.0f} % of the contact slips"
    return f"{style.plain(state.load)}: {force}; {slip}"


def _draw_finger(ax: Axes, scene: _Scene, xy: Array, half: float | None) -> None:
    """Draw the layers (mm): the whole cross-section, or the part near the contact."""
    found = scene.motion
    tags, sides = np.unique(found.layers, return_inverse=True)
    for tag in (int(tag) for tag in tags if int(tag) in LAYER_COLOURS):
        around = np.concatenate(loops(found.lines, sides.reshape(-1, 2), tags, tag))
        ax.add_artist(PathPatch(curve(xy, around), fc=LAYER_COLOURS[tag], ec="black", lw=0.4))
    ax.axhspan(-3, 0, color="0.35", lw=0, zorder=3)
    every = _MM * (found.x + found.u)
    (left, _), (right, top) = every.min(axis=(0, 1)), every.max(axis=(0, 1))
    wide = (left - 0.5, right + 0.5) if half is None else (-half, half)
    ax.set(xlim=wide, ylim=(-0.9, top + 0.5) if half is None else (_LOW, _HIGH), ylabel="y (mm)")
    if half is None:
        ax.set(aspect="equal", xlabel="x (mm)")
    else:
        ax.tick_params(labelbottom=False)


def _draw_change(ax: Axes, scene: _Scene, k: int) -> None:
    """Name the ridges that came into contact or left it in the step to a state, above their place."""
    state, before = scene.states[k], scene.states[max(k - 1, 0)]
    if state.ridges is None or before.ridges is None:
        return
    now, then = (each.number[each.length > 0] for each in (state.ridges, before.ridges))
    gone, come = np.setdiff1d(then, now), np.setdiff1d(now, then)
    words = [f"ridges off: {', '.join(map(str, gone))}"] if gone.size else []
    words += [f"ridges on: {', '.join(map(str, come))}"] if come.size else []
    ax.text(0.5, 0.9, "     ".join(words), transform=ax.transAxes, ha="center", va="top", weight="bold", zorder=5)


def _draw_stress(ax: Axes, scene: _Scene, skin: Array) -> None:
    """Draw pressure, where it slips and where it sticks, and attraction."""
    x, p, t, p_el = _MM * skin[0], _KPA * skin[1], _KPA * skin[2], _KPA * skin[3]
    slips = np.abs(t) >= (1 - _SLIPS) * (scene.mu_0 or math.inf) * p
    for where, colour in ((~slips, style.BLACK), (slips, style.VERMILION)):
        ax.fill_between(x, p, where=where & (p > 0), color=colour, lw=0.8)
    ax.plot(x, -p_el, color=style.ATTRACTION, lw=1.2)
    ax.axhline(0, color="0.35", lw=0.8)
    ax.set(xlim=(-scene.half, scene.half), ylim=(-0.42 * scene.highest, 1.05 * scene.highest))
    ax.set(xlabel="x on the screen (mm)", ylabel="stress (kPa)")
    named: list[Any] = [Patch(color=style.BLACK, label="contact pressure, sticks")]
    named += [Patch(color=style.VERMILION, label="slips")] if scene.mu_0 else []
    named += [Line2D([], [], color=style.ATTRACTION, label="attraction, downward")]
    ax.legend(handles=named, **_LEGEND)


def _draw_forces(ax: Axes, states: Sequence[ContactState], now: float) -> None:
    """Draw the forces over the states, up to a frame in full colour."""
    at, top = np.arange(len(states)), 0.0
    for key, colour, dash in (
        ("f_ext", style.GREY, "--"), ("f_electrostatic", style.BLUE, "-"), ("f_t", style.VERMILION, "-.")
    ):  # fmt: skip
        values = np.array([getattr(state, key) for state in states], dtype=float)
        done = np.append(at[at <= now], now)
        reached = np.interp(done, at, values)
        ax.plot(at, values, color=colour, lw=0.8, alpha=0.35, ls=dash)
        ax.plot(done, reached, color=colour, lw=2, ls=dash, label=STEPS[key].words)
        ax.plot(now, reached[-1], "o", color=colour, ms=5)
        top = max(top, float(np.nanmax(values)))
    begins = 0
    for load, mine in by_load(states):
        ax.axvline(begins, color="0.8", lw=0.8, zorder=0)
        ax.text(begins + 0.5 * (len(mine) - 1), 1.18 * top, style.plain(load), ha="center", va="top", fontsize=9)
        begins += len(mine)
    ax.set(xlim=(0, max(len(states) - 1, 1)), ylim=(min(0.0, -0.02 * top), 1.2 * top or 1.0))
    ax.set(xlabel="step of the run", ylabel="force (N/m)")
    ax.legend(**_LEGEND)


def _save(path: Path, pictures: Sequence[Image.Image]) -> None:
    """Write pictures as one file that runs again and again."""
    data = BytesIO()
    times = [_MS] * (len(pictures) - 1) + [_LAST]
    if path.suffix == ".gif":
        few = pictures[-1].quantize(_COLOURS)
        pictures = [each.quantize(palette=few, dither=Image.Dither.NONE) for each in pictures]
        kind: dict[str, Any] = {"format": "GIF", "optimize": True}
    else:
        kind = {"format": "WEBP", "quality": _QUALITY, "method": 4}
    first, *rest = pictures
    first.save(data, save_all=True, append_images=rest, duration=times, loop=0, **kind)
    replace(path, data.getvalue())
