# %% [markdown]
# # Results with other tools
#
# A run leaves its numbers as one NetCDF file, `result.nc`. xarray opens it with units and names. The fields inside the
# finger are NumPy arrays of the result, also of one that is read from its folder. For ParaView,
# `result.to_pyvista().save("fields.vtm")` writes them as VTK has them (docs/results.md).

# %%
import sys
from pathlib import Path

import numpy as np
import xarray
from matplotlib.figure import Figure

import fingerpad as fp
from fingerpad.startup import MPI

SCENE = Path(__file__).parent / "scenes" / "small_finger.toml"
LOW, HIGH = 0.25e-3, 1.25e-3  # m: above the field of the screen, and below the bone


# %% [markdown]
# ## A run
#
# The small finger is pressed, charged and slid. `result.nc` has the energy stored after the press. The integral of the
# energy density over the unloaded cells is the same energy, within a percent on these coarse cells. (Under voltage, the
# stored energy has the potential of the attraction too.)
#
# At each height y between screen and bone, the stress carries the same forces: with the Cauchy stress $\sigma$ and the
# present cross-section of the finger,
#
# $$\int \sigma_{yy} \, dx = -f_{ext}, \qquad \int \sigma_{xy} \, dx = f_T$$
#
# The demo takes the mean of both over heights from `LOW` to `HIGH`, with a weight that vanishes at both.


# %%
def main(out: str = "results/demos/results_with_other_tools", contact: str = "20e-6") -> None:
    """Run with facets of ``contact`` (m) where ridges touch; the run and a figure go to the folder ``out``."""
    mesh = {"contact": float(contact), "interface": 60e-6, "coarsest": 150e-6, "growth": 0.3}
    scene = fp.Scene.load(SCENE).replace(mesh=mesh, output={"errors": False})
    folder = Path(out) / "run"
    fp.run(scene, out=folder)
    if MPI.COMM_WORLD.rank > 0:  # what follows reads files
        return
    data = xarray.load_dataset(folder / "result.nc")
    slip = data.sel(state="full_slip")
    print(f"µ_app = {float(slip.state_mu_app):.4f} ({data.mu_app.attrs['long_name']})")
    share = data.ridge_f_contact / data.f_contact
    print("part of the force on the central ridge after each load:")
    for name, step in zip(data["load"].values, data.load_last_step.values, strict=True):
        print(f"  {name:6s} {float(share.sel(step=step, ridge=0)):.3f}")

    fields = fp.Result.load(folder).fields
    pressed, slid = fields["press"], fields["full_slip"]
    energy = float(np.sum(areas(pressed) * pressed.sed))
    step = data.sel(step=int(data.load_last_step[0]))
    print(f"stored energy: {float(step.stored):.3e} J/m in the table, {energy:.3e} J/m from the field")
    found = carried(slid)
    print(f"forces at full slip: {float(slip.state_f_ext):.3f} and {float(slip.state_f_t):.3f} N/m in the table,")
    print(f"{-found[1, 1]:.3f} and {found[0, 1]:.3f} N/m from the stress")
    draw(Path(out) / "sed.png", slid)
    lowest = float((slid.points + slid.displacement)[:, 1].min())
    assert np.allclose(data.ridge_f_contact.sum("ridge"), data.f_contact, rtol=1e-9)
    assert abs(energy - float(step.stored)) < 0.02 * float(step.stored)
    assert abs(found[1, 1] + float(slip.state_f_ext)) < 0.05 * float(slip.state_f_ext)
    assert abs(found[0, 1] - float(slip.state_f_t)) < 0.05 * float(slip.state_f_ext)
    assert abs(lowest) < 1e-6  # m: the skin is on the screen


def areas(fields, moved: float = 0.0) -> np.ndarray:
    """Return the areas (m²) of the cells, shape (cells,): unloaded, or with ``moved`` = 1 in their present places."""
    corners = (fields.points + moved * fields.displacement)[fields.triangles]
    (ax, ay), (bx, by) = (corners[:, 1] - corners[:, 0]).T, (corners[:, 2] - corners[:, 0]).T
    return np.abs(ax * by - ay * bx) / 2


def carried(fields) -> np.ndarray:
    """Return the integral of the stress over x (N/m), shape (3, 3), its mean over heights."""
    y = (fields.points + fields.displacement)[fields.triangles][:, :, 1].mean(axis=1)
    between = (LOW < y) & (y < HIGH)
    weight = np.where(between, np.sin(np.pi * (y - LOW) / (HIGH - LOW)) ** 2, 0.0) / ((HIGH - LOW) / 2)
    return np.einsum("c,cij->ij", areas(fields, moved=1.0) * weight, fields.stress)


def draw(path: Path, fields) -> None:
    """Write a picture of the energy density on the deformed finger."""
    axes = (figure := Figure(figsize=(7, 4.5), layout="constrained")).subplots()
    x, y = 1e3 * (fields.points + fields.displacement).T
    shown = axes.tripcolor(x, y, fields.triangles, np.log10(np.maximum(fields.sed, 1.0)), cmap="viridis")
    figure.colorbar(shown, label="log10 of the strain energy density (J/m³), at least 0")
    axes.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal", title="At full slip, from result.fields")
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:])
