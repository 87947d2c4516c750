"""The sum over slices: forces in N and areas in m² of a finger at an indentation, or under a force."""

from dataclasses import dataclass
from functools import cache, cached_property
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from fingerpad.scene.messages import SceneError
from fingerpad.slices.profile import Profile
from fingerpad.slices.trace import NAMES, Trace

Array = NDArray[np.float64]
_SEARCHED = 4001  # places along the finger among which the first to end its trace is looked for
TOTALS = {
    "f_ext": "f_ext",
    "f_t": "f_t",
    "f_electrostatic": "f_electrostatic",
    "contact_area": "contact_length",
    "gross_area": "gross_width",
}
"""Name of each sum, and of the column of a slice that it is the sum of."""


class BeyondTrace(SceneError):  # noqa: N818
    """A force or an indentation that the trace does not reach; one sentence."""


@dataclass(frozen=True, eq=False)
class Total:
    """A whole finger in one state, and its slices; arrays have shape (slices,)."""

    delta: float
    """Lowering of the bone at z = 0 (m)."""
    z: Array
    """Places of the slices (m)."""
    thickness: Array
    """Thickness of each slice (m); its weight in the sum."""
    depth: Array
    """Indentation of each slice (m)."""
    centre: float
    """External force of the slice that is indented most (N/m)."""
    columns: dict[str, Array]
    """Of each slice, by the names of :data:`fingerpad.slices.trace.NAMES`: N/m and m."""

    @cached_property
    def totals(self) -> dict[str, float]:
        """Sums over the slices by the names of :data:`TOTALS`: N and m²."""
        return {name: float(self.thickness @ self.columns[column]) for name, column in TOTALS.items()}

    @property
    def mu_app(self) -> float:
        """Apparent friction coefficient of the whole finger."""
        return self.totals["f_t"] / self.totals["f_ext"]

    @property
    def values(self) -> dict[str, float]:
        """The sums with what follows from them: N, m², m, and the apparent friction coefficient."""
        width = self.totals["f_ext"] / self.centre
        return self.totals | {"mu_app": self.mu_app, "indentation": self.delta, "effective_width": width}

    @property
    def pressure(self) -> Array:
        """Mean contact pressure of each slice over its contact length (Pa), shape (slices,)."""
        borne = self.columns["f_ext"] + self.columns["f_electrostatic"]
        length = self.columns["contact_length"]
        return np.divide(borne, length, out=np.zeros_like(borne), where=length > 0)

    def slices(self) -> dict[str, Array]:
        """Return all values of the slices by name; m, N/m and Pa, shape (slices,)."""
        places = {"z": self.z, "thickness": self.thickness, "indentation": self.depth}
        return places | self.columns | {"pressure": self.pressure}


def at_indentation(profile: Profile, trace: Trace, delta: float, count: int) -> Total:
    """Return the finger at an indentation.

    The slices are the points of a Gauss rule in φ, with z = z_m + a sin φ in each stretch of contact from z_m − a to
    z_m + a: so a force that starts as a power of the distance from the edge of contact is summed as a smooth one.

    Args:
        profile: the finger along its axis.
        trace: of a slice on the scale 1.
        delta: lowering of the bone (m).
        count: slices in each stretch of contact.

    Raises:
        SceneError: the contact goes beyond the finger, or a slice beyond the trace.
    """
    z, thickness = _places(profile, delta, count)
    depth, width = np.maximum(delta - profile.rise(z), 0.0), np.asarray(profile.width(z), dtype=float)
    relative = depth / width
    deepest, force = trace.end
    if relative.size and relative.max() > deepest * (1 + 1e-9):
        raise BeyondTrace(
            f"a slice is indented by {relative.max():.3g} m, and the trace of the cross-section ends at {deepest:.3g} "
            f"m under {force:.4g} N/m; give a trace to a larger force"
        )
    (_, lowest), scale = profile.lowest, profile.centre_scale
    values = trace.at(np.clip([*relative, (delta - lowest) / scale], 0.0, deepest))  # the last one is the deepest place
    columns = {name: width * values[name][:-1] for name in NAMES}
    return Total(delta, z, thickness, depth, scale * float(values["f_ext"][-1]), columns)


def _places(profile: Profile, delta: float, count: int) -> tuple[Array, Array]:
    """Return places and thicknesses (m) of the slices of :func:`at_indentation`."""
    nodes, weights = _gauss(count)
    ends = np.array(profile.contact(delta)).reshape(-1, 2)
    middle, half = ends.mean(axis=1, keepdims=True), np.diff(ends) / 2
    phi = np.pi / 2 * nodes
    return (middle + half * np.sin(phi)).ravel(), (half * np.cos(phi) * np.pi / 2 * weights).ravel()


_gauss = cache(np.polynomial.legendre.leggauss)


def at_force(profile: Profile, trace: Trace, force: float, count: int) -> Total:
    """Return the finger under a force.

    Args:
        profile: the finger along its axis.
        trace: of a slice on the scale 1.
        force: external force (N), greater than 0.
        count: slices in each stretch of contact.

    Raises:
        BeyondTrace: the trace ends before the force is reached; the message has the largest force.
        SceneError: the pad has no contact, or more of it than the finger has.
    """
    (_, touch), most = profile.lowest, deepest(profile, trace)

    def excess(delta: float) -> float:
        return at_indentation(profile, trace, delta, count).totals["f_ext"] - force

    low, high = touch, touch
    while True:  # from the first touch, so that a force within the finger is found before its ends are reached
        low, high = high, min(touch + 2 * max(high - touch, (most - touch) / 64), most)
        if excess(high) >= 0:
            break
        if high >= most:
            raise BeyondTrace(
                f"the force is {force:.4g} N, and the trace of the cross-section to {trace.end[1]:.4g} N/m goes up to "
                f"{excess(high) + force:.4g} N of the whole finger; give a trace to a larger force"
            )
    delta = brentq(excess, low, high, xtol=1e-16, rtol=1e-14)
    return at_indentation(profile, trace, float(delta), count)


def deepest(profile: Profile, trace: Trace) -> float:
    """Return the lowering (m) at which the first slice comes to the end of the trace."""

    def lowered(z: NDArray[Any]) -> NDArray[Any]:
        return np.asarray(profile.rise(z) + trace.end[0] * profile.width(z))

    z = np.linspace(*profile.ends, _SEARCHED)
    k = int(np.argmin(lowered(z)))
    return float(lowered(np.linspace(z[max(k - 1, 0)], z[min(k + 1, len(z) - 1)], _SEARCHED)).min())
