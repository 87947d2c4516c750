# %% [markdown]
# # Roughness, without finite elements
#
# Papillary ridges are rough on the scale of micrometres. The bearing area model reduces the roughness to one number for
# the scale of the finger: the equivalent air gap $d_{eq}(p_c)$. Smooth surfaces at this gap attract as the rough ones
# do under the mean contact pressure p_c,
#
# $$p_c = E^* q_0 h_{rms} e^{-\bar u / \gamma h_{rms}}, \qquad
#   p_{el} = \frac{\varepsilon_0 U^2}{2 (h_0 + d_{eq})^2}$$
#
# (Forsbach et al. 2023, doi 10.3389/fmech.2022.1074393, Eqs. 3, 9 and 13). The demo needs NumPy and SciPy alone.

# %%
import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import fingerpad as fp
from variational.roughness.spectrum import SelfAffine, power_spectrum

EPS_0 = 8.854e-12  # F/m


# %% [markdown]
# A measured surface comes from a file, by the command `fingerpad topography`. Here the surface is synthetic: Gaussian
# heights with a self-affine spectrum, $C(q) \propto q^{-2-2H}$ beyond q_0. The spectrum is then fitted as if measured.


# %%
def analysed(true: SelfAffine, pixels: int):
    """Return the heights and the spectrum of one synthetic surface, eight times lambda_0 wide."""
    size = 8 * true.wavelength
    heights = true.surface((pixels, pixels), (size, size), seed=1)
    return heights, power_spectrum(heights)


# %%
def main(out: str = "results/demos/roughness_without_dolfinx", pixels: str = "256") -> None:
    """Analyse a surface of ``pixels`` x ``pixels`` and use its roughness; figures go to the folder ``out``."""
    true = SelfAffine(h_rms=3.1e-6, hurst=0.75, wavelength=100e-6)
    heights, spectrum = analysed(true, int(pixels))
    fit = spectrum.fit()
    print(f"h_rms {heights.h_rms * 1e6:.2f} um, H {fit.hurst:.3f}, lambda_0 {fit.wavelength * 1e6:.1f} um")
    model = fp.BearingArea(fp.Scene().h_0, h_rms=heights.h_rms, wavelength=fit.wavelength)
    p_c = np.logspace(3, 5.3, 200)
    gap = model(p_c).d_eq
    for p in (1e4, 3e4, 1e5):
        d_eq = float(model(p).d_eq)
        print(f"{p / 1e3:5.0f} kPa: air gap {d_eq * 1e6:.2f} um, at 200 V {pull(model, d_eq, 200.0) / 1e3:.1f} kPa")
    draw(Path(out), spectrum, fit, p_c, gap, model)

    # The surface is the one that was asked for: one realisation scatters by some per cent, its modes being few.
    assert abs(heights.h_rms / true.h_rms - 1) < 0.1
    assert abs(fit.hurst - true.hurst) < 0.05 and abs(fit.wavelength / true.wavelength - 1) < 0.2 and fit.resolved
    # Parseval: the spectrum holds the mean square height.
    assert np.isclose(spectrum.h_rms, heights.h_rms, rtol=1e-12)
    # The closure's two laws agree: its attraction is Eq. 9's share of the area times that of a closed gap.
    u_bar = model.separation(p_c)
    assert np.allclose(model.contact_pressure(u_bar), p_c, rtol=1e-12)
    assert np.allclose(p_c - model.external_pressure(u_bar, 200.0), pull(model, gap, 200.0), rtol=1e-9)
    assert (np.diff(gap) < 0).all()  # pressure closes the gap
    assert not {"ufl", "dolfinx", "petsc4py", "mpi4py", "gmsh"} & set(sys.modules)


def pull(model: fp.BearingArea, d_eq, voltage: float):
    """Return the attraction (Pa) over an air gap (m), Eq. 3."""
    return EPS_0 * voltage**2 / 2 / (model.h_0 + d_eq) ** 2


def draw(out: Path, spectrum, fit, p_c: np.ndarray, gap: np.ndarray, model: fp.BearingArea) -> None:
    """Write the spectrum, the air gap and the attraction."""
    axes = (figure := Figure(figsize=(11, 3.6), layout="constrained")).subplots(1, 3)
    rings = spectrum.radial()
    axes[0].loglog(rings.q, rings.psd, "o", ms=4, color="#0072B2", label="the surface")
    axes[0].loglog(rings.q, fit.psd(rings.q), "k-", label=f"fit, H = {fit.hurst:.2f}")
    axes[0].set(xlabel="wavevector q (1/m)", ylabel="power spectrum C (m⁴)", title="Synthetic rough surface")
    axes[0].legend(frameon=False)
    axes[1].semilogx(p_c / 1e3, gap * 1e6, color="#0072B2")
    axes[1].set(xlabel="contact pressure p_c (kPa)", ylabel="equivalent air gap d_eq (µm)", ylim=(0, None))
    axes[1].set_title("Pressure closes the air gap")
    for voltage, style, colour in ((100.0, "--", "#009E73"), (200.0, "-", "#D55E00")):
        pulled = pull(model, gap, voltage)
        axes[2].semilogx(p_c / 1e3, pulled / 1e3, style, color=colour, label=f"{voltage:g} V")
    axes[2].set(
        xlabel="contact pressure p_c (kPa)", ylabel="attraction (kPa)", title="A closer ridge is attracted more"
    )
    axes[2].legend(frameon=False)
    out.mkdir(parents=True, exist_ok=True)
    figure.savefig(out / "roughness.png", dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:])
