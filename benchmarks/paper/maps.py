"""Fig. 9A: maps of the strain energy density, in normal contact and in sliding, without and with voltage."""

import base64
import zlib
from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.cm import ScalarMappable
from matplotlib.figure import Figure
from numpy.typing import NDArray

from benchmarks.paper import scenes
from benchmarks.runs import computed
from fingerpad.results.pictures import finger as finger_picture
from fingerpad.results.pictures import style
from variational.snapshot import Snapshot

_LOADS = {"charge": "Normal contact", "slide": "Sliding"}
_VOLTAGES = (0.0, scenes.PEAK)
_NEAR = -4.4e-3, 5.6e-3, -0.1e-3, 1.25e-3  # m: left, right, lower and upper end of the maps
_MICRO = 1e6  # 1/m: places are kept in micrometres, a tenth of a pixel
_KINDS = {"xy": "<i4", "merkel": "<i4", "triangles": "<i4", "lines": "<i4", "beside": "<i4", "tag": "<i1", "sed": "<f2"}


def numbers(out: Path, jobs: int) -> dict[str, Any]:
    """Return the part of the finger that the maps show, in four states: packed arrays.

    Places are in 1e-6 m, energy densities in J/m³, and all others as in :class:`Snapshot`.
    """
    wanted = {voltage: scenes.grid()[scenes.MAP, voltage] for voltage in _VOLTAGES}
    maps = []
    for voltage, run in computed(wanted, out, jobs).items():
        for load in _LOADS:
            arrays = run.arrays(f"finger_{load}")
            fields = {name: arrays[name] for name in ("x", "u", "triangles", "sed", "tag", "lines", "beside")}
            kept = _near(Snapshot(**fields))
            kept |= {"merkel": _whole(arrays["merkel"])}
            maps.append({"voltage": voltage, "load": load} | {name: _pack(name, kept[name]) for name in _KINDS})
    return {"f_ext": scenes.MAP, "maps": maps}


def _whole(places: Any) -> NDArray[np.int64]:
    return np.rint(_MICRO * np.asarray(places)).astype(np.int64)


def _pack(name: str, values: NDArray[Any]) -> str:
    """Return an array as text: one of numbers would have megabytes."""
    return base64.b64encode(zlib.compress(values.astype(_KINDS[name]).tobytes(), 9)).decode()


def _unpack(kept: Mapping[str, Any], name: str, columns: int) -> NDArray[Any]:
    """Return an array of :func:`_pack`; one without columns is flat."""
    values = np.frombuffer(zlib.decompress(base64.b64decode(kept[name])), _KINDS[name])
    return values.reshape(-1, columns) if columns else values


def _near(body: Snapshot) -> dict[str, NDArray[Any]]:
    """Return the triangles in view and those beside the lines in view, with their points numbered anew."""
    left, right, bottom, top = _NEAR
    xy = body.x + body.u

    def seen(points: Any) -> Any:
        low, high = xy[points].min(axis=1), xy[points].max(axis=1)
        return (high > (left, bottom)).all(axis=1) & (low < (right, top)).all(axis=1)

    lines = seen(body.lines)
    cells = seen(body.triangles)
    cells[np.setdiff1d(body.beside[lines], [-1])] = True
    points, corners = np.unique(
        np.concatenate([body.triangles[cells].ravel(), body.lines[lines].ravel()]), return_inverse=True
    )
    number = np.append(np.cumsum(cells) - 1, -1)  # the last one, which -1 is of
    split = 3 * int(cells.sum())
    return {
        "xy": _whole(xy[points]),
        "triangles": corners[:split],
        "sed": body.sed[cells],
        "tag": body.tag[cells],
        "lines": corners[split:],
        "beside": number[body.beside[lines]],
    }


def _snapshot(kept: Mapping[str, Any]) -> Snapshot:
    """Return a state as it was kept, its places as they are in it."""
    xy = _unpack(kept, "xy", 2) / _MICRO
    columns = {"triangles": 3, "lines": 3, "beside": 2}
    whole: dict[str, Any] = {name: _unpack(kept, name, count).astype(np.int64) for name, count in columns.items()}
    sed, tag = _unpack(kept, "sed", 0).astype(np.float64), _unpack(kept, "tag", 0).astype(np.int32)
    return Snapshot(x=xy, u=np.zeros_like(xy), sed=sed, tag=tag, **whole)


def paint(figure: Figure, numbers: Mapping[str, Any]) -> None:
    """Draw the four maps with one scale of colours; columns are the voltages, rows normal contact and sliding."""
    states = {(each["voltage"], each["load"]): each for each in numbers["maps"]}
    bodies = {state: _snapshot(kept) for state, kept in states.items()}
    left, right, bottom, top = (1e3 * end for end in _NEAR)
    highest = max(float(np.quantile(body.sed, 0.999)) for body in bodies.values())
    scale = finger_picture.Scales((left, right, bottom, top), (left, right, bottom, top), highest)
    figure.suptitle(f"Strain energy density at {numbers['f_ext']:g} N/m; lines: layers; points: Merkel sites")
    axes = figure.subplots(len(_LOADS), len(_VOLTAGES), squeeze=False)
    for (voltage, load), body in bodies.items():
        row, column = list(_LOADS).index(load), _VOLTAGES.index(voltage)
        ax = axes[row, column]
        ax.set_aspect("equal")
        finger_picture.density(ax, body, scale)
        sites = 1e3 / _MICRO * _unpack(states[voltage, load], "merkel", 2)
        ax.plot(*sites.T, "o", ms=2.5, mfc="white", mec="black", mew=0.6)
        ax.set(xlim=(left, right), ylim=(bottom, top), title=f"{_LOADS[load]}, {voltage:g} V", facecolor="0.92")
        ax.set(xlabel="x (mm)" if row else "", ylabel="" if column else "y (mm)")
    ticks = style.decades(1e-6 * highest, 1e-3 * highest)
    colours = ScalarMappable(finger_picture.norm(scale), style.MAGNITUDE)
    bar = figure.colorbar(colours, ax=axes, location="bottom", extend="both", ticks=ticks, format="%g", aspect=60)
    bar.minorticks_off()
    bar.set_label("strain energy density (kPa = kJ/m³)")
