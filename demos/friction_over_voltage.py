# %% [markdown]
# # Friction over voltage
#
# At 75 N/m, a voltage of 200 V doubles the friction of the default finger. The attraction per area across a gap d and
# an insulator of effective thickness h_0 is $p_{el} = \varepsilon_0 U^2 / 2 (h_0 + d)^2$. Coulomb's friction follows
# the contact force, $f_T = \mu_0 (f_{ext} + f_{el})$. So $\mu_{app} = \mu_0 (1 + f_{el} / f_{ext})$ grows with the
# square of the voltage at first, and faster later, since the attraction also narrows the gap.
#
# The model "cylinders" treats every ridge in contact as the same charged cylinder. This closed form computes hundreds
# of scenes in a second.

# %%
import sys
from pathlib import Path

import numpy as np
from matplotlib.figure import Figure

import fingerpad as fp
from fingerpad.reduced.cylinders import tip_radius
from fingerpad.startup import MPI
from variational.attraction.cylinder import Cylinder
from variational.attraction.tip import Round

MU_0 = 0.25
SMALL = Path(__file__).parent / "scenes" / "small_finger.toml"


# %% [markdown]
# For comparison: the full model with finite elements of every ridge, here of a small finger. The model "cylinders"
# contains the contact length of the default finger without voltage. For another finger it is that of the full model: by
# Hertz's law it is the modulus of a ridge.


# %%
def beside(voltage: float, scene: fp.Scene) -> tuple[float, float]:
    """Return µ_app of the full model and of the cylinders at a voltage (V)."""
    scene = scene.replace(voltage=voltage)
    result = fp.run(scene)
    slip, press = result.full_slip, result.uncharged
    assert abs(slip.f_t - MU_0 * slip.f_contact) < 1e-6 * slip.f_ext
    n, tip = press.ridges_in_contact, Round(tip_radius(scene.geometry))
    modulus = tip.modulus(scene.f_ext / n, press.contact_length / n).item()
    (ridge,) = Cylinder(tip, modulus, scene.h_0, scene.closure()).under_loads([scene.f_ext / n], voltage)
    return slip.mu_app, MU_0 * n * ridge.f_contact / scene.f_ext


# %%
def main(out: str = "results/demos/friction_over_voltage", size: str = "small") -> None:
    """Sweep the voltage; with the size "full" the full model is the default finger's, which takes longer."""
    voltages = np.linspace(0.0, 200.0, 41)
    curve = fp.sweep(fp.Scene(), Path(out) / "cylinders", model="cylinders", f_ext=[25, 75], voltage=voltages)
    mu = curve.array("mu_app")  # shape (2, 41)
    scene = fp.Scene.load(SMALL) if size == "small" else fp.Scene()
    scene = scene.replace(output={"errors": False})
    points = [0.0, 100.0] if size == "small" else [0.0, 100.0, 200.0]
    found = np.array([beside(voltage, scene) for voltage in points])
    if MPI.COMM_WORLD.rank == 0:
        for voltage, (full, cylinders) in zip(points, found, strict=True):
            print(f"{voltage:5.0f} V: full model {full:.4f}, cylinders {cylinders:.4f}")
        draw(Path(out), voltages, mu, points, found, f"{size} finger, {scene.f_ext:g} N/m")
    assert np.allclose(mu[:, 0], MU_0) and np.allclose(found[0], MU_0, rtol=1e-6)  # no voltage, no attraction
    assert (np.diff(mu, axis=1) > 0).all() and (mu[0, 1:] > mu[1, 1:]).all()  # it weighs more on a light load
    # At least the square of the voltage: the gap closes.
    assert ((mu[:, -1] - MU_0) > 4 * (mu[:, 20] - MU_0)).all()
    # The closed form of one mean ridge is some per cent off the finger's ridges, no more than a tenth.
    assert np.allclose(found[:, 0], found[:, 1], rtol=0.1)


def draw(out: Path, voltages: np.ndarray, mu: np.ndarray, points: list, found: np.ndarray, what: str) -> None:
    """Write the friction over the voltage."""
    axes = (figure := Figure(figsize=(6.4, 4.2), layout="constrained")).subplots()
    for values, f_ext, style, colour in zip(mu, (25, 75), ("-", "--"), ("#D55E00", "#0072B2"), strict=True):
        axes.plot(voltages, values, style, color=colour, label=f"cylinders, default finger, {f_ext} N/m")
    axes.plot(points, found[:, 0], "ko", label=f"full model, {what}")
    axes.plot(points, found[:, 1], "k+", ms=14, label=f"cylinders, {what}")
    axes.set(xlabel="voltage U (V)", ylabel="apparent friction µ_app", title="Friction at full slip", ylim=(0, None))
    axes.legend(frameon=False)
    figure.savefig(out / "friction.png", dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:])
