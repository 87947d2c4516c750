# %% [markdown]
# # Your own microscale closure
#
# A closure gives the air gap of a ridge under its mean contact pressure. The bearing area model is the default closure;
# a constant gap g is the simplest one. A closure is one class with one method, and the solver stays unchanged.
#
# A flat block has the gap g along its whole foot. Its friction then has a closed form,
#
# $$f_T = \mu_0 \Big(f_{ext} + \frac{\varepsilon_0 U^2}{2 (h_0 + g)^2} L\Big)$$
#
# with the current length L of the foot. The trailing edge lifts by less than the gap, and is attracted as well.

# %%
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import fingerpad as fp
from fingerpad.startup import MPI

EPS_0, MU_0, H_0, F_EXT, VOLTAGE = 8.854e-12, 0.25, 0.51e-6, 20.0, 150.0
SMALL = Path(__file__).parent / "scenes" / "small_finger.toml"


@dataclass(frozen=True)
class ConstantGap(fp.Closure):
    gap: float  # m

    def __call__(self, p_c):
        return fp.AirGap(self.gap + 0 * np.asarray(p_c, dtype=float))  # of the shape of the pressures


# %% [markdown]
# The block is 1 mm wide and 0.2 mm high, so that it slides flat.


# %%
def friction(gap: float) -> tuple[float, float]:
    """Return the friction force (N/m) of the block, by finite elements and in closed form."""
    shape, material = fp.geometry.block(1e-3, 0.2e-3, 50e-6), fp.NeoHooke(86.76e3, 0.48)
    block = fp.Body(shape, material, friction=MU_0, roughness=ConstantGap(gap), h_0=H_0)
    state = block.press(F_EXT).charge(VOLTAGE).slide(until_full_slip=True).state
    pull = EPS_0 * VOLTAGE**2 / 2 / (H_0 + gap) ** 2  # Pa
    x, y = (block.coordinates + block.displacement)[block.coordinates[:, 1] < 1e-9].T
    assert y.max() < gap
    return state.f_t, MU_0 * (F_EXT + pull * np.ptp(x))


# %%
def main(out: str = "results/demos/own_closure", size: str = "small") -> None:
    """Slide blocks with constant gaps, then a finger; with the size "full" the default finger, far slower."""
    gaps = np.array([1e-6, 1.5e-6, 2e-6, 3e-6])
    found, exact = np.array([friction(gap) for gap in gaps]).T
    scene = fp.Scene.load(SMALL) if size == "small" else fp.Scene()
    finger = fp.run(scene.replace(output={"errors": False}, roughness=ConstantGap(2e-6)))
    slip = finger.full_slip
    inside = EPS_0 * slip.voltage**2 / 2 / (scene.h_0 + 2e-6) ** 2 * slip.contact_length
    if MPI.COMM_WORLD.rank == 0:
        for gap, a, b in zip(gaps, found, exact, strict=True):
            print(f"block, gap {gap * 1e6:.1f} um: friction {a:.6f} N/m, closed form {b:.6f} N/m")
        print(f"finger: µ_app {slip.mu_app:.4f}; {inside:.3f} of {slip.f_electrostatic:.3f} N/m attract inside contact")
        print(finger.record["laws"]["closure"])
        draw(Path(out), gaps, found)
    # The whole foot has the gap, so that the closed form is exact: what the solves leave is a millionth at most.
    assert np.allclose(found, exact, rtol=1e-6)
    # Ridges are round: the skin beside the contact is near the screen and is attracted too.
    assert np.allclose(slip.d_eq, 2e-6)
    assert inside < slip.f_electrostatic
    assert np.isclose(slip.mu_app, MU_0 * (1 + slip.f_electrostatic / slip.f_ext), rtol=1e-6)


def draw(out: Path, gaps: np.ndarray, found: np.ndarray) -> None:
    """Write the friction over the gap."""
    axes = (figure := Figure(figsize=(6, 4), layout="constrained")).subplots()
    g = np.linspace(0.8e-6, 3.2e-6, 200)
    axes.plot(
        g * 1e6, MU_0 * (F_EXT + EPS_0 * VOLTAGE**2 / 2 / (H_0 + g) ** 2 * 1e-3), "k-", label="closed form, L = 1 mm"
    )
    axes.plot(gaps * 1e6, found, "o", color="#D55E00", label="finite elements")
    axes.axhline(MU_0 * F_EXT, ls=":", color="#0072B2", label="without voltage")
    axes.set(xlabel="air gap g (µm)", ylabel="friction force f_T (N/m)", ylim=(0, None))
    axes.set_title(f"A flat block of constant air gap at {VOLTAGE:g} V, {F_EXT:g} N/m")
    axes.legend(frameon=False)
    out.mkdir(parents=True, exist_ok=True)
    figure.savefig(out / "friction.png", dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:])
