# %% [markdown]
# # Pull-off and energy
#
# A charged ridge sticks. Lifted by displacement, the ridge bears a tension up to the pull-off force. Then it snaps off
# in a jump, and the stored energy is released: as heat and sound in a real finger. Energy is conserved,
#
# $$\Delta E_{stored} + E_{dissipated} + E_{released} = -\int f_{ext}\, dh$$
#
# with h the height of the bone. The voltage source does no further work in this sum, since the potential of the
# attraction at a constant voltage is part of the stored energy. A constant air gap does no work either.

# %%
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import fingerpad as fp
from fingerpad.startup import MPI

VOLTAGE = 180.0  # V


@dataclass(frozen=True)
class Held(fp.Closure):
    gap: float  # m

    def __call__(self, p_c):
        return fp.AirGap(self.gap + 0 * np.asarray(p_c, dtype=float))


# %% [markdown]
# The ridge is pressed, charged, and lifted by small steps until it is off. Friction opposes its spreading.


# %%
def main(out: str = "results/demos/pull_off_and_energy", step: str = "1e-6") -> None:
    """Lift a ridge by ``step`` (m) at a time; smaller steps draw a smoother curve."""
    ridge = fp.Body(
        fp.geometry.ridge(size=10e-6), fp.NeoHooke(86.76e3, 0.48), friction=0.25,
        roughness=Held(2e-6), h_0=0.51e-6,
    )  # fmt: skip
    ridge.press(1.0).charge(VOLTAGE)
    first, before = len(ridge.states) - 1, ridge.energy
    height = ridge.state.bone_height
    while ridge.state.contact_length > 0 or ridge.state.bone_height < 5e-6:
        height += float(step)
        ridge.lift(height)
        assert height < 50e-6, "the ridge does not let go"

    # The states since the ridge was charged: height of the bone, force on it, and whether the ridge jumped.
    states = ridge.states[first:]
    h, f = np.array([(state.bone_height, state.f_ext) for state in states]).T
    work = -np.trapezoid(f, h)
    after = ridge.energy
    stored, dissipated, released = (
        getattr(after, n) - getattr(before, n) for n in ("stored", "dissipated", "released")
    )
    records = [state.record for state in states]
    k = max(range(1, len(states)), key=lambda k: records[k].energy_released)  # the step of the jump
    if MPI.COMM_WORLD.rank == 0:
        print(f"pull-off force {-f.min():.4f} N/m at a height of {h[f.argmin()] * 1e6:.1f} um")
        print(f"stored {stored:+.4g}, dissipated {dissipated:.4g}, released {released:.4g}, work {work:.4g} J/m")
        draw(Path(out), h, f, k)
    assert f[0] > 0 > f.min() and abs(f.min()) < states[f.argmin()].f_electrostatic  # a pull
    # The balance closes: both sides are sums over some tens of steps with forces good for 1e-9 N/m.
    assert abs(stored + dissipated + released - work) < 1e-6 * abs(work)
    # The ridge lets go in a jump, which releases more than the error of that step's work.
    assert records[k].energy_released > records[k].released_error
    # Without contact nothing but the attraction at a distance pulls; without voltage nothing is left stored.
    ridge.lift(2e-3).charge(0.0)
    assert abs(ridge.energy.stored) < 1e-9 * abs(before.stored) and abs(ridge.state.f_ext) < 1e-8


def draw(out: Path, h: np.ndarray, f: np.ndarray, jump: int) -> None:
    """Write the force over the height."""
    axes = (figure := Figure(figsize=(6, 4), layout="constrained")).subplots()
    axes.axhline(0, color="0.7", lw=0.8)
    axes.plot(h[:jump] * 1e6, f[:jump], "o-", ms=3, color="#0072B2", label="in contact")
    axes.plot(h[jump - 1 : jump + 1] * 1e6, f[jump - 1 : jump + 1], ":", color="#D55E00", label="jump off the screen")
    axes.plot(h[jump:] * 1e6, f[jump:], "s-", ms=3, color="#D55E00", label="off the screen")
    axes.set(xlabel="height of the bone (µm)", ylabel="external force f_ext (N/m), negative: pulled")
    axes.set_title(f"A ridge at {VOLTAGE:g} V, lifted until it lets go")
    axes.legend(frameon=False)
    out.mkdir(parents=True, exist_ok=True)
    figure.savefig(out / "pull_off.png", dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:])
