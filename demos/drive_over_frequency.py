# %% [markdown]
# # Friction over the frequency of the voltage
#
# A display drives its screen with alternating voltages. Screen, air gap and stratum corneum lie in series. Charge leaks
# through the gap at low frequencies, and the stratum corneum takes a growing share of the voltage at high ones. In
# between lies a peak. The share of the gap is
#
# $$ \left| \frac{E g}{U} \right|^2 = \frac{1}{|1 + (Z_i + Z_{sc}) Y_g|^2}, \qquad
#    Y_g = \frac{i \omega \varepsilon_0}{g} + \frac{1}{R_{gap}} . $$
#
# The leak R_gap is the one constant that no source gives. Here it is set by a published peak at 250 Hz.

# %%
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import fingerpad as fp
from variational.attraction.circuit import fit_leak

LAYERS = {"gap": 1.6e-6, "d_i": 1e-6, "eps_i": 3.9, "d_sc": 425e-6}  # m, 1, m
FREQUENCIES = np.geomspace(1, 1e6, 61)  # Hz


# %% [markdown]
# `fp.GapCircuit` computes the share over the frequency. Its lossless limit is Eq. 3 of the paper, at every frequency.


# %%
def main(out: str = "results/demos/drive_over_frequency") -> None:
    """Draw share and friction over the frequency."""
    leak = fit_leak(250.0, "dry", **LAYERS)
    circuits = {
        "lossless": fp.GapCircuit(),
        "dry, no leak": fp.GapCircuit("dry"),
        f"dry, R_gap {leak:.0f} ohm m²": fp.GapCircuit("dry", leak),
    }
    shares = {name: circuit.share(FREQUENCIES, **LAYERS) for name, circuit in circuits.items()}
    lossless, no_leak, leaky = shares.values()
    print(f"R_gap {leak:.0f} ohm m² for a peak at 250 Hz")
    print(f"share of the gap: {lossless[0]:.3f} lossless, {leaky.max():.3f} at the peak, {leaky[-1]:.3f} at 1 MHz")

    # %% [markdown]
    # `fp.drive` computes the friction over one period, by the closed form. Friction has twice the frequency of the
    # voltage.

    # %%
    friction = {}
    for frequency in (10.0, 30.0, 100.0, 250.0, 1e3, 1e4):
        wave = {"waveform": "sine", "amplitude": "200 V", "frequency": frequency}
        friction[frequency] = fp.drive(fp.Scene(voltage=wave, electric={"tissue": "dry", "leak": leak}))
    for frequency, found in friction.items():
        twice = found.at(2 * frequency)
        print(f"{frequency:6g} Hz: mean friction {found.f_t.mean():.2f} N/m, amplitude at 2 f {twice:.2f} N/m")

    figure, (ax, other) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    for (name, share), look in zip(shares.items(), ("k:", "C1--", "C0-"), strict=True):
        ax.semilogx(FREQUENCIES, share, look, label=name)
    ax.set(xlabel="frequency (Hz)", ylabel="share of the gap |E g / U|² (–)")
    ax.legend()
    other.semilogx(list(friction), [found.f_t.mean() for found in friction.values()], "o-")
    other.set(xlabel="frequency (Hz)", ylabel="mean friction force (N/m), 200 V amplitude")
    Path(out).mkdir(parents=True, exist_ok=True)
    figure.savefig(Path(out) / "share.png")

    # %% [markdown]
    # Assertions: Eq. 3, a leak that makes no difference at high frequencies, and the peak.

    # %%
    h_0 = fp.Scene().h_0
    assert np.allclose(lossless, (LAYERS["gap"] / (LAYERS["gap"] + h_0)) ** 2, rtol=1e-12)
    assert np.allclose(leaky[FREQUENCIES > 1e5], no_leak[FREQUENCIES > 1e5], rtol=1e-3)
    assert np.all(leaky <= no_leak * (1 + 1e-2)) and 200 < FREQUENCIES[leaky.argmax()] < 320
    means = {frequency: found.f_t.mean() for frequency, found in friction.items()}
    assert max(means, key=means.get) == 250.0 and means[10.0] < means[1e4] < means[250.0]
    assert all(found.at(frequency) == 0 < found.at(2 * frequency) for frequency, found in friction.items())


if __name__ == "__main__":
    main(*sys.argv[1:])
