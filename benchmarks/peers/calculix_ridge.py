"""The ridge in CalculiX: an input deck of CPE6 elements, its Ogden law and its face-to-face penalty contact.

CalculiX makes a solid one element thick of the plane strain elements, holds it in z and presses it on a rigid block.
Its contact stiffness is per current area. Every load is a step of the deck without any subdivision. Ogden's exponent
has Abaqus's sign, so that the printed alpha = -14.53 is 14.53 here; D = 2/K.
"""

import subprocess
import tempfile
from collections.abc import Iterable, Iterator
from pathlib import Path

import numpy as np

from benchmarks.peers.exchange import Answer, Case, Ridge, State, main, plain, steps

_BLOCK = np.array([[-1.0, -0.5], [1.0, -0.5], [1.0, 0.0], [-1.0, 0.0]])  # mm, the screen
_JOB = "ridge"


def deck(case: Case, ridge: Ridge) -> str:
    """Return the input deck."""
    count = len(ridge.points)
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{k}, {x:.15g}, {y:.15g}, 0" for k, (x, y) in enumerate(np.vstack([ridge.points, _BLOCK]), start=1)]
    lines.append("*ELEMENT, TYPE=CPE6, ELSET=BODY")
    lines += [f"{k}, " + ", ".join(str(node + 1) for node in cell) for k, cell in enumerate(ridge.triangles, start=1)]
    last = len(ridge.triangles) + 1
    lines += ["*ELEMENT, TYPE=CPE4, ELSET=BLOCK", f"{last}, " + ", ".join(str(count + k) for k in range(1, 5))]
    for name, nodes in {
        "TOP": ridge.top,
        "HELD": np.union1d(ridge.top, ridge.sides),
        "SKIN": np.unique(ridge.skin),
        "SCREEN": count + np.arange(4),
    }.items():
        lines += [f"*NSET, NSET={name}", *(f"{k + 1}," for k in nodes)]
    faces = {frozenset(pair) for pair in plain(ridge.skin[:, :2])}
    lines.append("*SURFACE, NAME=SLAVE")
    for k, (a, b, c) in enumerate(plain(ridge.triangles[:, :3]), start=1):
        lines += [f"{k}, S{s}" for s, edge in enumerate(((a, b), (b, c), (c, a)), start=1) if frozenset(edge) in faces]
    law = f"{case.shear_modulus:.15g}, {case.exponent:.15g}, {2 / case.bulk_modulus:.15g}"
    lines += [
        "*SURFACE, NAME=MASTER",
        f"{last}, S3",
        "*MATERIAL, NAME=SKIN",
        "*HYPERELASTIC, OGDEN, N=1",
        law,
        "*MATERIAL, NAME=RIGID",
        "*ELASTIC",
        "1000, 0.3",
        "*SOLID SECTION, ELSET=BODY, MATERIAL=SKIN",
        "1",
        "*SOLID SECTION, ELSET=BLOCK, MATERIAL=RIGID",
        "1",
        "*SURFACE INTERACTION, NAME=TOUCH",
        "*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR",
        f"{case.eps_n:.15g}",
    ]
    if case.mu_f:
        lines += ["*FRICTION", f"{case.mu_f:.15g}, {case.eps_t:.15g}"]
    lines += ["*CONTACT PAIR, INTERACTION=TOUCH, TYPE=SURFACE TO SURFACE", "SLAVE, MASTER"]
    lines += ["*BOUNDARY", "SCREEN, 1, 2"]
    for _, load in steps(case):
        lines += ["*STEP, NLGEOM, INC=1000", "*STATIC, DIRECT", "1, 1"]
        lines += ["*BOUNDARY", f"HELD, 1, 1, {load.x:.15g}", f"TOP, 2, 2, {load.y:.15g}"]
        if load.name:
            lines += ["*NODE PRINT, NSET=SKIN", "U", "*NODE PRINT, NSET=HELD", "RF"]
            lines += ["*CONTACT PRINT", "CDIS, CSTR"]
        else:
            lines += ["*NODE PRINT, NSET=SKIN, FREQUENCY=999", "U", "*CONTACT PRINT, FREQUENCY=999", "CDIS"]
        lines.append("*END STEP")
    return "\n".join(lines) + "\n"


