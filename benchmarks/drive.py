"""The drive: friction over frequency, waveform and what a voltage means, and what of it is felt; by the closed form.

environment/run python3 -m benchmarks.drive [--draw]     also: make drive

Writes docs/drive.json, and from it docs/drive.md and its picture; a minute.
"""

import argparse
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from benchmarks import harness
from benchmarks.harness import keep, kept, made, page, picture
from fingerpad.reduced.detection import FREQUENCIES as TABLED
from fingerpad.reduced.detection import thresholds
from fingerpad.results.pictures import style
from fingerpad.runs.drive import drive
from fingerpad.scene import Scene
from fingerpad.scene.drive import REFERENCE, remains
from fingerpad.scene.waveform import MEASURES
from variational.attraction.circuit import LEAKS

VOLTS = 200.0
FREQUENCIES = np.geomspace(1.0, 1e6, 25)  # Hz
SINE = {"waveform": "sine", "amplitude": VOLTS, "frequency": 100.0}
CIRCUITS: dict[str, dict[str, Any]] = {
    "lossless": {},
    "no leak": {"tissue": "dry"},
    "sliding dry": {"tissue": "dry", "leak": "sliding dry"},
    "least": {"tissue": "dry", "leak": LEAKS["sliding dry"].low},
    "most": {"tissue": "dry", "leak": LEAKS["sliding dry"].high},
    "moist": {"tissue": "moist", "leak": "moist"},
}
WAVES: dict[str, dict[str, Any]] = {
    "sine": SINE,
    "triangle": SINE | {"waveform": "triangle"},
    "square": SINE | {"waveform": "square"},
    "sine, 3 kHz carrier": SINE | {"carrier": {"frequency": 3e3}},
    "sine about 100 V": SINE | {"offset": 100.0},
    "sine, 5 periods on, 5 off": SINE | {"burst": {"on": 5, "off": 5}},
}
SHOWN = (10.0, 30.0, 100.0, 300.0, 1e3, 1e4, 1e5, 1e6)  # Hz
OVER_TIME = 30.0  # Hz
_KEPT = 256  # samples of a period


def compute(args: argparse.Namespace) -> None:
    """Compute and keep the numbers."""
    leaky = CIRCUITS["sliding dry"]
    numbers: dict[str, Any] = {
        "frequency": FREQUENCIES.tolist(),
        "share": {name: [_share(float(f), each) for f in FREQUENCIES] for name, each in CIRCUITS.items()},
        "friction": {name: [_friction(float(f), each) for f in FREQUENCIES] for name, each in CIRCUITS.items()},
        "shown": {name: [_friction(f, each) for f in SHOWN] for name, each in CIRCUITS.items()},
        "uncharged": drive(Scene(voltage=SINE | {"amplitude": 1.0})).f_t.min(),
        "waves": {name: _waves(each) for name, each in WAVES.items()},
        "means": {each: _waves({"waveform": "sine", each: VOLTS, "frequency": 100.0}) for each in MEASURES},
        "left_out": {name: [_left_out(f, CIRCUITS[name]) for f in SHOWN] for name in ("sliding dry", "moist")},
        "constant": {name: _remains(each) for name, each in CIRCUITS.items() if "leak" in each},
        "time": {kind: _over_time(kind, leaky) for kind in ("sine", "square")},
        "felt": _felt_at(leaky, [float(f) for f in np.geomspace(10, 480, 21)]),
        "felt_table": {name: _felt_at(CIRCUITS[name], TABLED) for name in ("sliding dry", "no leak")},
    }
    keep("drive", numbers, made(), args.docs)


def _scene(wave: Mapping[str, Any], electric: Mapping[str, Any]) -> Scene:
    return Scene(voltage=dict(wave), electric=dict(electric))


def _share(frequency: float, electric: Mapping[str, Any]) -> float:
    """Return the square of the voltage across the reference gap, over that of the drive."""
    scene = _scene(SINE | {"frequency": frequency}, electric)
    assert scene.drive is not None
    return float(scene.drive.circuit.share(frequency, REFERENCE, *scene.drive.layers))


def _friction(frequency: float, electric: Mapping[str, Any]) -> float:
    """Return the mean friction force (N/m) of a sine."""
    return float(drive(_scene(SINE | {"frequency": frequency}, electric)).f_t.mean())


def _left_out(frequency: float, electric: Mapping[str, Any]) -> float:
    """Return by how much µ_app of Eq. 3 is above that in a circuit, over the latter: of a sine of 200 V rms."""
    wave = {"waveform": "sine", "rms": VOLTS, "frequency": frequency}
    eq_3, circuit = (float(drive(_scene(wave, each)).f_t.mean()) for each in ({}, electric))
    return eq_3 / circuit - 1


