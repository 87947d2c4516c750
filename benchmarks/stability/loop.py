r"""The fixed point over one uniform ridge, without the error of a mesh: which keys of the closure let it converge.

A ridge under the mean external pressure p carries the contact pressure :math:`p_c = p + \sigma_{el}(d)`. Keyed on
p_c, a sweep is :math:`d_{k+1} = d_{eq}(p + \sigma_{el}(d_k))`. Keyed on the external pressure with contact pressure
and attraction one sweep out of phase, :math:`d_{k+1} = d_{ext}(p + \sigma_{el}(d_{k-1}) - \sigma_{el}(d_k))`, it
diverges where :math:`a = \sigma_{el}' d_{ext}' > 1/2`: the larger root of :math:`z^2 + a z - a` leaves the unit circle.
"""

from dataclasses import dataclass

from variational.roughness.bam import BearingArea

_EPS_0 = 8.854e-12  # F/m
_TOLERANCE, _CAP = 1e-6, 200


@dataclass(frozen=True)
class Loop:
    """How the two fixed points end: sweeps, or None where they diverge, and the gain a of the second."""

    gain: float
    by_contact: int | None
    by_external: int | None


def loop(closure: BearingArea, pressure: float, voltage: float, disturbance: float = 1e-2) -> Loop:
    """Iterate both fixed points at an external pressure (Pa) and voltage (V), from a disturbed common solution.

    Raises:
        ValueError: no equilibrium in contact at this pressure.
    """
    solution = closure.air_gap_at_external(pressure, voltage)
    step = 1e-4 * pressure
    above, below = (closure.air_gap_at_external(pressure + side * step, voltage) for side in (1, -1))

    def attraction(d: float) -> float:
        """Return the attraction (Pa) across an air gap (m), Eq. 3."""
        return _EPS_0 * voltage**2 / 2 / (closure.h_0 + d) ** 2

    def by_contact(d: float, previous: float) -> float:
        return float(closure(pressure + attraction(d)).d_eq)

    def by_external(d: float, previous: float) -> float:
        return closure.air_gap_at_external(pressure + attraction(previous) - attraction(d), voltage)

    def sweeps(sweep) -> int | None:
        previous, d = solution, solution * (1 + disturbance)
        for k in range(1, _CAP + 1):
            try:
                previous, d = d, sweep(d, previous)
            except ValueError:  # thrown off the branch in contact
                return None
            if abs(d - solution) <= _TOLERANCE * solution:
                return k
        return None

    stiffness = 2 * attraction(solution) / (closure.h_0 + solution)
    return Loop((below - above) / (2 * step) * stiffness, sweeps(by_contact), sweeps(by_external))
