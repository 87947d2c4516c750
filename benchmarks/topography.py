"""Fig. 3's counterpart from synthetic surfaces: heights, their distribution, their spectrum, and what a spot misses.

environment/run python3 benchmarks/topography.py [--surfaces 20] [--docs DIR]

The measured maps of the paper are not public. A surface of its parameters is made, eight spots of 100 um are cut out
and analysed as section 3.1 says; then many spots, for the bias. Writes docs/topography.md and docs/topography.png.
"""

import argparse
import sys
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import NamedTuple, get_args

import matplotlib
import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.layout_engine import ConstrainedLayoutEngine
from numpy.typing import ArrayLike, NDArray

from fingerpad.cli.arguments import positive
from fingerpad.io.files import replace
from fingerpad.io.style import BLUE, GREEN, ORANGE, VERMILION
from variational.roughness.selfaffine import SelfAffine
from variational.roughness.spectrum import PowerSpectrum, power_spectrum, roughness_table
from variational.roughness.topography import Distribution, HeightMap, Trend, distribution, polynomials

_ROOT = Path(__file__).resolve().parents[1]
_UM = 1e6
SIDE, SPOT, SPOTS = 800e-6, 100e-6, 8  # m; the paper's spots
FINE, COARSE = 2048, 512  # pixels along the side: for the picture, for the many
WINDOWS = (50e-6, 100e-6, 200e-6, 400e-6)  # m
TRENDS: tuple[Trend, ...] = get_args(Trend)
READINGS = (SelfAffine(plateau=True), SelfAffine(plateau=False))


class Bias(NamedTuple):
    """The rms heights (m) of spots after detrending: mean and scatter over spots, and the expected root mean square."""

    mean: float
    scatter: float
    expected: float


