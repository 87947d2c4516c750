# %% [markdown]
# # Spikes while a finger presses, holds and slides
#
# Nerve fibres answer to what the skin does. Slowly adapting fibres (SA-I) fire while a stress is there, and faster
# while it grows. Rapidly adapting fibres (RA-I) fire while it changes, and are silent in a hold. Loads over time give
# each state a time; stimuli at the receptor sites over this time give the spikes. The skin is elastic and thresholds
# are relative: compare loads and ridges, and not rates with those of a person.

# %%
import sys
from pathlib import Path

import fingerpad as fp
from fingerpad.startup import MPI

SCENES = Path(__file__).parent / "scenes"
PRESS, SLIDE = 0.02, 0.02  # s
HOLD = 0.1  # s


# %% [markdown]
# Ten lines from the scene to the raster. `numerics.step_scale` makes the steps short enough for both classes: a class
# that is named is refused otherwise, with the value that would do.


# %%
def main(out: str = "results/demos/press_hold_slide_spikes", size: str = "small") -> None:
    """Press, hold and slide; the size "full" is the default finger under 75 N/m, which takes far longer."""
    small = size == "small"
    scene = fp.Scene.load(SCENES / "small_finger.toml") if small else fp.Scene()
    loads = [
        {"name": "press", "f_ext": 10.0 if small else 75.0, "duration": PRESS},
        {"name": "hold", "bone_x_by": 0.0, "duration": HOLD},
        {"name": "slide", "bone_x": 500e-6, "duration": SLIDE},
    ]
    output = {"errors": False, "receptors": True, "each_load": False}
    mesh = {"contact": 40e-6} if small else {"contact": 20e-6}
    scene = scene.replace(history=loads, output=output, mesh=mesh, numerics={"step_scale": 0.5})
    spikes = fp.run(scene).afferents(["SA1", "RA1"])
    if MPI.COMM_WORLD.rank == 0:
        print(spikes)
        Path(out).mkdir(parents=True, exist_ok=True)
        spikes.plot(Path(out) / "raster.png")
        spikes.to_csv(Path(out) / "spikes.csv")

    # %% [markdown]
    # Assertions: RA-I fibres fire in the press and at the onset of sliding, and hardly after the begin of the hold, in
    # which SA-I fibres go on with ever longer intervals.

    # %%
    settled = PRESS + HOLD / 4
    assert spikes.count("RA1", "press") > 0 and spikes.count("RA1", "slide") > 0
    assert not any(((train > settled) & (train < PRESS + HOLD)).any() for train in spikes.of("RA1"))
    longest = max(spikes.of("SA1"), key=len)
    held = longest[(longest > PRESS) & (longest <= PRESS + HOLD)]
    assert len(held) >= 3 and held[-1] - held[-2] > held[1] - held[0]


if __name__ == "__main__":
    main(*sys.argv[1:])
