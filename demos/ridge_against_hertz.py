# %% [markdown]
# # One ridge against Hertz
#
# A long elastic cylinder of radius R, pressed on a rigid plane with a force f per length, touches it over a strip of
# half-width a under a pressure that is half an ellipse (Johnson, Contact Mechanics, 1985, section 4.2):
#
# $$a = \sqrt{\frac{4 f R}{\pi E^*}}, \qquad p(x) = \frac{2 f}{\pi a} \sqrt{1 - x^2 / a^2}, \qquad
#   E^* = \frac{E}{1 - \nu^2}$$
#
# The theory holds for small strains on a half-space. So a is small here compared with R and with the pad's height.

# %%
import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import fingerpad as fp
from fingerpad.startup import MPI

YOUNG, POISSON, RADIUS, HALF_WIDTH = 1e6, 0.3, 10e-3, 50e-6  # Pa, 1, m, m
E_STAR = YOUNG / (1 - POISSON**2)
FORCE = np.pi * E_STAR * HALF_WIDTH**2 / (4 * RADIUS)  # N/m
PEAK = 2 * FORCE / (np.pi * HALF_WIDTH)  # Pa


# %% [markdown]
# The pad has n facets over the half-width. The springs of the screen are a hundred times as stiff as a facet, so that
# their effect vanishes as the mesh is refined.


# %%
def pressed(n: int) -> fp.Body:
    size = HALF_WIDTH / n
    shape = fp.geometry.pad(size=size, facets=3 * n // 2, radius=RADIUS, span=200 * HALF_WIDTH)
    stiff = 100 * E_STAR / size  # Pa/m
    springs = fp.Penalty(stiff, stiff)
    return fp.Body(shape, fp.SaintVenant(YOUNG, POISSON), contact=springs, touch_depth=50e-9).press(FORCE)


# %% [markdown]
# The skin's pressure is an array of facets and Gauss points. With stiff springs the pressure alternates inside a facet,
# but not its mean over a facet. The mean of the central facets is the peak.


# %%
def profile(body: fp.Body) -> tuple[np.ndarray, np.ndarray]:
    """Return abscissa (m) and mean contact pressure (Pa) of each facet."""
    weights = np.polynomial.legendre.leggauss(body.skin.p_n.shape[1])[1] / 2
    return body.skin.x @ weights, body.skin.p_n @ weights


# %%
def main(out: str = "results/demos/ridge_against_hertz", finest: str = "16") -> None:
    """Press three pads, the finest with ``finest`` facets over the half-width (a multiple of 4); draw into ``out``."""
    facets = [int(finest) // 4, int(finest) // 2, int(finest)]
    bodies = [pressed(n) for n in facets]
    widths = np.array([body.state.contact_length / 2 for body in bodies])
    profiles = [profile(body) for body in bodies]
    peaks = np.array([p[np.abs(x) < HALF_WIDTH / 4].mean() for x, p in profiles])
    core = np.sqrt(1 - np.linspace(-0.25, 0.25, 101) ** 2).mean() * PEAK  # Hertz over the same facets
    if MPI.COMM_WORLD.rank == 0:
        print(f"Hertz: a = {HALF_WIDTH * 1e6:.2f} um, p = {core / 1e3:.4f} kPa over its inner quarter")
        for n, a, p in zip(facets, widths, peaks, strict=True):
            print(f"{n:3d} facets: a = {a * 1e6:.2f} um, p = {p / 1e3:.4f} kPa")
        draw(Path(out), facets, profiles)
    # Facets are curved as the pad is, and four of them over the half-width give both to 0.1 %. What is left on the
    # finest mesh is the pad's finite size.
    for values, hertz in ((widths, HALF_WIDTH), (peaks, core)):
        assert np.ptp(values) < 1e-3 * values[2]
        assert abs(values[2] / hertz - 1) < 5e-3
    # The screen bears the force.
    assert np.allclose([body.state.f_contact for body in bodies], FORCE, rtol=1e-6)


def draw(out: Path, facets: list[int], profiles: list) -> None:
    """Write the pressures over the abscissa."""
    axes = (figure := Figure(figsize=(6, 4), layout="constrained")).subplots()
    x = np.linspace(-1, 1, 401)
    axes.plot(x * HALF_WIDTH * 1e6, PEAK * np.sqrt(1 - x**2) / 1e3, "k-", label="Hertz")
    for n, (at, p), mark, colour in zip(facets, profiles, "osx", ("#D55E00", "#009E73", "#0072B2"), strict=True):
        axes.plot(at * 1e6, p / 1e3, mark, ms=5, color=colour, label=f"{n} facets over a")
    axes.set(xlabel="x (µm)", ylabel="contact pressure p (kPa)", title="A pad pressed on a rigid screen")
    axes.set_xlim(-1.6 * HALF_WIDTH * 1e6, 1.6 * HALF_WIDTH * 1e6)
    axes.legend(frameon=False)
    out.mkdir(parents=True, exist_ok=True)
    figure.savefig(out / "pressure.png", dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:])
