# %% [markdown]
# # A sine voltage while sliding
#
# A haptic display drives its screen with $U(t) = \hat U \sin \omega t$. The attraction is proportional to the square of
# the voltage, so friction has twice the frequency of the voltage and no part at this frequency itself. The mean of the
# squared voltage is half its peak value. The model is quasi-static: time is only the order of the loads.

# %%
import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import fingerpad as fp
from fingerpad.startup import MPI

MU_0, PEAK, STEP = 0.25, 100.0, 20e-6  # 1, V, m
SMALL = Path(__file__).parent / "scenes" / "small_finger.toml"


# %% [markdown]
# A history is a list of loads; values that a load omits stay unchanged. The finger is pressed, slides until all points
# slip, and slides on while the voltage follows the sine. The model uses the magnitude of the voltage.


# %%
def history(f_ext: float, samples: int) -> list[dict]:
    """Return the loads of one period of the voltage, in ``samples`` steps."""
    phases = 2 * np.pi * np.arange(1, samples + 1) / samples
    loads = [{"name": "press", "f_ext": f_ext}, {"name": "slide", "bone_x": 400e-6}]
    for k, phase in enumerate(phases, start=1):
        loads.append({"name": f"sine {k}", "voltage": round(abs(PEAK * np.sin(phase)), 6), "bone_x": 400e-6 + k * STEP})
    return loads


# %%
def main(out: str = "results/demos/sine_voltage_while_sliding", samples: str = "12", size: str = "small") -> None:
    """Run one period in a multiple of 4 steps; with the size "full" on the default finger, which takes far longer."""
    n = int(samples)
    scene = fp.Scene.load(SMALL) if size == "small" else fp.Scene()
    f_ext = scene.f_ext
    scene = scene.replace(history=history(f_ext, n), output={"errors": False})
    result = fp.run(scene)
    assert not result.failure, result.failure
    ends = {state.load: state for state in result.steps}  # the last state of each load
    states = [ends["slide"], *(ends[f"sine {k}"] for k in range(1, n + 1))]
    U, f_t, f_el = np.array([(state.voltage, state.f_t, state.f_electrostatic) for state in states]).T
    spectrum = np.abs(np.fft.rfft(f_t[1:])) / n
    if MPI.COMM_WORLD.rank == 0:
        print(f"friction {f_t.min():.3f} to {f_t.max():.3f} N/m, mean over the period {f_t[1:].mean():.3f} N/m")
        print(f"share at the frequency of the voltage {spectrum[1]:.1e}, at twice it {spectrum[2]:.3f} N/m")
        draw(Path(out), U, f_t)
    assert all(state.all_slip for state in states)
    assert np.allclose(f_t, MU_0 * (f_ext + f_el), rtol=1e-6)
    # Friction is a function of the voltage's magnitude: the halves of the period are alike, and so are the frequencies.
    assert np.allclose(f_t[1 : n // 2 + 1], f_t[n // 2 + 1 :], rtol=1e-3)
    assert spectrum[1] < 1e-2 * spectrum[2]
    # It follows the square of the voltage, and more than that at the peak, where the attraction closes the gap.
    charged = U > 0.1 * PEAK
    per_square = (f_t[charged] - MU_0 * f_ext) / U[charged] ** 2
    assert per_square[U[charged] == U.max()].min() >= 0.999 * per_square.max()
    assert MU_0 * f_ext < f_t[1:].mean() <= (f_t.max() + MU_0 * f_ext) / 2 * (1 + 1e-6)


def draw(out: Path, U: np.ndarray, f_t: np.ndarray) -> None:
    """Write voltage and friction over the period."""
    above, below = (figure := Figure(figsize=(6, 5), layout="constrained")).subplots(2, 1, sharex=True)
    t, fine = np.linspace(0, 1, len(U)), np.linspace(0, 1, 401)
    above.plot(fine, PEAK * np.sin(2 * np.pi * fine), "-", color="#D55E00")
    above.plot(t, np.sign(np.round(np.sin(2 * np.pi * t), 9)) * U, "o", color="#D55E00")
    above.set(ylabel="voltage U (V)", title="Friction has twice the frequency of the voltage")
    below.plot(t, f_t, "o-", color="#0072B2")
    below.set(xlabel="time over the period", ylabel="friction force f_T (N/m)", ylim=(0, 1.1 * f_t.max()))
    out.mkdir(parents=True, exist_ok=True)
    figure.savefig(out / "sine.png", dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:])
