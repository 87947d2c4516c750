"""``fingerpad topography``: the roughness of a scene from a measured height map, without finite elements."""

import argparse
import math
import re
from collections.abc import Iterator, Sequence
from pathlib import Path
from typing import Any

from pydantic import ValidationError

from fingerpad.cli.arguments import PICTURE, Parser, echo, path
from fingerpad.results.style import plain
from fingerpad.scene import Scene, from_data, override
from fingerpad.scene.materials import Topography
from fingerpad.scene.messages import SceneError, clip
from fingerpad.scene.refusals import first_error
from fingerpad.scene.remarks import missing_waves, ridges_as_roughness
from variational.roughness.heightfile import Found, scan
from variational.roughness.spectrum import HURST, Fit, power_spectrum, roughness_table
from variational.roughness.topography import distribution

_EXAMPLES = """
    fingerpad topography skin.csv --unit um --size "100 um" "100 um" --plot skin.png
    fingerpad topography skin.vk4
"""


def main(argv: Sequence[str]) -> int:
    """Print the table of roughness that a height map gives; return the exit code."""
    parser = Parser("topography", _EXAMPLES)
    parser.add_argument("file", type=path, metavar="FILE", help="matrix of heights, or a file of an instrument")
    parser.add_table("roughness.topography")
    parser.add_file("--plot", PICTURE, "picture of map, heights and spectrum")
    args = parser.read(argv)
    found = _scan(args)
    flat = found.map.detrended("curvature")
    try:
        table = roughness_table(found.map)
        fit = power_spectrum(flat, window="hann").fit()
    except ValueError as error:
        raise SceneError(f"{clip(str(args.file), 80)}: {error}") from None
    echo("\n".join(_report(args.file, found, table, fit)))
    if args.plot:
        draw(args.plot, args.file.name, found, fit)
        echo(f"# Written: {args.plot}")
    return 0


def _scan(args: argparse.Namespace) -> Found:
    """Return the height map that is asked for.

    Raises:
        SceneError: it cannot be read.
    """
    given: dict[str, Any] = {name: getattr(args, name, None) for name in Topography.model_fields}
    for name in ("size", "pixel"):
        if given[name] is not None:
            given[name] = [override(f"{name}={length}")[1] for length in given[name]]
    try:
        return scan(**dict(Topography.model_validate(given | {"file": str(args.file)})))
    except OSError as error:
        raise SceneError(f"{clip(str(args.file), 80)} cannot be read: {error.strerror or error}") from None
    except ValidationError as error:
        raise SceneError(f"--{first_error(error, Topography, ())}") from None
    except (ValueError, ImportError) as error:
        raise SceneError(re.sub(r"'(unit|size|pixel|missing)'", r"--\1", str(error))) from None


def _report(file: Path, found: Found, table: dict[str, float], fit: Fit) -> Iterator[str]:
    """Yield the table of a scene, and as comments what was found."""
    m, um = found.map, 1e6
    heights = distribution(m.detrended("curvature"))
    (lx, ly), missing = m.size, found.missing
    yield f"# {clip(str(file), 80)}: {found.layout}"
    a, b = m.pixel
    yield f"# {lx * um:.4g} µm x {ly * um:.4g} µm, in pixels of {a * um:.4g} µm x {b * um:.4g} µm"
    yield f"# rms height {m.h_rms * um:.3g} µm, without curvature {heights.h_rms * um:.3g} µm"
    if missing:
        share = 100 * missing / m.heights.size
        yield f"# {missing} pixels missing ({share:.2g} %), filled smoothly, which makes h_rms a little smaller"
    yield f"# skewness {heights.skewness:.2f}, kurtosis {heights.kurtosis:.2f} (0 and 3 of the Gaussian of the model)"
    long, short = (2e6 * math.pi / q for q in fit.q_range)
    yield f"# {_hurst(fit)}, fitted between wavelengths of {long:.3g} µm and {short:.3g} µm"
    if fit.resolved:
        yield f"# roll-off at {fit.wavelength * um:.3g} µm: the largest wavelength"
    else:
        yield "# no roll-off within the map: the shorter side of the map stands for the largest wavelength"
    remarks = ridges_as_roughness(table["wavelength"], Scene().geometry.ridge_wavelength)
    for remark in remarks + missing_waves(min(m.size)):
        yield f"# {remark}"
    try:
        from_data({"roughness": {key: float(f"{value:.4g}") for key, value in table.items()}})
    except SceneError as error:
        yield f"# a scene refuses these values: {error}; is the unit of the heights right?"
    yield ""
    yield "[roughness]"
    for key, value in table.items():
        yield f"{key} = {value:.4g}"


def _hurst(fit: Fit) -> str:
    """Return the Hurst exponent in words."""
    if fit.hurst_found:
        return f"Hurst exponent {fit.hurst:.2f}"
    return f"Hurst exponent not found within {HURST[0]:g} to {HURST[1]:g}"


def draw(file: Path, name: str, found: Found, fit: Fit) -> None:
    """Draw the map without curvature, the distribution of its heights, and its spectrum with the fit."""
    import numpy as np

    from fingerpad.cli import plot

    flat, um = found.map.detrended("curvature"), 1e6
    heights, spectrum = distribution(flat), power_spectrum(flat, window="hann")
    with plot.panels(file, f"{plain(name)}: curvature removed", 3) as (figure, (area, shares, psd)):
        limit = float(np.abs(flat.heights).max()) * um
        ends = (0, flat.size[0] * um, 0, flat.size[1] * um)
        image = area.imshow(flat.heights.T * um, origin="lower", extent=ends, cmap="cividis", vmin=-limit, vmax=limit)
        figure.colorbar(image, ax=area, label="height (µm)", shrink=0.8)
        area.set(xlabel="x (µm)", ylabel="y (µm)")
        z = np.linspace(-4, 4, 200) * heights.h_rms
        middle = (heights.edges[1:] + heights.edges[:-1]) / 2
        plot.curve(shares, 0, middle * um, heights.density / um, "map")
        plot.curve(shares, 1, z * um, heights.gaussian(z) / um, f"Gaussian, {heights.h_rms * um:.3g} µm rms")
        shares.set(xlabel="height (µm)", ylabel="probability density (1/µm)")
        shares.set_ylim(0, 1.35 * float(heights.density.max()) / um)
        ring = spectrum.radial()
        kept = ring.psd > 0
        psd.loglog(ring.q[kept], ring.psd[kept], "o", ms=4, color="0.5", label="map, Hann's window")
        q = np.geomspace(*fit.q_range, 100)
        plot.curve(psd, 1, q, fit.psd(q), f"fit: {_hurst(fit)}")
        psd.set(xlabel="wavevector q (1/m)", ylabel="power spectrum C (m⁴)")
        for ax in (shares, psd):
            ax.legend()
