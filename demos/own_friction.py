# %% [markdown]
# # Your own friction law
#
# Derjaguin (1934, Zeitschrift für Physik 88, pages 661 to 675) adds to Coulomb's friction a part of
# molecular adhesion wherever there is contact, $t = \mu p + \tau_0$. At p = 0 the limit would jump from 0 to τ_0, and
# Newton's method would alternate between contact and no contact. So τ_0 begins smoothly,
#
# $$t_{max}(p) = \mu p + \tau_0 \frac{p}{\sqrt{p^2 + p_{reg}^2}}$$
#
# A law is one class with the limit t_max(p), written with arithmetic alone. The part of τ_0 goes with the area in
# contact, whose ends lie within facets: `limit_over` gives it the share of the area.

# %%
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import fingerpad as fp
from fingerpad.startup import MPI

SMALL = Path(__file__).parent / "scenes" / "small_finger.toml"
MU, TAU_0, WIDTH = 0.3, 5e3, 1e-3  # 1, Pa, m (of the block)


@dataclass(frozen=True)
class Mine(fp.Friction):
    mu: float
    tau_0: float  # Pa
    p_reg: float = 1e3  # Pa

    def limit(self, p):
        return self.mu * p + self.tau_0 * p / (p**2 + self.p_reg**2) ** 0.5

    def limit_over(self, part, *memory):
        return self.mu * part.p + self.tau_0 * part.share(self.p_reg)


# %% [markdown]
# A flat block slides on a foot of 1 mm, of which the trailing end lifts a little. At full slip its friction is
# $\mu f_c + \tau_0 L_R$, less the regularisation's part, $\tau_0 p_{reg}^2 / 2 p^2$ at pressure p.


# %%
def slid(law: fp.Friction, f_ext: float) -> fp.Body:
    """Return the block in full slip under a force (N/m)."""
    block = fp.Body(fp.geometry.block(WIDTH, 0.1e-3, 25e-6), fp.NeoHooke(86.76e3, 0.48), friction=law)
    return block.press(f_ext).slide(until_full_slip=True)


# %%
def main(out: str = "results/demos/own_friction", size: str = "small") -> None:
    """Slide blocks, then a finger; with the size "full" the default finger, far slower."""
    forces = np.array([15.0, 30.0, 45.0])
    blocks = [slid(Mine(MU, TAU_0), force) for force in forces]
    found = np.array([block.state.f_t for block in blocks])
    lengths = np.array([block.state.contact_length for block in blocks])
    exact = MU * forces + TAU_0 * lengths
    built_in = slid(fp.Derjaguin(MU, TAU_0), forces[0])
    scene = fp.Scene.load(SMALL) if size == "small" else fp.Scene()
    finger = fp.run(scene.replace(voltage=0.0, output={"errors": False}, friction=Mine(MU, TAU_0)))
    slip = finger.full_slip
    if MPI.COMM_WORLD.rank == 0:
        for force, f_t, closed in zip(forces, found, exact, strict=True):
            print(f"block, {force:g} N/m: friction {f_t:.4f} N/m, mu f_c + tau_0 L_R = {closed:.4f} N/m")
        print(f"finger: µ_app {slip.mu_app:.4f}, with Coulomb's law it is {MU}")
        print(finger.record["laws"]["friction"])
        draw(Path(out), forces, found)
    # Equal laws, equal numbers, but for the solver's tolerance.
    assert np.isclose(found[0], built_in.state.f_t, rtol=1e-8)
    # The regularisation takes a per cent of tau_0, near the ends of the foot, where the pressure falls to nothing.
    # Under load the foot is up to 3 % longer than unloaded, and tractions are those of the unloaded foot.
    assert (found < exact).all() and (exact - found < 0.05 * TAU_0 * lengths).all()
    # On a finger: more than Coulomb's law, and less than with all of tau_0 over the length in contact.
    coulomb, all_of_it = MU * slip.f_contact, TAU_0 * slip.contact_length
    assert coulomb < slip.f_t < coulomb + 1.1 * all_of_it  # a tenth: lengths are current, tractions of reference area


def draw(out: Path, forces: np.ndarray, found: np.ndarray) -> None:
    """Write the friction over the load."""
    axes = (figure := Figure(figsize=(6, 4), layout="constrained")).subplots()
    f = np.array([0, forces.max() * 1.05])
    axes.plot(f, MU * f + TAU_0 * WIDTH, "k-", label="µ f_c + τ₀ L_R, L_R = 1 mm")
    axes.plot(f, MU * f, "--", color="#0072B2", label="Coulomb, µ f_c")
    axes.plot(forces, found, "o", color="#D55E00", label="finite elements")
    axes.set(xlabel="external force f_ext (N/m)", ylabel="friction force f_T (N/m)", ylim=(0, None))
    axes.set_title("A flat block with Derjaguin's friction law")
    axes.legend(frameon=False)
    out.mkdir(parents=True, exist_ok=True)
    figure.savefig(out / "friction.png", dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:])