def spots(surface: HeightMap, length: float) -> Iterator[HeightMap]:
    """Yield square spots of ``length`` (m), at most 16 of a surface, a quarter of its side apart or more."""
    n = len(surface.heights)
    pixels = round(n * length / surface.size[0])
    starts = range(0, n - pixels + 1, max(pixels, n // 4))
    return (surface.cut((i, j), (pixels, pixels)) for i in starts for j in starts)


def expected_rms(kind: SelfAffine, n: int, pixels: int, trend: Trend) -> float:
    """Return the root of the expected mean square (m) of a detrended spot, from the spectrum and without a surface.

    The spot's expected square along a polynomial phi is the sum over modes of C / A times the square of phi's
    Fourier transform.

    Args:
        kind: the roughness.
        n: pixels along the side of the surface.
        pixels: those along the side of the spot.
        trend: what is removed.
    """
    variance = kind.modes((n, n), (SIDE, SIDE)) / SIDE**2
    lost = 0.0
    for phi in polynomials((pixels, pixels), TRENDS.index(trend)).T:
        lost += float(np.sum(variance * np.abs(np.fft.fft2(phi.reshape(pixels, pixels), s=(n, n))) ** 2))
    return float(np.sqrt(kind.h_rms**2 - lost / pixels**2))


def biases(kind: SelfAffine, surfaces: int, n: int = COARSE) -> dict[tuple[float, Trend], Bias]:
    """Return the bias by window (m) and trend from many spots of ``surfaces`` surfaces."""
    rms: dict[tuple[float, Trend], list[float]] = {(w, trend): [] for w in WINDOWS for trend in TRENDS}
    for seed in range(surfaces):
        surface = kind.surface((n, n), (SIDE, SIDE), seed)
        for window, trend in rms:
            rms[window, trend] += [spot.detrended(trend).h_rms for spot in spots(surface, window)]
    return {
        (w, trend): Bias(
            float(np.mean(values)), float(np.std(values)), expected_rms(kind, n, round(n * w / SIDE), trend)
        )
        for (w, trend), values in rms.items()
    }


def _map(ax: Axes, figure: Figure, spot: HeightMap) -> None:
    ends = (0, spot.size[0] * _UM, 0, spot.size[1] * _UM)
    limit = float(np.abs(spot.heights).max()) * _UM
    image = ax.imshow(spot.heights.T * _UM, origin="lower", extent=ends, cmap="cividis", vmin=-limit, vmax=limit)
    figure.colorbar(image, ax=ax, label="height (µm)", shrink=0.8, pad=0.03)
    ax.set(xlabel="x (µm)", ylabel="y (µm)", title="A  One spot, curvature removed")


def _histogram(ax: Axes, heights: Distribution) -> None:
    ax.stairs(heights.density / _UM, heights.edges * _UM, fill=True, color=ORANGE, alpha=0.6, label=f"{SPOTS} spots")
    z = np.linspace(-4, 4, 200) * heights.h_rms
    label = f"Gaussian, $h_{{rms}}$ = {heights.h_rms * _UM:.2f} µm"
    ax.plot(z * _UM, heights.gaussian(z) / _UM, color=BLUE, lw=2, label=label)
    ax.set(xlabel="height (µm)", ylabel="probability density (1/µm)", title="B  Heights")
    ax.set_ylim(0, 1.45 * float(heights.density.max()) / _UM)
    ax.legend(frameon=False, loc="upper center")


def _spectra(ax: Axes, whole: PowerSpectrum, cut: PowerSpectrum) -> None:
    for spectrum, marker, colour, label in (
        (whole, "o", "0.6", "whole surface, 800 µm"),
        (cut, "s", GREEN, f"{SPOTS} spots, 100 µm"),
    ):
        ring = spectrum.radial()
        kept = ring.q < 2 * spectrum.q_range[1]
        ax.loglog(ring.q[kept], ring.psd[kept], marker, color=colour, ms=5, label=label)
    high = 2 * whole.q_range[1]
    printed, other = READINGS
    q = np.geomspace(2 * np.pi / SIDE, high, 200)
    ax.loglog(q, printed.psd(q), color=BLUE, lw=2, label="Eq. 8 as printed: plateau below $q_0$")
    q, top = np.geomspace(other.q_0, high, 200), float(other.psd(other.q_0))
    q, psd = np.append(other.q_0, q), np.append(top / 300, other.psd(q))
    ax.loglog(q, psd, "--", color=VERMILION, lw=2, label="$4\\pi H$ in Eq. 8: nothing below $q_0$")
    fit = cut.fit()
    q = np.array(fit.q_range)
    # Moved down: on the points it would hide what it is fitted to.
    ax.loglog(q, fit.psd(q) / 30, "k-.", lw=1.5, label=f"fit to the spots, ÷ 30: $H$ = {fit.hurst:.2f}")
    ax.set(ylim=(1e-32, 10 * top), xlabel="wavevector q (1/m)", ylabel="$C_{2D}$ (m⁴)", title="C  Power spectrum")
    above = ax.secondary_xaxis("top", functions=(_wavelength, _wavelength))
    above.set_xlabel("wavelength (µm)")
    above.xaxis.set_major_formatter("{x:g}")
    ax.legend(frameon=False, fontsize=10, loc="lower left")


def _wavelength(q: ArrayLike) -> NDArray[np.float64]:
    """Return the wavelength (µm) of q (1/m), and the other way round; Matplotlib also asks for q = 0."""
    return np.asarray(2 * np.pi * _UM / np.maximum(q, 1e-3))


def draw(path: Path, surface: HeightMap, flat: Sequence[HeightMap]) -> None:
    """Draw a spot, the heights of all spots and the spectra."""
    with matplotlib.rc_context({"font.size": 11, "axes.titlesize": 12, "axes.titlelocation": "left"}):
        figure = Figure(figsize=(15, 5.2), layout=ConstrainedLayoutEngine(wspace=0.06))
        first, second, third = figure.subplots(1, 3, width_ratios=(1.2, 0.85, 1.25))
        _map(first, figure, flat[0])
        _histogram(second, distribution(*flat))
        _spectra(third, power_spectrum(surface), power_spectrum(*flat, window="hann"))
        figure.savefig(path, dpi=110)


def _row(values: Sequence[object]) -> str:
    return "| " + " | ".join(map(str, values)) + " |"


def _bias_table(found: dict[tuple[float, Trend], Bias]) -> str:
    rows = [_row(["window (µm)", *(f"{trend} removed" for trend in TRENDS)]), "|---" * (len(TRENDS) + 1) + "|"]
    for w in WINDOWS:
        cells = [tuple(v * _UM for v in found[w, trend]) for trend in TRENDS]
        rows.append(_row([f"{w * _UM:g}", *(f"{m:.2f} ± {s:.2f} ({e:.2f})" for m, s, e in cells)]))
    return "\n".join(rows)


def _scatter(values: Sequence[float], digits: str) -> str:
    return f"{np.mean(values):{digits}} ± {np.std(values):{digits}}"


def _fit_table(surfaces: int) -> str:
    """Return what the fits of single surfaces and of the spots of a surface find."""
    rows = [_row(["map", "H", "λ0 (µm)", "h_rms of the fit (µm)", "roll-off seen"]), "|---" * 5 + "|"]
    made = [READINGS[0].surface((COARSE, COARSE), (SIDE, SIDE), seed) for seed in range(surfaces)]
    for window in (SIDE, *reversed(WINDOWS[1:])):
        fits = []
        for surface in made:
            cut = [surface] if window == SIDE else [s.detrended("curvature") for s in spots(surface, window)][:SPOTS]
            fits.append(power_spectrum(*cut, window="none" if window == SIDE else "hann").fit())
        seen = sum(f.resolved for f in fits)
        hurst = _scatter([f.hurst for f in fits], ".3f")
        wavelength = [f.wavelength * _UM for f in fits]
        length = _scatter(wavelength, ".0f") if seen else f"≥ {np.mean(wavelength):.0f}"
        h_rms = _scatter([f.h_rms(plateau=True) * _UM for f in fits], ".2f")
        name = f"{window * _UM:g} µm, periodic" if window == SIDE else f"spots of {window * _UM:g} µm"
        rows.append(_row([name, hurst, length, h_rms, f"{seen} of {surfaces}"]))
    return "\n".join(rows)


def page(flat: Sequence[HeightMap], table: dict[str, float], surfaces: int) -> str:
    """Return the page."""
    heights, fit = distribution(*flat), power_spectrum(*flat, window="hann").fit()
    longest, shortest = (2 * np.pi / q * _UM for q in fit.q_range)
    found = {kind: biases(kind, surfaces) for kind in READINGS}
    plateau, none = (found[kind][SPOT, "curvature"] for kind in READINGS)
    printed = READINGS[0]
    wanted, share = printed.h_rms * _UM, 1 / (1 + printed.hurst)
    return f"""# Topography of a ridge

Made by `environment/run python3 benchmarks/topography.py`; do not edit. The maps measured for Fig. 3 of the paper are
not public: these are synthetic Gaussian surfaces of its parameters, h_rms {wanted:g} µm, H = {printed.hurst:g},
λ0 = {printed.wavelength * _UM:g} µm, over {SIDE * _UM:g} µm × {SIDE * _UM:g} µm. `variational/roughness/` analyses
measured maps the same way.

![A spot's heights; the heights of eight spots and a Gaussian; spectra and both readings of Eq. 8](topography.png)

Eight spots of 100 µm × 100 µm, curvature removed as in section 3.1: h_rms {heights.h_rms * _UM:.2f} µm, skewness
{heights.skewness:.2f}, kurtosis {heights.kurtosis:.2f}, largest distance from the Gaussian's cumulative distribution
{heights.distance:.3f}. Their mean spectrum (Hann's window) gives H = {fit.hurst:.2f}, fitted between wavelengths of
{longest:.0f} µm and {shortest:.1f} µm. `roughness_table` makes of the spots what a scene needs:

    [roughness]
    h_rms = {table["h_rms"]:.3g}
    wavelength = {table["wavelength"]:.3g}

## Two readings of Eq. 8

With h_rms² = (1/2π) ∫ q C dq the printed prefactor 4πH/(1+H) belongs to a spectrum that is constant below
q0 = 2π/λ0 = {printed.q_0:.3g} 1/m. From q0 up it holds {share:.0%} of the variance, {wanted * share**0.5:.2f} µm rms.
If no wavelength is longer than λ0 the prefactor is 4πH. (The paper's q0 of 6.3e5 1/m is ten times too large.)

## What a spot misses

The rms height (µm) of spots cut out of a surface of {wanted:g} µm rms: mean ± scatter from spot to spot over
{surfaces} surfaces, in brackets the root of the expected mean square, summed from the spectrum without any surface.

Plateau below q0, wavelengths up to {SIDE * _UM:g} µm:

{_bias_table(found[printed])}

Nothing below q0:

{_bias_table(found[READINGS[1]])}

So a spot of 100 µm of a surface of {wanted:g} µm rms has {plateau.mean * _UM:.2f} ± {plateau.scatter * _UM:.2f} µm once
its curvature is removed **if the surface has the plateau** that the printed prefactor assumes; without one it has
{none.mean * _UM:.2f} ± {none.scatter * _UM:.2f} µm. The other way round, spots that show {wanted:g} µm without their
curvature lie on a surface of {wanted * printed.h_rms / plateau.expected:.1f} µm rms (plateau, λ0 = 100 µm). The model
takes {wanted:g} µm, measured on spots, for h_rms in Eqs. 8 to 15.

## What a fit finds

Plateau and power law fitted to {surfaces} surfaces with a plateau and to {SPOTS} spots (four of 400 µm) of each,
curvature removed: mean ± scatter over surfaces, pixels of {SIDE / COARSE * _UM:.2g} µm.

{_fit_table(surfaces)}

With Hann's window a fit starts at half the spot's length: longer modes are mixed by the window and thinned by the
detrending. So spots of 100 µm and of 200 µm cannot show a roll-off at 100 µm. The paper's λ0 = 100 µm is the length of
its spots, and `roughness_table` takes that length too when no roll-off is seen; the fit's own is a lower bound. The
window averages C over neighbouring modes, which lifts the steep low end of the spectrum and so H: the more, the fewer
pixels a spot has.
"""


def main(arguments: Sequence[str] | None = None) -> int:
    """Make the surfaces, draw and write."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--surfaces", type=positive(int), default=20, help="surfaces the spots are cut from")
    parser.add_argument("--docs", type=Path, default=_ROOT / "docs", help="folder of the page and its picture")
    args = parser.parse_args(arguments)
    surface = READINGS[0].surface((FINE, FINE), (SIDE, SIDE), seed=1)
    cut = list(spots(surface, SPOT))[::2]
    flat = [spot.detrended("curvature") for spot in cut]
    args.docs.mkdir(parents=True, exist_ok=True)
    draw(args.docs / "topography.png", surface, flat)
    text = page(flat, roughness_table(*cut), args.surfaces)
    replace(args.docs / "topography.md", text)
    print(args.docs / "topography.md")
    return 0


if __name__ == "__main__":
    sys.exit(main())
