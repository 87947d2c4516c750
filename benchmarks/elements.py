"""Which element for skin: error and work of all elements on one ridge, from nu = 0.3 to nearly incompressible.

python3 benchmarks/elements.py [--out DIR]

One papillary ridge with free sides is pressed by 30 um with friction, then drawn aside by 5 um. Meshes are one mesh of
20 um facets and its triangles cut in four, once and twice; errors are against P2-P1 on that mesh cut once more.
"""

import argparse
import csv
import time
from dataclasses import asdict, dataclass, fields
from functools import partial
from itertools import chain
from pathlib import Path

import gmsh
import matplotlib
import matplotlib.pyplot as plt
import numpy as np
from mpi4py import MPI

from geometry import tags
from geometry.bodies import ridge
from geometry.mesh import load
from variational.body import Body
from variational.contact.penalty import Penalty
from variational.element import ELEMENTS
from variational.materials.ogden import Ogden
from variational.problem import Interface
from variational.roughness.bam import BearingArea
from variational.solvers.continuation import StepFailed, Target

matplotlib.use("Agg")

RATIOS = (0.3, 0.48, 0.499, 0.4999)
COARSEST, REFINEMENTS = 20e-6, 3  # m; refinements of the reference, the others have fewer
REFERENCE = "P2-P1"
PRESS, SLIDE = 30e-6, 5e-6  # m
H_0 = 0.514e-6  # m, not felt: there is no voltage
# Okabe and Ito's colours, told apart by the colour-blind; markers and dashes tell them apart in grey
STYLES = {
    "P1": ("#D55E00", "v", ":"),
    "P2": ("#0072B2", "o", "-"),
    "P2 reduced": ("#E69F00", "s", "--"),
    "P2-P1": ("#009E73", "D", "-."),
    "P3": ("#CC79A7", "^", "-"),
}


@dataclass(frozen=True)
class Run:
    """What one run gives."""

    poisson: float
    size: float
    """Length of a facet (m)."""
    element: str
    unknowns: int
    f_contact: float
    """After the slide (N/m)."""
    f_friction: float
    contact_length: float
    """Likewise (m)."""
    newton: int
    factorisations: int
    seconds: float
    """Processor time, without meshing and compiling."""
    failure: str = ""


def refined(times: int) -> float:
    """Mesh the ridge and cut every triangle in four, ``times`` times."""
    unit = ridge(COARSEST)()
    for _ in range(times):
        gmsh.model.mesh.refine()
    return unit


def run(element: str, poisson: float, times: int) -> Run:
    """Press and slide."""
    body = load(MPI.COMM_WORLD, partial(refined, times))
    skin = {tags.STRATUM_CORNEUM: Ogden(86.76e3, -14.53, poisson)}
    interface = Interface(Penalty(1.5e12, 5e10), friction=0.25, h_0=H_0)
    made = Body(body, skin, interface, BearingArea(H_0), element=element, tolerance=1e-8)
    solver, observer, continuation = made.solver, made.observer, made.continuation
    failure, start = "", time.process_time()
    try:
        continuation.run(Target("press", bone_height=-PRESS))
        continuation.run(Target("slide", bone_x=SLIDE))
    except StepFailed as reason:
        failure = str(reason)
    seconds = time.process_time() - start
    loads, counts = observer.ridge_loads(continuation.surface_state), solver.counts
    missing = np.nan if failure else 1.0
    return Run(
        poisson,
        COARSEST / 2**times,
        element,
        solver.layout.global_size,
        f_contact=missing * float(loads.f_contact[0]),
        f_friction=missing * float(loads.f_friction[0]),
        contact_length=missing * float(loads.length[0]),
        newton=counts.newton,
        factorisations=counts.factorisations,
        seconds=seconds,
        failure=failure,
    )


def draw(runs: list[Run], reference: dict[float, Run], path: Path) -> None:
    """Draw error in force and contact length, and work, over the facet size; one column a Poisson's ratio."""
    labels = ("error in contact force (%)", "error in contact length (%)", "factorisations")
    sizes = sorted({r.size * 1e6 for r in runs})
    figure, axes = plt.subplots(3, len(RATIOS), figsize=(11, 8.2), sharex=True, sharey="row", layout="constrained")
    for column, poisson in zip(axes.T, RATIOS, strict=True):
        exact = reference[poisson]
        for element, (colour, marker, dash) in STYLES.items():
            mine = sorted((r for r in runs if (r.element, r.poisson) == (element, poisson)), key=lambda r: r.size)
            force = [100 * abs(r.f_contact / exact.f_contact - 1) for r in mine]
            length = [100 * abs(r.contact_length / exact.contact_length - 1) for r in mine]
            for axis, values in zip(column, (force, length, [r.factorisations for r in mine]), strict=True):
                axis.loglog(sizes, values, color=colour, marker=marker, linestyle=dash, label=element, markersize=5)
        column[0].set_title(f"Poisson's ratio {poisson:g}", fontsize=11)
        column[-1].set_xlabel("facet size (µm)")
    for axis, label in zip(axes[:, 0], labels, strict=True):
        axis.set_ylabel(label)
    for axis in axes.flat:
        axis.set_xticks(sizes, [f"{size:g}" for size in sizes])
        axis.minorticks_off()
        axis.yaxis.set_major_formatter(lambda value, _: f"{value:g}")
        axis.grid(color="0.9")
        axis.set_axisbelow(True)
    figure.legend(*axes[0, 0].get_legend_handles_labels(), loc="outside upper center", ncols=4, frameon=False)
    figure.savefig(path, dpi=130)
    plt.close(figure)


def main() -> None:
    """Run all, print a table, write elements.csv and elements.png."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("--out", type=Path, default=Path("results/elements"), metavar="DIR")
    folder = parser.parse_args().out
    folder.mkdir(parents=True, exist_ok=True)
    reference, runs = {}, []
    print("     nu   size element    unknowns     force    error   length    error Newton factor.    CPU")
    print("            um                           N/m        %       um        %                     s")
    for poisson in RATIOS:
        reference[poisson] = exact = run(REFERENCE, poisson, REFINEMENTS)
        cases = [(element, times) for times in range(REFINEMENTS) for element in ELEMENTS]
        for r in chain([exact], (run(element, poisson, times) for element, times in cases)):
            if r is not exact:
                runs.append(r)
            force, length = r.f_contact / exact.f_contact - 1, r.contact_length / exact.contact_length - 1
            print(
                f"{r.poisson:7g} {r.size * 1e6:6g} {r.element:10s} {r.unknowns:8d}",
                f"{r.f_contact:9.5f} {100 * force:8.3f} {r.contact_length * 1e6:8.3f} {100 * length:8.3f}",
                f"{r.newton:6d} {r.factorisations:7d} {r.seconds:6.1f} {r.failure}",
                flush=True,
            )
    with (folder / "elements.csv").open("w", newline="", encoding="utf-8") as file:
        table = csv.DictWriter(file, [field.name for field in fields(Run)])
        table.writeheader()
        table.writerows(asdict(r) for r in [*runs, *reference.values()])
    draw(runs, reference, folder / "elements.png")
    print(f"\n{folder / 'elements.csv'}, {folder / 'elements.png'}")


if __name__ == "__main__":
    main()
