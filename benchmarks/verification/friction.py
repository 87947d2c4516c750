r"""Coulomb friction: partial slip of a cylinder.

Cattaneo and Mindlin (Johnson, Contact Mechanics, 1985, sec. 7.2(a), doi 10.1017/CBO9781139171731): a cylinder under
the normal force P that is then pushed sideways by Q < mu P sticks for |x| < c and bears

.. math:: t = \mu p_0 \left( \sqrt{1 - x^2 / a^2} - \frac ca \sqrt{1 - x^2 / c^2} \right), \qquad
          c = a \sqrt{1 - Q / (\mu P)},

the second root in |x| < c only. It takes normal tractions that do not move the surface sideways: nu is 0.499, the
element P2-P1. The body is the block of Hertz's case with a side of 300 a: pressed, it bulges, and the strain of its
bottom, f / (E* 300 a), is felt as a shear of 1 % of mu p_0.

"""

import numpy as np

from benchmarks.verification.bodies import Array, formulations, over_screen
from benchmarks.verification.case import Case, Row
from geometry.bodies import pad
from variational.contact.interface import Interface
from variational.materials.ogden import Ogden
from variational.solvers.continuation import Continuation, Target

_H_0 = 0.514e-6


SHEAR_MODULUS, NU, RADIUS, HALF_WIDTH, MU_F = 1e6 / 3, 0.499, 1.0, 0.5e-3, 0.5
FORCE = np.pi * 2 * SHEAR_MODULUS / (1 - NU) * HALF_WIDTH**2 / (4 * RADIUS)


def shear(x: Array, part: float) -> Array:
    """Return Cattaneo's shear (Pa) at abscissae (m) for Q / (mu P)."""
    a, c = HALF_WIDTH, HALF_WIDTH * np.sqrt(1 - part)

    def root(b: float) -> Array:
        return np.sqrt(np.clip(1 - (x / b) ** 2, 0, None))

    return MU_F * 2 * FORCE / (np.pi * a) * (root(a) - c / a * root(c))


def _partial(run: Continuation) -> tuple[float, float, float]:
    """Return Q / (mu P), the stick's half-width (m) and the largest error of the shear borne left of a place over Q."""
    s, surface = run.surface_state, run.problem.surface
    q = -float(run.solver.reaction[0])
    part = q / (MU_F * FORCE)
    order = np.argsort(s.x.ravel())
    x, sticks = s.x.ravel()[order], ((s.p_n > 0) & (np.abs(s.t_t) < MU_F * s.p_n * (1 - 1e-8))).ravel()[order]
    inside = np.flatnonzero(sticks)
    left, right = (x[k] + x[k + 1] for k in (inside[0] - 1, inside[-1]))
    off = (-s.t_t - shear(s.x, part)) @ surface.weights * surface.length
    return part, (right - left) / 4, float(np.abs(np.cumsum(off[np.argsort(s.x[:, 0])])).max()) / q


def partial_slip(small: bool) -> list[Row]:
    """A cylinder pressed, then pushed sideways in four steps."""
    facets = 10 if small else 60
    size = HALF_WIDTH / (facets + 0.5)
    # At alpha = -2 Ogden's law has squares of the stretches.
    solid = Ogden(SHEAR_MODULUS, -2.0, NU)
    interface = Interface(formulations(3 * SHEAR_MODULUS / size, 1e-11)["penalty"], MU_F, _H_0)
    # Pressing moves the surface sideways so little that one step will do.
    run = over_screen(
        pad(size, int(np.ceil(1.3 * facets)), RADIUS, 300 * HALF_WIDTH), solid, interface, FORCE,
        element="P2-P1", tolerance=1e-6, touch_depth=0.5e-6, step_scale=7.5,
    )  # fmt: skip
    run.run(Target("press", f_ext=FORCE))
    mesh = f"P2-P1, facets of a / {facets + 0.5:g}"
    tolerance, why = 0.01, "asked for; a facet is 1.7 % of a, its points lie a quarter of that apart"
    if small:
        tolerance, why = 0.03, "a third of a facet of a / 10"
    widths, shears = [], []
    for x in (0.2e-6, 0.4e-6, 0.6e-6, 0.8e-6):
        run.run(Target("slide", bone_x=x))
        part, stick, cumulated = _partial(run)
        load, exact = f"at Q / mu P = {part:.3f}", HALF_WIDTH * float(np.sqrt(1 - part))
        widths.append(Row(f"stick half-width {load} (m)", stick, exact, tolerance, why, mesh))
        quantity = f"shear borne left of a place over Q, most off, {load}"
        shears.append(Row(quantity, cumulated, 0.0, tolerance, why, mesh, absolute=True))
    return widths + shears


_CATTANEO = "Cattaneo 1938, Mindlin 1949, in Johnson 1985, sec. 7.2(a), doi 10.1017/CBO9781139171731"
CASES = (Case("Partial slip", _CATTANEO, partial_slip),)
