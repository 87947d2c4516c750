# %% [markdown]
# # A sine voltage while sliding
#
# A haptic display drives its screen with $U(t) = \hat U \sin \omega t$. The attraction is proportional to the square of
# the voltage, so friction has twice the frequency of the voltage and no part at this frequency itself. The mean of the
# squared voltage is half its peak value. The model is quasi-static, without inertia. This finger has
# elastic skin, friction without time and no losses of the drive, so that a frequency sets how far it slides in a
# period.

# %%
import sys
from pathlib import Path

import numpy as np

import fingerpad as fp
from fingerpad.startup import MPI

MU_0, PEAK = 0.25, 100.0  # 1, V
SCENES = Path(__file__).parent / "scenes"


# %% [markdown]
# A history is a list of loads; values that a load omits stay unchanged. The finger is pressed, slides until all points
# slip, and slides on while the voltage follows the sine for one period. A load with a speed, a duration or a waveform
# takes time. `scenes/sine_while_sliding.toml` has the default finger under the voltage of the paper's Fig. 9B: of it
# energy densities at the Merkel sites are drawn, and below them the spikes of slowly adapting fibres.


# %%
def main(out: str = "results/demos/sine_voltage_while_sliding", scale: str = "1", size: str = "small") -> None:
    """Run one period; a scale of 0.5 takes twice the samples; the size "full" is Fig. 9B, which takes far longer."""
    wave = {"waveform": "sine", "amplitude": PEAK, "frequency": "60 Hz"}
    small = fp.Scene.load(SCENES / "small_finger.toml")
    loads = [
        {"name": "press", "f_ext": small.f_ext},
        {"name": "slide", "bone_x": "400 um"},
        {"name": "sine", "bone_x_by": "240 um", "duration": 1 / 60, "voltage": wave},
    ]
    scene = small.replace(history=loads) if size == "small" else fp.Scene.load(SCENES / "sine_while_sliding.toml")
    scene = scene.replace(output={"errors": False}, numerics={"step_scale": float(scale)})
    result = fp.run(scene)
    assert not result.failure, result.failure
    sine = result.loads[-1].over_time
    states = [state for state in result.steps if state.load == "sine"]
    U, f_t, f_el, f_ext = np.array([(s.voltage, s.f_t, s.f_electrostatic, s.f_ext) for s in states]).T
    spectrum = sine.f_t_amplitude
    if MPI.COMM_WORLD.rank == 0:
        print(f"friction {f_t.min():.3f} to {f_t.max():.3f} N/m, mean over the period {sine.mean['f_t']:.3f} N/m")
        print(f"share at the frequency of the voltage {spectrum[0]:.1e}, at twice it {spectrum[1]:.3f} N/m")
        Path(out).mkdir(parents=True, exist_ok=True)
        result.plot("time", Path(out) / "sine.png")
        if scene.output.receptors:  # energy densities at Merkel sites, and below them spikes of the fibres there
            result.afferents("SA1").plot(Path(out) / "spikes.png")
    assert all(state.all_slip for state in states)
    assert np.allclose(f_t, MU_0 * (f_ext + f_el), rtol=1e-6)
    # Friction is a function of the voltage's amount alone: its frequency is twice the voltage's.
    assert max(spectrum[0::2]) < 1e-2 * spectrum[1]
    # It follows the square of the voltage, and more than that at the peak, where the attraction closes the gap.
    charged = abs(U) > 0.1 * abs(U).max()
    per_square = (f_t - MU_0 * f_ext)[charged] / U[charged] ** 2
    assert per_square[abs(U[charged]) == abs(U).max()].min() >= 0.999 * per_square.max()
    assert (MU_0 * f_ext).max() < sine.mean["f_t"] <= (f_t.max() + (MU_0 * f_ext).max()) / 2 * (1 + 1e-6)


if __name__ == "__main__":
    main(*sys.argv[1:])
