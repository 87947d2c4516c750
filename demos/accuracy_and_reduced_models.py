# %% [markdown]
# # Accuracy, and a reduced model
#
# A scene with an accuracy starts on a coarse mesh and is refined until the estimated error is within the accuracy. Two
# models compute the same scene: "full" has every ridge along the whole loading path, and "cylinders" treats all ridges
# as equal charged cylinders, in closed form.

# %%
import sys
from pathlib import Path

from matplotlib.figure import Figure

import fingerpad as fp
from fingerpad.startup import MPI

MU_0, ASKED = 0.25, 0.02
EXACT = f"full, {100 * ASKED:g} % requested"
SMALL = Path(__file__).parent / "scenes" / "small_finger.toml"


# %% [markdown]
# The closed form contains the contact length of the default finger, and refuses another finger, such as the small one.


# %%
def ladder(scene: fp.Scene) -> dict[str, fp.Result]:
    """Return the results of the models, the cheapest first."""
    found = {}
    try:
        found["cylinders"] = fp.run(scene, model="cylinders")
    except fp.SceneError as error:
        print(f"cylinders: {error}")
    return found | {"full": fp.run(scene), EXACT: fp.run(scene.replace(accuracy={"mu_app": ASKED}))}


# %%
def main(out: str = "results/demos/accuracy_and_reduced_models", size: str = "small") -> None:
    """Compare the models on a small finger; with the size "full" on the default finger, which takes far longer."""
    scene = fp.Scene.load(SMALL) if size == "small" else fp.Scene()
    found = ladder(scene)
    if MPI.COMM_WORLD.rank == 0:
        for name, result in found.items():
            slip, seconds = result.full_slip, result.cost.processor_seconds
            error = f"± {slip.error.mu_app:.4f}" if slip.error.known() else " " * 8
            print(f"{name:16s} µ_app {slip.mu_app:.4f} {error}, {seconds:6.2f} s")
        draw(Path(out), found)
    plain, exact = found["full"].full_slip, found[EXACT].full_slip
    # The accuracy is met, by the run's own estimate, and the plain run is within both errors of it.
    assert exact.error.mu_app <= ASKED * exact.mu_app
    assert abs(plain.mu_app - exact.mu_app) <= plain.error.mu_app + exact.error.mu_app
    # Both models keep the balance of forces and the friction law.
    for state in (result.full_slip for result in found.values()):
        assert abs(state.f_t - MU_0 * (state.f_ext + state.f_electrostatic)) < 1e-6 * state.f_ext
        assert abs(state.mu_app - exact.mu_app) < 0.15 * exact.mu_app


def draw(out: Path, found: dict[str, fp.Result]) -> None:
    """Write friction and its error over the cost."""
    axes = (figure := Figure(figsize=(6.4, 4), layout="constrained")).subplots()
    colours = ("#009E73", "#0072B2", "#D55E00")
    for (name, result), mark, colour in zip(found.items(), "^od", colours, strict=False):
        slip, error = result.full_slip, result.full_slip.error.mu_app
        seconds = max(result.cost.processor_seconds, 1e-3)
        axes.errorbar(seconds, slip.mu_app, error, fmt=mark, ms=8, capsize=5, color=colour, label=name)
    axes.set(xscale="log", xlabel="processor time (s)", ylabel="apparent friction µ_app")
    axes.set_title("Models of one scene; bars: estimated discretisation error")
    axes.legend(frameon=False)
    out.mkdir(parents=True, exist_ok=True)
    figure.savefig(out / "ladder.png", dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:])
