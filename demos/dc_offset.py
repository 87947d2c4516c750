# %% [markdown]
# # What remains of a constant voltage
#
# A constant voltage attracts only until the charge has leaked through the gap: then the whole voltage lies across the
# insulator of the screen. What has leaked comes back with the other sign when the voltage changes its own. So a change
# of polarity attracts four times as much as switching on, and an offset under a sine does nothing in the end.

# %%
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import fingerpad as fp
from variational.attraction.circuit import Network

LAYERS = {"gap": 1.6e-6, "d_i": 1e-6, "eps_i": 3.9, "d_sc": 425e-6}  # m, 1, m
SINE = {"waveform": "sine", "amplitude": 100.0, "frequency": 50.0}
DRY = {"tissue": "dry", "leak": "sliding dry"}


# %% [markdown]
# `Network` solves the circuit in time, exactly for voltages that are straight between their times. Two equal times are
# a jump. The voltage is switched on, stays, and changes its sign.


# %%
def main(out: str = "results/demos/dc_offset") -> None:
    """Follow a constant voltage, and compare sines with and without an offset."""
    circuit = fp.GapCircuit("dry", "sliding dry")
    network = Network.of(circuit, **LAYERS)
    decay, half = network.decay(), 0.2
    after = np.geomspace(1e-5, half, 200)
    times = np.concatenate([[0.0, 0.0], after, [half], half + after])
    volts = np.where(np.arange(len(times)) == 0, 0.0, np.where(np.arange(len(times)) < 202, 200.0, -200.0))
    across = network.response(times, volts)
    on, off = np.abs(across[:202]).max(), np.abs(across[202:]).max()
    print(f"time constant of the leak {1e3 * decay:.1f} ms")
    print(f"of 200 V, {on:.0f} V lie across the gap after switching on, and {off:.0f} V after the change of sign")
    print(f"after {half:g} s {abs(across[201]):.2g} V are left")

    # %% [markdown]
    # With an offset, friction without losses has the frequency of the voltage and twice that. A leak takes the first.

    # %%
    found = {}
    for name, electric in (("lossless", {}), ("leak", DRY)):
        for offset in (0.0, 100.0):
            found[name, offset] = fp.drive(fp.Scene(voltage=SINE | {"offset": offset}, electric=electric))
            one, two = (found[name, offset].at(f) for f in (50.0, 100.0))
            print(f"{name}, offset {offset:3g} V: {one:.2f} N/m at 50 Hz, {two:.2f} N/m at 100 Hz")

    figure, (ax, other) = plt.subplots(1, 2, figsize=(9, 3.6), layout="constrained")
    ax.plot(1e3 * times, across)
    ax.set(xlabel="time (ms)", ylabel="voltage across the gap (V)", title="200 V, and -200 V from 200 ms on")
    looks = ("#999999", "-"), ("#000000", "--"), ("#0072B2", "-"), ("#E69F00", ":")
    for ((name, offset), each), (colour, dash) in zip(found.items(), looks, strict=True):
        other.plot(1e3 * each.time, each.f_t, dash, color=colour, lw=2, label=f"{name}, offset {offset:g} V")
    other.set(xlabel="time (ms)", ylabel="friction force (N/m)", title="sine of 100 V, 50 Hz")
    other.legend()
    Path(out).mkdir(parents=True, exist_ok=True)
    figure.savefig(Path(out) / "offset.png")

    # %% [markdown]
    # Assertions: twice the field after the change of sign, nothing left of a constant voltage, and an offset that is
    # blocked.

    # %%
    assert np.isclose(off, 2 * on, rtol=1e-2) and abs(across[201]) < 1e-4 * on
    assert found["lossless", 100.0].at(50.0) > found["lossless", 100.0].at(100.0) > 0
    assert found["leak", 100.0].at(50.0) == 0
    assert np.allclose(found["leak", 100.0].f_t, found["leak", 0.0].f_t, rtol=1e-9)


if __name__ == "__main__":
    main(*sys.argv[1:])
