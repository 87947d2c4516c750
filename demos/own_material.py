# %% [markdown]
# # Your own material
#
# A solid is given by its strain energy density; stresses and tangents are derived from this density. Yeoh's solid
# stiffens under large strain (Yeoh 1993, doi 10.5254/1.3538343),
#
# $$W = \frac{G}{2} (\bar I_1 - 3) + c_2 (\bar I_1 - 3)^2 + \frac{K}{2} (J - 1)^2, \qquad
#   \bar I_1 = J^{-2/3} \operatorname{tr} F^T F$$
#
# and equals the neo-Hookean solid at $c_2 = 0$. The class has the numbers and the energy without the volumetric part.
# The part with the bulk modulus K is added automatically.

# %%
import sys
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import ufl
from matplotlib.figure import Figure

import fingerpad as fp
from fingerpad.startup import MPI

SMALL = Path(__file__).parent / "scenes" / "small_finger.toml"
SOFT = fp.NeoHooke(2.5e3, 0.48)


@dataclass(frozen=True)
class Yeoh(fp.Material):
    shear_modulus: float  # Pa
    bulk: float  # Pa
    c_2: float  # Pa

    def energy(self, F):  # (3, 3)
        above = ufl.det(F) ** (-2 / 3) * ufl.inner(F, F) - 3
        return self.shear_modulus / 2 * above + self.c_2 * above**2


# %% [markdown]
# A block, glued to the bone at its top, is pressed down by three tenths of its height.


# %%
def pressed(material: fp.Material) -> np.ndarray:
    """Return heights of the bone (m) and external forces (N/m) of a block, shape (steps, 2)."""
    block = fp.Body(fp.geometry.block(1e-3, 1e-3, 0.25e-3), material)  # without friction
    for k in range(1, 7):
        block.press(height=-50e-6 * k)
    return np.array([(state.bone_height, state.f_ext) for state in block.states])


# %%
def main(out: str = "results/demos/own_material", size: str = "small") -> None:
    """Press blocks, then fingers of another dermis; with the size "full" the default finger, which takes far longer."""
    blocks = {
        "neo-Hooke, built in": pressed(SOFT),
        "Yeoh, c₂ = 0": pressed(Yeoh(SOFT.shear_modulus, SOFT.bulk, 0.0)),
        "Yeoh, c₂ = G": pressed(Yeoh(SOFT.shear_modulus, SOFT.bulk, SOFT.shear_modulus)),
    }
    scene = fp.Scene.load(SMALL) if size == "small" else fp.Scene()
    pressed_only = [{"name": "press", "f_ext": scene.f_ext}]
    scene = scene.replace(history=pressed_only, friction=0.0, output={"errors": False})
    yeoh = Yeoh(SOFT.shear_modulus, SOFT.bulk, 10 * SOFT.shear_modulus)
    fingers = [fp.run(scene.replace(materials={"dermis": material})) for material in (SOFT, yeoh)]
    height = [finger.uncharged.bone_height for finger in fingers]
    if MPI.COMM_WORLD.rank == 0:
        for name, path in blocks.items():
            print(f"block, {name}: {path[-1, 1]:.6f} N/m")
        print(f"finger's bone: neo-Hookean dermis {height[0] * 1e6:.2f} um, Yeoh's {height[1] * 1e6:.2f} um")
        print(fingers[1].record["laws"]["dermis"])
        draw(Path(out), blocks)
    built_in, equal, stiffer = (path[-1, 1] for path in blocks.values())
    assert np.isclose(equal, built_in, rtol=1e-7)  # the same energy, written by another hand
    assert stiffer > 1.05 * built_in
    assert height[0] < height[1] < 0  # a dermis that stiffens lets the bone down less
    assert all(np.isclose(finger.uncharged.f_contact, scene.loads()[0].f_ext, rtol=1e-6) for finger in fingers)


def draw(out: Path, blocks: dict[str, np.ndarray]) -> None:
    """Write the force over the indentation."""
    axes = (figure := Figure(figsize=(6, 4), layout="constrained")).subplots()
    for (name, path), style, colour in zip(blocks.items(), ("-", "o", "s--"), ("k", "#D55E00", "#0072B2"), strict=True):
        axes.plot(-path[:, 0] * 1e3, path[:, 1], style, color=colour, label=name)
    axes.set(xlabel="indentation (mm)", ylabel="external force f_ext (N/m)", title="A block 1 mm high, pressed flat")
    axes.legend(frameon=False)
    out.mkdir(parents=True, exist_ok=True)
    figure.savefig(out / "blocks.png", dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:])
