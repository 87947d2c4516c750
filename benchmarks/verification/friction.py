r"""Coulomb friction: full slip and partial slip of a cylinder.

Cattaneo and Mindlin (Johnson, Contact Mechanics, 1985, sec. 7.2(a), doi 10.1017/CBO9781139171731): a cylinder under
the normal force P that is then pushed sideways by Q < mu P sticks for |x| < c and bears

.. math:: t = \mu p_0 \left( \sqrt{1 - x^2 / a^2} - \frac ca \sqrt{1 - x^2 / c^2} \right), \qquad
          c = a \sqrt{1 - Q / (\mu P)},

the second root in |x| < c only. It takes normal tractions that do not move the surface sideways: nu is 0.499, the
element P2-P1. The body is the block of Hertz's case with a side of 300 a: pressed, it bulges, and the strain of its
bottom, f / (E* 300 a), is felt as a shear of 1 % of mu p_0.

"""

import numpy as np

from benchmarks.verification.bodies import Array, Smooth, formulations, over_screen
from benchmarks.verification.case import IDENTITY, Case, Row
from geometry.bodies import pad, ridge
from variational.contact.augmented import AugmentedLagrangian
from variational.contact.formulation import Formulation
from variational.contact.interface import Interface
from variational.contact.nitsche import Nitsche
from variational.contact.penalty import Penalty
from variational.materials.ogden import Ogden
from variational.solvers.continuation import Continuation, Target

_H_0 = 0.514e-6


def full_slip(small: bool) -> list[Row]:
    """One ridge of skin under 100 V, dragged to full slip and 0.2 mm further."""
    mu_f, force, mesh = 0.25, 5.0, "P2, facets of 20 um"
    ways: dict[str, Formulation] = {"penalty": Penalty(1.5e12, 5e10)}
    ways |= {f"Nitsche {theta}": Nitsche(10.0, theta) for theta in ((0,) if small else (0, 1, -1))}
    ways |= {} if small else {"augmented Lagrangian": AugmentedLagrangian(1.5e13, 5e11, 5e-10)}
    rows = []
    for name, formulation in ways.items():
        skin, interface = Ogden(86.76e3, -14.53, 0.48), Interface(formulation, mu_f, _H_0)
        run = over_screen(ridge(20e-6), skin, interface, force, closure=Smooth(2e-6))
        run.run(Target("press", f_ext=force))
        run.run(Target("charge", voltage=100.0))
        for x in (10e-6, 20e-6, 30e-6, 45e-6, 0.4e-3):
            run.run(Target("slide", bone_x=x, until_full_slip=True))
        first = -run.solver.reaction[0]
        run.run(Target("slide on", bone_x=run.solver.control.x + 0.2e-3))
        f_t, f_c = -run.solver.reaction[0], float(run.observer.ridge_loads(run.surface_state).f_contact[0])
        why = "asked for: the law, to the nodal imbalances of the solve"
        rows.append(Row(f"f_T at full slip over mu_0 f_c, {name}", f_t / (mu_f * f_c), 1.0, 1e-6, why, mesh))
        same = 1e-6
        if isinstance(formulation, AugmentedLagrangian):
            same, why = 1e-5, "multipliers end at 0.5 nm, over which the attraction beside the contact changes by 4e-4"
        rows.append(Row(f"f_T after 0.2 mm more, over that, {name}", f_t / first, 1.0, same, why, mesh))
    return rows


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


_COULOMB = "Coulomb's law: f_T is mu_0 times the contact force, wherever the plane is"
_CATTANEO = "Cattaneo 1938, Mindlin 1949, in Johnson 1985, sec. 7.2(a), doi 10.1017/CBO9781139171731"
CASES = (
    Case("Full slip", _COULOMB, full_slip, IDENTITY),
    Case("Partial slip", _CATTANEO, partial_slip),
)
