# %% [markdown]
# # Your own mesh
#
# A body can come from a gmsh file. The names of the physical groups mark the parts (docs/laws.md): layers of triangles,
# the `bone rim` glued to the rigid bone, and `ridge 0`, `ridge 1`, `ridge -1`, … that can touch. Lengths are in metres,
# and the screen is the line y = 0. The example is an artificial fingertip of two layers with three round ridges, as
# cast from silicone.

# %%
import sys
from pathlib import Path

import gmsh
import numpy as np
from matplotlib.figure import Figure

import fingerpad as fp
from fingerpad.startup import MPI

HARD, SOFT, MU_0, F_EXT = fp.NeoHooke(90e3, 0.45), fp.NeoHooke(20e3, 0.45), 0.25, 3.0


# %% [markdown]
# The skin is a chain of three half ellipses, 300 µm wide, and flat grooves. The middle ridge is 10 µm lower.


# %%
def write(path: Path, size: float) -> None:
    """Write the mesh with facets of ``size`` (m) on the ridges."""
    gmsh.initialize(readConfigFiles=False)
    gmsh.option.setNumber("General.Terminal", 0)
    geo, radius, groove = gmsh.model.geo, 150e-6, 200e-6

    def point(x: float, y: float, h: float = 4 * size) -> int:
        return geo.addPoint(x, y, 0.0, h)

    start = last = point(-750e-6, groove)
    skin, ridges = [], {}
    for number in (-1, 0, 1):
        x, low = 500e-6 * number, 0.0 if number == 0 else 10e-6
        left, tip, right = point(x - radius, groove), point(x, low, size), point(x + radius, groove)
        arcs = [ellipse(left, tip, x, groove), ellipse(tip, right, x, groove)]
        skin += [geo.addLine(last, left), *arcs]
        ridges[number], last = arcs, right
    end = point(750e-6, groove)
    skin.append(geo.addLine(last, end))
    right, left = point(750e-6, 1e-3, 100e-6), point(-750e-6, 1e-3, 100e-6)
    middle_right, middle_left = point(750e-6, 400e-6, 60e-6), point(-750e-6, 400e-6, 60e-6)
    between = geo.addLine(middle_right, middle_left)
    top = geo.addLine(right, left)
    low_loop = [*skin, geo.addLine(end, middle_right), between, geo.addLine(middle_left, start)]
    high_loop = [-between, geo.addLine(middle_right, right), top, geo.addLine(left, middle_left)]
    layers = [geo.addPlaneSurface([geo.addCurveLoop(loop)]) for loop in (low_loop, high_loop)]
    geo.synchronize()
    gmsh.model.addPhysicalGroup(2, [layers[0]], name="stratum corneum")
    gmsh.model.addPhysicalGroup(2, [layers[1]], name="dermis")
    gmsh.model.addPhysicalGroup(1, [top], name="bone rim")
    for number, arcs in ridges.items():
        gmsh.model.addPhysicalGroup(1, arcs, name=f"ridge {number}")
    gmsh.model.mesh.generate(2)
    gmsh.write(str(path))
    gmsh.finalize()


def ellipse(first: int, last: int, x: float, groove: float) -> int:
    """Return the quarter of an ellipse about (x, groove) between two of its vertices."""
    centre, major = gmsh.model.geo.addPoint(x, groove, 0.0), gmsh.model.geo.addPoint(x, 0.0, 0.0)
    return gmsh.model.geo.addEllipseArc(first, centre, major, last)


# %% [markdown]
# The mesh is pressed and slid twice: as a body, load by load, and as the finger of a scene.


# %%
def main(out: str = "results/demos/own_mesh", size: str = "15e-6") -> None:
    """Mesh with facets of ``size`` (m); the mesh and figures go to the folder ``out``."""
    path = Path(out) / "mine.msh"
    if MPI.COMM_WORLD.rank == 0:
        path.parent.mkdir(parents=True, exist_ok=True)
        write(path, float(size))
    MPI.COMM_WORLD.barrier()
    layers = {"stratum corneum": HARD, "dermis": SOFT}
    body = fp.Body(path, layers, friction=MU_0).press(F_EXT).slide(until_full_slip=True)
    materials = {"stratum_corneum": HARD, "dermis": SOFT}
    result = fp.run(fp.Scene(f_ext=F_EXT, voltage=0.0, geometry={"file": path}, materials=materials))
    ridges, slip = body.state.ridges, result.full_slip
    if MPI.COMM_WORLD.rank == 0:
        for number, force in zip(ridges.number, ridges.f_contact, strict=True):
            print(f"ridge {number:2d} bears {force:.3f} N/m")
        print(f"the same file as a scene: bone at {slip.bone_height * 1e6:.3f} um, {slip.ridges_in_contact} ridges")
        draw(Path(out), body)
    assert list(ridges.number) == [-1, 0, 1] and (ridges.length > 0).all()
    assert np.isclose(ridges.f_contact.sum(), F_EXT, rtol=1e-6)
    assert ridges.f_contact.argmax() == 1  # the middle ridge is the lowest
    # Full slip is Coulomb's cone, whatever the mesh; both doors find the same equilibrium, by other steps.
    for state in (body.state, slip):
        assert np.isclose(state.mu_app, MU_0, rtol=1e-6)
    assert np.isclose(slip.contact_length, body.state.contact_length, rtol=1e-3)


def draw(out: Path, body: fp.Body) -> None:
    """Write the deformed mesh."""
    axes = (figure := Figure(figsize=(7, 4.5), layout="constrained")).subplots()
    x, y = (body.coordinates + body.displacement).T * 1e3
    hard = body.coordinates[body.triangles, 1].mean(axis=1) < 400e-6
    for cells, colour, name, height in ((hard, "#D55E00", "hard layer", 0.25), (~hard, "#0072B2", "soft layer", 0.7)):
        axes.triplot(x, y, body.triangles[cells], lw=0.4, color=colour)
        axes.text(x.max() + 0.02, height, name, color=colour)
    axes.set_xlim(x.min() - 0.1, x.max() + 0.3)
    axes.axhline(0, color="k", lw=2)
    axes.annotate("screen", (0, 0), (0, -14), textcoords="offset points", ha="center")
    axes.set_ylim(-0.1, 1.02)
    axes.set(xlabel="x (mm)", ylabel="y (mm)", aspect="equal", title=f"Pressed by {F_EXT:g} N/m, sliding to the right")
    figure.savefig(out / "deformed.png", dpi=150)


if __name__ == "__main__":
    main(*sys.argv[1:])
