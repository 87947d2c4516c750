# %% [markdown]
# # A coating by design
#
# A screen of 100 V is to raise friction by 10 % under a finger that presses with 1 N. How thick is its coating, and how
# exactly must it be made? The closed form computes the thickness at once. The full model goes on from there by Newton's
# method, with the slopes of its runs. The same slopes give the tolerance: the change $\Delta\mu / \mu_0$ of friction
# stays within $\pm \varepsilon$ of 10 % for
#
# $$|\Delta d| \le \varepsilon\, \mu_0 \,/\, |\partial \mu_{app} / \partial d|.$$

# %%
import sys
from pathlib import Path

from matplotlib.figure import Figure

import fingerpad as fp

MU_0, CHANGE, WITHIN = 0.25, 0.10, 0.01
SMALL = Path(__file__).parent / "scenes" / "small_finger.toml"


# %%
def main(out: str = "results/demos/design_a_coating", size: str = "small") -> None:
    """Design the coating; with the size "full" the full model is the default finger's, which takes longer."""
    scene = fp.Scene(force="1 N", voltage=100.0)
    (closed,) = fp.solve(scene, "electric.d_i", mu_app=1 + CHANGE, relative=True).roots
    middle = fp.Scene(f_ext=closed.results[0].full_slip.f_ext) if size == "full" else fp.Scene.load(SMALL)
    middle = middle.replace(voltage=100.0, electric={"d_i": closed.keys[0]}, output={"errors": False})
    solution = fp.solve(middle, "electric.d_i", mu_app=(1 + CHANGE) * MU_0, model="full")
    (full,) = solution.roots
    slopes = full.results[0].sensitivities("mu_app")
    tolerance = WITHIN * MU_0 / abs(float(slopes.slope.sel(number="electric.d_i")))
    print(f"Closed form, whole finger, 1 N: {1e6 * closed.keys[0]:.1f} µm.")
    print(
        f"Full model, middle section of the {size} finger, {len(solution.states)} states: {1e6 * full.keys[0]:.1f} µm."
    )
    print(f"Friction changes by {100 * CHANGE:g} ± {100 * WITHIN:g} % within ± {1e6 * tolerance:.1f} µm.")

    figure = Figure(figsize=(6.4, 3.2), layout="constrained")
    ax = figure.subplots()
    most = slopes.isel(number=slice(8))
    ax.barh(most.number.values, most.elasticity.values, color="#0072B2")
    ax.invert_yaxis()
    ax.set(xlabel="% of friction for 1 % of the number", title="What else moves friction here")
    Path(out).mkdir(parents=True, exist_ok=True)
    figure.savefig(Path(out) / "coating.png", dpi=150)

    # %% [markdown]
    # Assertions: the target is met, and a coating that is thinner by the tolerance changes friction by 11 %, but for
    # the curvature between.

    # %%
    assert abs(full.numbers[0].value / MU_0 - 1 - CHANGE) < 2e-4
    thinner = fp.run(full.scene, electric={"d_i": full.keys[0] - tolerance}).full_slip
    assert abs(thinner.mu_app / MU_0 - 1 - CHANGE - WITHIN) < WITHIN / 5


if __name__ == "__main__":
    main(*sys.argv[1:])
