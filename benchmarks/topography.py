"""What a small map of the skin misses: heights, spectrum and bias of spots cut out of synthetic surfaces.

environment/run python3 -m benchmarks.topography [--draw]     a minute

The measured maps of the paper's Fig. 3 are not public. A surface of its parameters is made, eight spots of 100 um are
cut out and analysed as section 3.1 does; then many spots, for the bias. Writes docs/topography.json,
docs/topography.md and docs/topography.png.
"""

import sys
from collections.abc import Iterator, Mapping
from dataclasses import asdict
from pathlib import Path
from typing import Any, get_args

import numpy as np
from matplotlib.figure import Figure

from benchmarks import harness
from variational.roughness.selfaffine import SelfAffine
from variational.roughness.spectrum import PowerSpectrum, power_spectrum, roughness_table
from variational.roughness.topography import HeightMap, Trend, distribution, polynomials

_UM = 1e6
SIDE, SPOT, SPOTS = 800e-6, 100e-6, 8  # m; the paper's spots
SURFACES = 20  # that the many spots are cut from
FINE, COARSE = 2048, 512  # pixels along the side: for one surface, for the many
WINDOWS = (50e-6, 100e-6, 200e-6, 400e-6)  # m
TRENDS: tuple[Trend, ...] = get_args(Trend)
READINGS = (SelfAffine(plateau=True), SelfAffine(plateau=False))


