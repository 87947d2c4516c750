# %% [markdown]
# # Results with other tools
#
# A run leaves its tables as one NetCDF file, `result.nc`. xarray opens it with units and names. The fields are in
# `displacement.bp`, `stress.bp` and `sed.bp`. ADIOS2's Python package reads them, and ParaView opens them
# (docs/results.md).

# %%
import os
import sys
from pathlib import Path

import numpy as np
import xarray
from matplotlib.figure import Figure

import fingerpad as fp
from fingerpad.startup import MPI

os.environ.setdefault("ADIOS2_ALWAYS_USE_MPI", "1")  # else Debian's package looks for its serial build
SCENE = Path(__file__).parent / "scenes" / "small_finger.toml"


# %% [markdown]
# ## Fields
#
# Each load's end is one time of the file. `step` is the number of its step in `steps.csv` and in `result.nc`. Each rank
# writes a block with its own nodes and cells. `geometry` has the nodes of the unloaded finger (m), and each row of
# `connectivity` the number of nodes of a cell and the nodes.


# %%
def read(file: Path, time: int) -> dict[str, np.ndarray]:
    """Return the arrays of one time of a field file by name, the blocks of all ranks one after the other."""
    import adios2

    found: dict[str, list[np.ndarray]] = {name: [] for name in ("geometry", "connectivity", file.stem)}
    with adios2.FileReader(str(file)) as fields:
        step = fields.read("step", step_selection=[time, 1])
        for block in range(MPI.COMM_WORLD.size):
            before = sum(map(len, found["geometry"]))
            for name, parts in found.items():
                parts.append(fields.read(name, block_id=block, step_selection=[time, 1]))
            found["connectivity"][-1][:, 1:] += before
    return {name: np.concatenate(parts) for name, parts in found.items()} | {"step": step}


# %% [markdown]
# ## A run
#
# The small finger is pressed, charged and slid. `result.nc` has the energy stored after the press. The integral of the
# energy density over the unloaded cells is larger. The density is convex in a strain that is linear in each cell, and
# the field interpolates its corner values from above; on these coarse cells by less than a half. (Under voltage, the
# stored energy has the potential of the attraction too.)


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
    last = data.sizes["load"] - 1
    moved = read(folder / "displacement.bp", last)
    draw(Path(out) / "sed.png", read(folder / "sed.bp", last), str(data["load"].values[last]))
    sed = read(folder / "sed.bp", 0)

    nodes, cells = sed["geometry"][:, :2], sed["connectivity"][:, 1:]
    (a, b), density = np.moveaxis(nodes[cells[:, 1:]] - nodes[cells[:, :1]], 1, 0), sed["sed"].ravel()
    energy = float(np.sum(np.abs(a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]) / 2 * density[cells].mean(axis=1)))
    step = data.sel(step=int(data.load_last_step[0]))
    print(f"stored energy: {float(step.stored):.3e} J/m in the table, {energy:.3e} J/m from the field")
    lowest = float((moved["geometry"] + moved["displacement"])[:, 1].min())
    assert int(np.ravel(sed["step"])[0]) == int(step.step)
    assert np.allclose(data.ridge_f_contact.sum("ridge"), data.f_contact, rtol=1e-9)
    assert float(step.stored) < energy < 1.5 * float(step.stored)
    assert abs(lowest) < 1e-6  # m: the skin is on the screen


def draw(path: Path, sed: dict[str, np.ndarray], load: str) -> None:
    """Write a picture of the energy density on the unloaded finger."""
    axes = (figure := Figure(figsize=(7, 4.5), layout="constrained")).subplots()
    x, y = 1e3 * sed["geometry"][:, :2].T
    density = np.log10(np.maximum(sed["sed"].ravel(), 1.0))
    shown = axes.tripcolor(x, y, sed["connectivity"][:, 1:], density, shading="gouraud", cmap="viridis")
    figure.colorbar(shown, label="log10 of the strain energy density (J/m³), at least 0")
    axes.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal", title=f"After the load {load!r}, read from sed.bp")
    figure.savefig(path, dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:])