def blocks(text: str) -> Iterator[tuple[str, float, list[list[float]]]]:
    """Yield the tables of a .dat file: heading, total time (a step takes 1), rows."""
    heading, time, rows = "", 0.0, list[list[float]]()
    for line in text.splitlines():
        if " time " in line:
            if heading:
                yield heading, time, rows
            heading, _, end = line.strip().rpartition(" time ")
            time, rows = float(end), []
        elif line.strip():
            rows.append([float(word) for word in line.split()])
    if heading:
        yield heading, time, rows


def on_skin(ridge: Ridge, u: np.ndarray, gaps: Iterable[list[float]], stresses: Iterable[list[float]]) -> np.ndarray:
    """Return abscissa (mm), pressure and friction (MPa of reference area) of each contact point, by abscissa.

    CalculiX prints a point's element, face and gap, but not where on the face it is: that is found by the gap.
    """
    of_face = {frozenset(edge[:2]): edge for edge in plain(ridge.skin)}
    xi = np.linspace(0.0, 1.0, 401)
    shapes = np.array([(1 - xi) * (1 - 2 * xi), xi * (2 * xi - 1), 4 * xi * (1 - xi)])
    slopes = np.array([4 * xi - 3, 4 * xi - 1, 4 - 8 * xi])
    points = set()
    for (cell, face, gap, *_), (*_, pressure, friction, _) in zip(gaps, stresses, strict=True):
        corners = plain(ridge.triangles[int(cell) - 1, :3])
        side = int(face) - 3  # of the prism's faces, the first two are the triangles
        edge = of_face[frozenset((corners[side], corners[(side + 1) % 3]))]
        place: np.ndarray = ridge.points[edge] + u[edge]
        k = int(np.argmin(np.abs(shapes.T @ place[:, 1] - gap)))
        length = np.linalg.norm(ridge.points[edge[1]] - ridge.points[edge[0]])
        stretch = float(np.linalg.norm(slopes[:, k] @ place) / length)
        # Printed is what the skin does to the plane.
        points.add((float(shapes[:, k] @ place[:, 0]), pressure * stretch, -friction * stretch))
    return np.array(sorted(points))


def solve(case: Case, ridge: Ridge) -> Answer:
    """Lead the ridge along the loads."""
    with tempfile.TemporaryDirectory() as folder:
        job = Path(folder) / _JOB
        job.with_suffix(".inp").write_text(deck(case, ridge), encoding="ascii")
        run = subprocess.run(["ccx", "-i", _JOB], cwd=folder, capture_output=True, text=True, check=False)
        if "Job finished" not in run.stdout:
            raise RuntimeError("CalculiX: " + "; ".join(run.stdout.split("\n")[-12:]))
        tables = list(blocks(job.with_suffix(".dat").read_text(encoding="ascii")))
        summary = [line.split() for line in job.with_suffix(".sta").read_text(encoding="ascii").splitlines()[2:]]
    version = subprocess.run(["ccx", "-v"], capture_output=True, text=True, check=False).stdout.split()[-1]
    answer = Answer("CalculiX", version, "GPL 2 or later", iterations=sum(int(row[3]) for row in summary))
    for step, load in enumerate(case.loads, start=1):
        if not load.name:
            continue
        found = {heading.split()[0] + heading.split()[1]: rows for heading, time, rows in tables if round(time) == step}
        u = np.full((len(ridge.points), 2), np.nan)
        for node, *components in found["displacements(vx,vy,vz)"]:
            u[int(node) - 1] = components[:2]
        forces = np.array(found["forces(fx,fy,fz)"])[:, 1:].sum(axis=0)
        x, p, t = on_skin(ridge, u, found["relativecontact"], found["contactstress"]).T
        answer.states.append(
            State(
                load.name,
                -float(forces[1]),
                -float(forces[0]),
                plain(u[ridge.skin.ravel()]),
                *(plain(values) for values in (x, p, t)),
            )
        )
    return answer


if __name__ == "__main__":
    main(solve)