def spots(surface: HeightMap, length: float) -> Iterator[HeightMap]:
    """Yield square spots of ``length`` (m), at most 16 of a surface, a quarter of its side apart or more."""
    n = len(surface.heights)
    pixels = round(n * length / surface.size[0])
    starts = range(0, n - pixels + 1, max(pixels, n // 4))
    return (surface.cut((i, j), (pixels, pixels)) for i in starts for j in starts)


def expected_rms(kind: SelfAffine, n: int, pixels: int, trend: Trend) -> float:
    """Return the root of the expected mean square (m) of a detrended spot, from the spectrum and without a surface.

    The spot's expected square along a polynomial phi is the sum over modes of C / A times the square of phi's
    Fourier transform. The sides of the surface and of the spot have ``n`` and ``pixels`` pixels.
    """
    variance = kind.modes((n, n), (SIDE, SIDE)) / SIDE**2
    spot = (pixels, pixels)
    modes = (np.abs(np.fft.fft2(phi.reshape(spot), s=(n, n))) for phi in polynomials(spot, TRENDS.index(trend)).T)
    return float(np.sqrt(kind.h_rms**2 - sum(float(np.sum(variance * mode**2)) for mode in modes) / pixels**2))


def biases(kind: SelfAffine) -> Iterator[dict[str, Any]]:
    """Yield, by window and trend, mean and scatter of the rms heights (m) of many spots, and the expected value."""
    rms: dict[tuple[float, Trend], list[float]] = {(w, trend): [] for w in WINDOWS for trend in TRENDS}
    for seed in range(SURFACES):
        surface = kind.surface((COARSE, COARSE), (SIDE, SIDE), seed)
        for window, trend in rms:
            rms[window, trend] += [spot.detrended(trend).h_rms for spot in spots(surface, window)]
    for (window, trend), values in rms.items():
        found = {"mean": float(np.mean(values)), "scatter": float(np.std(values))}
        found["expected"] = expected_rms(kind, COARSE, round(COARSE * window / SIDE), trend)
        yield asdict(kind) | {"window": window, "trend": trend} | found


def _rings(spectrum: PowerSpectrum) -> dict[str, list[float]]:
    """Return the radial mean of a spectrum: wavevectors (1/m) and C (m^4)."""
    ring = spectrum.radial()
    kept = ring.q < 2 * spectrum.q_range[1]
    return {"q": [float(q) for q in ring.q[kept]], "psd": [float(c) for c in ring.psd[kept]]}


def compute(args: Any) -> None:
    """Make the surfaces and keep the numbers."""
    surface = READINGS[0].surface((FINE, FINE), (SIDE, SIDE), seed=1)
    cut = list(spots(surface, SPOT))[::2]
    flat = [spot.detrended("curvature") for spot in cut]
    heights, spectrum = distribution(*flat), power_spectrum(*flat, window="hann")
    fit = spectrum.fit()
    numbers = {
        "surfaces": SURFACES,
        "heights": {key: float(getattr(heights, key)) for key in ("h_rms", "skewness", "kurtosis", "distance")},
        "fit": {"hurst": fit.hurst, "q_range": list(fit.q_range)},
        "table": roughness_table(*cut),
        "spectra": {"surface": _rings(power_spectrum(surface)), "spots": _rings(spectrum)},
        "bias": [bias for kind in READINGS for bias in biases(kind)],
    }
    harness.keep("topography", numbers, harness.made(), args.docs)


# -- page ----------------------------------------------------------------------------------------------------
def _chosen(numbers: Mapping[str, Any], plateau: bool, trend: str) -> list[dict[str, Any]]:
    return [b for b in numbers["bias"] if b["plateau"] == plateau and b["trend"] == trend]


def _bias_table(numbers: Mapping[str, Any], plateau: bool) -> str:
    def cell(bias: Mapping[str, Any]) -> str:
        mean, scatter, expected = (bias[key] * _UM for key in ("mean", "scatter", "expected"))
        return f"{mean:.2f} ± {scatter:.2f} ({expected:.2f})"

    columns = [list(map(cell, _chosen(numbers, plateau, trend))) for trend in TRENDS]
    rows = [[f"{window * _UM:g}", *cells] for window, *cells in zip(WINDOWS, *columns, strict=True)]
    return harness.table(["window (µm)", *(f"{trend} removed" for trend in TRENDS)], rows)


def _paint(figure: Figure, numbers: Mapping[str, Any], wanted: float) -> None:
    """Draw spectra over Eq. 8 as printed, and rms heights over the size of the spot with their scatter as bars."""
    left, right = figure.subplots(1, 2)
    printed, other = READINGS
    marks = (("surface", "o", harness.GREY, "whole surface, 800 µm"), ("spots", "s", harness.GREEN, "8 spots, 100 µm"))
    for key, marker, colour, label in marks:
        q, psd = (np.array(numbers["spectra"][key][name]) for name in ("q", "psd"))
        left.plot(q, psd / printed.psd(q), marker, color=colour, ms=5, label=label)
    last, edge = numbers["spectra"]["spots"]["q"][-1], other.q_0
    left.plot([2 * np.pi / SIDE, last], [1, 1], color=harness.BLUE, label="Eq. 8 as printed, with plateau")
    ratio = float(other.psd(2 * edge) / printed.psd(2 * edge))
    without = [edge, edge, last], [0, ratio, ratio]
    left.plot(*without, "--", color=harness.VERMILION, label="4πH, nothing below $q_0$")
    left.set(xscale="log", xlabel="wavevector q (1/m)", ylabel="$C$ / $C$ of Eq. 8", title="Power spectrum")
    left.set_ylim(0, 3.2)
    left.legend(loc="upper right")
    curves: list[tuple[Trend, bool]] = [*((trend, True) for trend in TRENDS), ("curvature", False)]
    colours = (harness.GREY, harness.SKY, harness.BLUE, harness.BLUE)
    for k, ((trend, plateau), colour) in enumerate(zip(curves, colours, strict=True)):
        found = _chosen(numbers, plateau, trend)
        window, rms, bar = (np.array([b[key] for b in found]) * _UM for key in ("window", "mean", "scatter"))
        look: dict[str, Any] = {} if plateau else {"ls": "--", "mfc": "white"}
        label, beside = f"{trend} removed" + ("" if plateau else ", no plateau"), 1 + 0.05 * (k - 1)
        right.errorbar(window * beside, rms, bar, color=colour, capsize=2, marker="o", label=label, **look)
    right.axhline(wanted, color="black", lw=1, ls=":", label="whole surface")
    right.set(ylim=(0, 4), xlabel="size of the spot (µm)", ylabel="rms height (µm)", title="What a spot misses")
    harness.ticks(right, [w * _UM for w in WINDOWS], grid=False)
    right.legend(loc="lower right")


def draw(docs: Path) -> Path:
    """Draw page and picture from the kept numbers."""
    kept, text = harness.kept("topography", docs), harness.prose("topography")
    numbers, printed = kept.numbers, READINGS[0]
    wanted, share, heights = printed.h_rms * _UM, 1 / (1 + printed.hurst), numbers["heights"]
    plateau, none = (_chosen(numbers, each, "curvature")[WINDOWS.index(SPOT)] for each in (True, False))
    shown, bare = (f"{b['mean'] * _UM:.2f} ± {b['scatter'] * _UM:.2f} µm" for b in (plateau, none))
    below = wanted * printed.h_rms / plateau["expected"]
    finding = text["finding"].format(wanted=wanted, below=below, shown=shown, bare=bare)
    paper = {"hurst": printed.hurst, "wavelength": printed.wavelength * _UM, "q_0": printed.q_0}
    how = text["how"].format(wanted=wanted, share=share, part=wanted * share**0.5, **paper)
    longest, shortest = (2 * np.pi / q * _UM for q in numbers["fit"]["q_range"])
    spot = heights | {"h_rms": heights["h_rms"] * _UM, "hurst": numbers["fit"]["hurst"], "table": numbers["table"]}
    body = [
        harness.picture(
            docs / "topography.png", (9, 4), lambda figure: _paint(figure, numbers, wanted), text["caption"]
        ),
        text["bias"].format(wanted=wanted, surfaces=numbers["surfaces"]),
        f"With the plateau:\n\n{_bias_table(numbers, True)}",
        f"Without the plateau:\n\n{_bias_table(numbers, False)}",
        text["spots"].format(longest=longest, shortest=shortest, **spot),
    ]
    path, command = docs / "topography.md", "python3 -m benchmarks.topography"
    return harness.page(path, "Topography of a ridge", finding, how, body, command, kept.made, ["topography"])


if __name__ == "__main__":
    sys.exit(harness.main(__doc__, compute, draw))
