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

from benchmarks.peers.exchange import Answer, Case, Ridge, main, plain

_BLOCK = np.array([[-1.0, -0.5], [1.0, -0.5], [1.0, 0.0], [-1.0, 0.0]])  # mm, the screen
_JOB = "ridge"
_LAWS = """*SURFACE, NAME=MASTER
{block}, S3
*MATERIAL, NAME=SKIN
*HYPERELASTIC, OGDEN, N=1
{shear_modulus:.15g}, {exponent:.15g}, {d:.15g}
*MATERIAL, NAME=RIGID
*ELASTIC
1000, 0.3
*SOLID SECTION, ELSET=BODY, MATERIAL=SKIN
1
*SOLID SECTION, ELSET=BLOCK, MATERIAL=RIGID
1
*SURFACE INTERACTION, NAME=TOUCH
*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=LINEAR
{eps_n:.15g}"""
_CONTACT = """*CONTACT PAIR, INTERACTION=TOUCH, TYPE=SURFACE TO SURFACE
SLAVE, MASTER
*BOUNDARY
SCREEN, 1, 2"""
_STEP = """*STEP, NLGEOM, INC=1000
*STATIC, DIRECT
1, 1
*BOUNDARY
HELD, 1, 1, {x:.15g}
TOP, 2, 2, {y:.15g}"""
_REPORT = """*NODE PRINT, NSET=SKIN
U
*NODE PRINT, NSET=HELD
RF
*CONTACT PRINT
CDIS, CSTR"""
_NO_REPORT = """*NODE PRINT, NSET=SKIN, FREQUENCY=999
U
*CONTACT PRINT, FREQUENCY=999
CDIS"""


def deck(case: Case, ridge: Ridge) -> str:
    """Return the input deck."""
    count, block = len(ridge.points), len(ridge.triangles) + 1
    # CalculiX reads 20 characters of a number: a longer one loses its exponent.
    lines = ["*NODE, NSET=ALL"]
    lines += [f"{k}, {x:.12g}, {y:.12g}, 0" for k, (x, y) in enumerate(np.vstack([ridge.points, _BLOCK]), start=1)]
    lines.append("*ELEMENT, TYPE=CPE6, ELSET=BODY")
    lines += [f"{k}, " + ", ".join(str(node + 1) for node in cell) for k, cell in enumerate(ridge.triangles, start=1)]
    lines += ["*ELEMENT, TYPE=CPE4, ELSET=BLOCK", f"{block}, " + ", ".join(str(count + k) for k in range(1, 5))]
    sets = {"TOP": ridge.top, "HELD": ridge.held, "SKIN": np.unique(ridge.skin), "SCREEN": count + np.arange(4)}
    for name, nodes in sets.items():
        lines += [f"*NSET, NSET={name}", *(f"{k + 1}," for k in nodes)]
    lines.append("*SURFACE, NAME=SLAVE")
    touching = ridge.skin_pairs
    for k, (a, b, c) in enumerate(plain(ridge.triangles[:, :3]), start=1):
        edges = enumerate(({a, b}, {b, c}, {c, a}), start=1)
        lines += [f"{k}, S{side}" for side, edge in edges if edge in touching]
    lines.append(_LAWS.format(block=block, d=2 / case.bulk_modulus, **vars(case)))
    if case.mu_f:
        lines += ["*FRICTION", f"{case.mu_f:.15g}, {case.eps_t:.15g}"]
    lines.append(_CONTACT)
    for load in case.loads:
        lines += [_STEP.format(x=load.x, y=load.y), _REPORT if load.name else _NO_REPORT, "*END STEP"]
    return "\n".join(lines) + "\n"


def blocks(text: str) -> Iterator[tuple[str, float, list[list[float]]]]:
    """Yield the tables of a .dat file: heading, total time (a step takes 1), rows."""
    found = list[tuple[str, float, list[list[float]]]]()
    for line in text.splitlines():
        if " time " in line:
            heading, _, end = line.strip().rpartition(" time ")
            found.append((heading, float(end), []))
        elif line.strip():
            found[-1][2].append([float(word) for word in line.split()])
    yield from found


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
    version = subprocess.run(["ccx", "-v"], capture_output=True, text=True, check=False).stdout.split()[-1]
    answer = Answer("CalculiX", version, "GPL 2 or later")
    with tempfile.TemporaryDirectory() as folder:
        job = Path(folder) / _JOB
        job.with_suffix(".inp").write_text(deck(case, ridge), encoding="ascii")
        answer.ready()
        run = subprocess.run(["ccx", "-i", _JOB], cwd=folder, capture_output=True, text=True, check=False)
        answer.done()
        if "Job finished" not in run.stdout:
            raise RuntimeError("CalculiX: " + "; ".join(run.stdout.split("\n")[-12:]))
        tables = list(blocks(job.with_suffix(".dat").read_text(encoding="ascii")))
        summary = [line.split() for line in job.with_suffix(".sta").read_text(encoding="ascii").splitlines()[2:]]
    answer.iterations = sum(int(row[3]) for row in summary)
    for step, load in enumerate(case.loads, start=1):
        if load.name:
            found = {"".join(heading.split()[:2]): rows for heading, time, rows in tables if round(time) == step}
            u = np.full((len(ridge.points), 2), np.nan)
            for node, *components in found["displacements(vx,vy,vz)"]:
                u[int(node) - 1] = components[:2]
            f_x, f_y, _ = np.array(found["forces(fx,fy,fz)"])[:, 1:].sum(axis=0)
            points = on_skin(ridge, u, found["relativecontact"], found["contactstress"]).T
            answer.report(load, -f_y, -f_x, u[ridge.skin.ravel()], *points)
    return answer


if __name__ == "__main__":
    main(solve)
