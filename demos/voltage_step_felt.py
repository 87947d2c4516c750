# %% [markdown]
# # What a step of the voltage does to fibres
#
# A display switches its voltage on while a finger slides, and off again. Friction rises and falls by the same amount.
# The skin of this finger is elastic, so friction follows the voltage at once. Rise and fall then differ by the
# mechanics of contact and by the fibres alone. A scene may also have viscous layers.

# %%
import sys
from pathlib import Path

import matplotlib.pyplot as plt
import numpy as np

import fingerpad as fp
from fingerpad.startup import MPI

SCENES = Path(__file__).parent / "scenes"
SPEED, STEP = 20e-3, 10e-3  # m/s, s
VOLTS = 150.0


# %% [markdown]
# The finger is pressed and slid to full slip first. Then it slides on at 20 mm/s while the voltage rises in 10 ms,
# stays, and falls in 10 ms. The voltage is a table of times and values.


# %%
def main(out: str = "results/demos/voltage_step_felt", size: str = "small") -> None:
    """Switch a voltage on and off; the size "full" is the default finger under 75 N/m, which takes far longer."""
    small = size == "small"
    scene = fp.Scene.load(SCENES / "small_finger.toml") if small else fp.Scene()
    times = np.array([0.0, 0.02, 0.02 + STEP, 0.06, 0.06 + STEP, 0.1])
    table = {"waveform": "file", "times": times.tolist(), "values": [0.0, 0.0, VOLTS, VOLTS, 0.0, 0.0]}
    loads = [
        {"name": "press", "f_ext": 10.0 if small else 75.0},
        {"name": "slide", "bone_x": 800e-6 if small else 3e-3},
        {"name": "step", "bone_x_by": SPEED * times[-1], "voltage": table},
    ]
    output = {"errors": False, "receptors": True, "each_load": False}
    mesh = {"contact": 40e-6} if small else {"contact": 20e-6}
    result = fp.run(scene.replace(history=loads, output=output, mesh=mesh))
    spikes = result.afferents(["SA1", "RA1"])
    steps = [state for state in result.steps if state.load == "step"]
    rise, fall = (spikes.between("RA1", begin, begin + 2 * STEP) for begin in (times[1], times[3]))
    if MPI.COMM_WORLD.rank == 0:
        print(spikes)
        print(f"friction {steps[0].f_t:.3f} N/m without voltage, {max(s.f_t for s in steps):.3f} N/m with it")
        print(f"RA1 spikes within {2e3 * STEP:.0f} ms of the rise {rise}, of the fall {fall}")
        Path(out).mkdir(parents=True, exist_ok=True)
        spikes.plot(Path(out) / "raster.png")
        figure, ax = plt.subplots(figsize=(7, 3), layout="constrained")
        ax.plot([1e3 * s.time for s in steps], [s.f_t for s in steps], color="#0072B2")
        ax.set(xlabel="time (ms)", ylabel="friction force (N/m)", title="A voltage is switched on and off")
        figure.savefig(Path(out) / "friction.png")

    # %% [markdown]
    # Assertions: the finger slips throughout, friction is Coulomb's of force and attraction, and comes back. No RA-I
    # fibre fires while the voltage stays.

    # %%
    assert all(state.all_slip for state in steps)
    assert np.allclose([s.f_t for s in steps], [0.25 * (s.f_ext + s.f_electrostatic) for s in steps], rtol=1e-6)
    assert np.isclose(steps[-1].f_t, steps[0].f_t, rtol=1e-3) and max(s.f_t for s in steps) > 1.05 * steps[0].f_t
    assert rise > 0 and spikes.between("RA1", times[2] + STEP, times[3]) == 0


if __name__ == "__main__":
    main(*sys.argv[1:])