def _wave(wave: Mapping[str, Any], electric: Mapping[str, Any]) -> dict[str, float]:
    """Return measures of a drive and its friction (V, Pa, N/m)."""
    scene = _scene(wave, electric)
    assert scene.drive is not None
    found, measures = drive(scene), scene.drive.measures()
    f = float(wave["frequency"])
    friction = {"mean": found.f_t.mean(), "low": found.f_t.min(), "high": found.f_t.max()}
    friction |= {"at_f": found.at(f), "at_2f": found.at(2 * f)}
    return {name: float(value) for name, value in ({f"u_{k}": v for k, v in vars(measures).items()} | friction).items()}


def _waves(wave: Mapping[str, Any]) -> dict[str, dict[str, float]]:
    """Return :func:`_wave` without losses and through a dry gap that leaks."""
    return {name: _wave(wave, CIRCUITS[name]) for name in ("lossless", "sliding dry")}


def _felt_at(electric: Mapping[str, Any], frequencies: Sequence[float]) -> list[dict[str, Any]]:
    return [vars(each) for each in thresholds(Scene(electric=dict(electric)), frequencies)]


def _remains(electric: Mapping[str, Any]) -> dict[str, float]:
    scene = Scene(electric=dict(electric))
    return vars(remains(scene.electric, scene.geometry.sc_thickness))


def _over_time(kind: str, electric: Mapping[str, Any]) -> dict[str, list[float]]:
    found = drive(_scene(SINE | {"waveform": kind, "frequency": OVER_TIME}, electric))
    at = np.arange(0, len(found.time), len(found.time) // _KEPT)
    return {name: getattr(found, name)[at].tolist() for name in ("time", "voltage", "f_t")}


# -- page ----------------------------------------------------------------------------------------------------
def draw(docs: Path) -> Path:
    """Write docs/drive.md and its picture from docs/drive.json."""
    picture(docs / "drive.png", (10, 7), lambda figure: _paint(figure, kept("drive", docs).numbers))
    return page(docs, "drive", "make drive", globals())


def _paint(figure: Figure, numbers: Mapping[str, Any]) -> None:
    (over, time), (share, felt) = figure.subplots(2, 2)
    _over_frequency(over, numbers, "friction", "mean friction force (N/m)")
    over.set_title("A  friction, sine of 200 V, 75 N/m")
    _over_frequency(share, numbers, "share", "share of the gap, |E g / U|² (–)")
    share.set_title("C  share of the gap, 1.6 µm")
    for kind, colour, dash in (("sine", style.BLUE, "-"), ("square", style.VERMILION, "--")):
        one = numbers["time"][kind]
        time.plot(1e3 * np.array(one["time"]), one["f_t"], color=colour, ls=dash, label=kind)
    time.set(xlabel="time (ms)", ylabel="friction force (N/m)", title="B  one period at 30 Hz, leak of a dry finger")
    time.legend()
    time.grid(alpha=0.3)
    _felt(felt, numbers["felt"])


def _over_frequency(ax: Axes, numbers: Mapping[str, Any], name: str, label: str) -> None:
    f, values = numbers["frequency"], numbers[name]
    looks = {"lossless": (style.BLACK, ":", "lossless (Eq. 3)"), "no leak": (style.GREEN, "-.", "dry skin, no leak")}
    looks |= {
        "sliding dry": (style.BLUE, "-", "dry skin, leak"),
        "moist": (style.VERMILION, "--", "moist skin, leak guessed"),
    }
    for key, (colour, dash, words) in looks.items():
        ax.semilogx(f, values[key], color=colour, ls=dash, label=words)
    ax.fill_between(f, values["least"], values["most"], color=style.BLUE, alpha=0.25, lw=0)
    ax.set(xlabel="frequency (Hz)", ylabel=label)
    ax.grid(alpha=0.3)
    ax.legend(fontsize=8)


def _felt(ax: Axes, rows: list[Mapping[str, Any]]) -> None:
    f = np.array([row["frequency"] for row in rows])
    sine = np.array([row["sine"] for row in rows])
    square = sine * np.array([row["square_over_sine"] for row in rows])
    beyond = np.array([row["extrapolated"] for row in rows])
    looks = ((sine, style.BLUE, "o", "-", "sine"), (square, style.VERMILION, "s", "--", "square"))
    for values, colour, marker, dash, words in looks:
        ax.loglog(f, values, color=colour, ls=dash, label=words)
        ax.plot(f[~beyond], values[~beyond], marker, color=colour, ms=4)
        ax.plot(f[beyond], values[beyond], marker, color=colour, ms=4, mfc="white")
    ax.set(xlabel="frequency (Hz)", ylabel="threshold over sine of 120 Hz (–)", title="D  voltage that is just felt")
    ax.grid(alpha=0.3, which="both")
    ax.legend(title="open: extrapolated", fontsize=8)


if __name__ == "__main__":
    sys.exit(harness.main(__doc__, compute, draw))
