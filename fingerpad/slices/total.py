"""The finger along its axis, and the sum over its slices: forces in N and areas in m², at an indentation or a force."""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache, cached_property, lru_cache
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.interpolate import PchipInterpolator
from scipy.optimize import brentq

from fingerpad.scene.messages import SceneError
from fingerpad.scene.parameters import Slices
from fingerpad.slices.trace import Trace, borne

Array = NDArray[np.float64]
Floats = NDArray[np.floating[Any]]
_SEARCHED = 2001  # places along the finger between which ends of contact are looked for
_SEARCHED_FOR_DEEPEST = 4001  # places along the finger among which the first to end its trace is looked for
_DOUBLINGS = 6  # of the depth, from the least one tried to the end of the trace
_OVERHANG = 0.05  # way along the screen over that along the bone, from which a tilted finger's lower side is left out
_TIP = 1e-12  # least square of the scale at the tip of an ellipsoid, whose slope is infinite there
_SMALLEST_FORCE = 1e-300  # N, of a logarithm
AREAS = {"contact_length": "contact_area", "gross_width": "gross_area"}
"""Columns of a slice whose sums have names of their own."""
RATIOS = {"real_over_gross": ("contact_area", "gross_area"), "shear_stress": ("f_t", "contact_area")}
"""Quantities of the whole finger that are ratios of two sums. Their relative error is that of both."""


def _lowest(of: Callable[[Floats], Floats], ends: tuple[float, float], count: int) -> tuple[float, float, bool]:
    """Return the place (m) of the least value, the value, and whether it is at an end of the places searched."""
    z = np.linspace(*ends, count)
    k = int(np.argmin(of(z)))
    fine = np.linspace(z[max(k - 1, 0)], z[min(k + 1, count - 1)], count)
    found = of(fine)
    return float(fine[found.argmin()]), float(found.min()), k in (0, count - 1)


@dataclass(frozen=True)
class Profile:
    """A finger along its axis, from ``ends[0]`` to ``ends[1]`` (m)."""

    ends: tuple[float, float]
    height: Callable[[Floats | float], Floats | float]
    """Height (m) of the lower side over the screen, but for a constant, at places z (m) along the bone."""
    width: Callable[[Floats], Floats]
    """Scale w of the slices at places z (m)."""
    stretch: Callable[[Floats], Floats] = np.ones_like
    """Way along the screen over that along the bone at places z (m), where a tilt makes them different."""
    straight: bool = False
    """Whether all heights are 0: then the ends may touch."""

    def rise(self, z: Floats | float) -> Floats:
        """Return how far slices (m) stand above the one that touches first (m)."""
        return self._above(z) - self._lowest[1]

    def _above(self, z: Floats | float) -> Floats:
        return np.asarray(self.height(z), dtype=float)

    @cached_property
    def _searched(self) -> tuple[Floats, Floats]:
        """Places along the finger (m), and the rise of the slices there (m)."""
        z = np.linspace(*self.ends, _SEARCHED)
        return z, self.rise(z)

    @cached_property
    def _lowest(self) -> tuple[float, float]:
        """The place (m) where the finger first touches, and the height (m) there, the least one."""
        place, least, at_end = _lowest(self._above, self.ends, _SEARCHED)
        if at_end and not self.straight:
            raise SceneError(
                f"slices.tilt makes the finger lowest at its end, at z = {place:.3g} m, so that its pad has no "
                "contact; give a smaller tilt, a smaller radius, a longer finger, or slices.shape = 'ellipsoid'"
            )
        return place, least

    @cached_property
    def centre_scale(self) -> float:
        """The scale of the slice where the finger first touches."""
        return float(self.width(np.array([self._lowest[0]]))[0])

    def contact(self, delta: float) -> list[tuple[float, float]]:
        """Return the stretches (m) that touch when the bone is lowered by delta (m) since the finger first touched.

        Raises:
            SceneError: the contact reaches an end of the finger, or the finger is lowest there.
        """
        z, rise = self._searched
        touches = delta - rise > 0
        if not touches.any():
            return self._between(delta, z)
        if not self.straight and (touches[0] or touches[-1]):
            end = z[0] if touches[0] else z[-1]
            raise SceneError(
                f"the finger ends at z = {end:.3g} m, and at an indentation of {delta:.3g} m the contact goes beyond; "
                "give a smaller force or tilt, or a longer finger (slices.length or slices.shape, or slices.z and "
                "slices.height)"
            )
        edges = np.flatnonzero(touches[1:] != touches[:-1])
        roots = [self._root(delta, z[k], z[k + 1]) for k in edges]
        roots = [*([z[0]] if touches[0] else []), *roots, *([z[-1]] if touches[-1] else [])]
        return [(float(a), float(b)) for a, b in zip(roots[::2], roots[1::2], strict=True)]

    def _between(self, delta: float, z: Floats) -> list[tuple[float, float]]:
        """Return a contact shorter than the places searched, if there is one."""
        k = int(np.clip(np.argmin(self._searched[1]), 1, len(z) - 2))
        fine = np.linspace(z[k - 1], z[k + 1], _SEARCHED)
        inside = np.flatnonzero(delta - self.rise(fine) > 0)
        if not inside.size:
            return []
        a, b = fine[max(inside[0] - 1, 0)], fine[min(inside[-1] + 1, len(fine) - 1)]
        return [(self._root(delta, a, fine[inside[0]]), self._root(delta, fine[inside[-1]], b))]

    def _root(self, delta: float, a: float, b: float) -> float:
        return float(brentq(lambda z: delta - float(self.rise(z)), a, b, xtol=1e-15))


@lru_cache(maxsize=64)
def profile(slices: Slices) -> Profile:
    """Return the finger that a scene's table describes; tables are interpolated monotonically, by cubics."""
    level, slope = _level(slices)
    return tilted(level, slope, slices.tilt) if slices.tilt else level


def tilted(level: Profile, slope: Callable[[Floats], Floats], angle: float) -> Profile:
    r"""Return a finger whose bone is turned by an angle α (rad), cut across the screen as before.

    .. math:: y = s \cos\alpha + z \sin\alpha, \qquad \frac{d\zeta}{dz} = \cos\alpha - s' \sin\alpha
              = \frac{\cos(\varphi + \alpha)}{\cos\varphi}, \qquad \tan\varphi = s'

    at the place ζ along the screen. A section across the bone leans against the skin's normal by φ, one across the
    screen by φ + α. By Meusnier's theorem its radius is that of the first one times the same ratio, and so is its scale
    w: on a sphere, whose sections across the bone have w = cos φ, it is that of the level finger at any tilt.

    Args:
        level: the finger with its bone along the screen.
        slope: ds/dz at places z (m).
        angle: α (rad), positive where the end at z < 0 goes down.
    """
    sine, cosine = math.sin(angle), math.cos(angle)

    def stretch(z: Floats) -> Floats:
        return np.asarray(cosine - sine * slope(z))

    z = np.linspace(*level.ends, _SEARCHED)
    with np.errstate(all="ignore"):
        upright = z[stretch(z) > _OVERHANG]  # beyond, the lower side turns away from the screen
    return Profile(
        (float(upright[0]), float(upright[-1])),
        lambda z: level.height(z) * cosine + z * sine,
        lambda z: level.width(z) * stretch(z),
        stretch,
    )


def _level(slices: Slices) -> tuple[Profile, Callable[[Floats], Floats]]:
    """Return the finger with its bone along the screen, and the slope of its lower side over the place (m)."""
    places = None if slices.z is None else np.array(slices.z)
    width = np.ones_like if slices.width is None else PchipInterpolator(places, slices.width)
    if slices.height is not None:
        assert places is not None
        height = np.array(slices.height)
        bent = PchipInterpolator(places, height)
        return Profile((places[0], places[-1]), bent, width, straight=not height.any()), bent.derivative()
    half, radius = slices.length / 2, slices.radius
    ends = (-half, half) if places is None else (max(-half, places[0]), min(half, places[-1]))
    if slices.shape == "parabola":
        return Profile(ends, lambda z: z**2 / (2 * radius), width), lambda z: z / radius

    def scale(z: Floats | float) -> Floats:
        return np.sqrt(np.maximum(1 - (z / half) ** 2, _TIP))

    width = scale if slices.width is None else width
    return Profile(ends, lambda z: half**2 / radius * (1 - scale(z)), width), lambda z: z / (radius * scale(z))


class BeyondTrace(SceneError):  # noqa: N818
    """A force or an indentation that the trace does not reach; one sentence."""


@dataclass(frozen=True, eq=False)
class Total:
    """A whole finger in one state, and its slices; arrays have shape (slices,)."""

    delta: float
    """Indentation of the slice that touches first (m): how far the bone was lowered since then."""
    z: Array
    """Places of the slices (m)."""
    thickness: Array
    """Thickness of each slice (m); its weight in the sum."""
    depth: Array
    """Indentation of each slice (m)."""
    centre: float
    """External force of the slice that is indented most (N/m)."""
    columns: dict[str, Array]
    """Of each slice, by the names of a trace's columns: N/m and m."""

    @property
    def summed(self) -> dict[str, str]:
        """Name of each sum, and of the column of a slice that it is the sum of."""
        return {AREAS.get(column, column): column for column in self.columns}

    @cached_property
    def totals(self) -> dict[str, float]:
        """Sums over the slices by name: N and m²."""
        return {name: float(self.thickness @ self.columns[column]) for name, column in self.summed.items()}

    @property
    def mu_app(self) -> float:
        """Apparent friction coefficient of the whole finger."""
        return self.totals["f_t"] / self.totals["f_ext"]

    @property
    def values(self) -> dict[str, float]:
        """The sums with what follows from them: N, m², m, and the apparent friction coefficient."""
        width = self.totals["f_ext"] / self.centre
        ratios = {name: self.totals[a] / self.totals[b] for name, (a, b) in RATIOS.items()}
        return self.totals | {"mu_app": self.mu_app, "indentation": self.delta, "effective_width": width} | ratios

    @property
    def pressure(self) -> Array:
        """Mean contact pressure of each slice over its contact length (Pa), shape (slices,)."""
        force, length = borne(self.columns), self.columns["contact_length"]
        return np.divide(force, length, out=np.zeros_like(force), where=length > 0)

    def slices(self) -> dict[str, Array]:
        """Return all values of the slices by name; m, N/m and Pa, shape (slices,)."""
        places = {"z": self.z, "thickness": self.thickness, "indentation": self.depth}
        length, gross = (self.columns[name] for name in AREAS)
        share = np.divide(length, gross, out=np.zeros_like(length), where=gross > 0)
        return places | self.columns | {"pressure": self.pressure, "real_over_gross": share}


def at_indentation(profile: Profile, trace: Trace, delta: float, count: int) -> Total:
    """Return the finger at an indentation.

    The slices are the points of a Gauss rule in φ, with z = z_m + a sin φ in each stretch of contact from z_m − a to
    z_m + a: so a force that starts as a power of the distance from the edge of contact is summed as a smooth one.

    Args:
        profile: the finger along its axis.
        trace: of a slice on the scale 1.
        delta: lowering of the bone since the finger first touched (m).
        count: slices in each stretch of contact.

    Raises:
        SceneError: the contact goes beyond the finger, or a slice beyond the trace.
    """
    z, thickness = places(profile, delta, count)
    depth, width = np.maximum(delta - profile.rise(z), 0.0), np.asarray(profile.width(z), dtype=float)
    relative = depth / width
    deepest, force = trace.end
    if relative.size and relative.max() > deepest * (1 + 1e-9):
        raise BeyondTrace(
            f"a slice is indented by {relative.max():.3g} m, and the trace of the cross-section ends at {deepest:.3g} "
            f"m under {force:.4g} N/m; give a trace to a larger force"
        )
    scale = profile.centre_scale
    values = trace.at(np.clip([*relative, delta / scale], 0.0, deepest))  # the last one is the deepest place
    power = {each.name: each.power for each in trace.own}
    columns = {name: width ** power.get(name, 1) * values[name][:-1] for name in trace.columns}
    return Total(delta, z, thickness, depth, scale * float(values["f_ext"][-1]), columns)


def places(profile: Profile, delta: float, count: int) -> tuple[Array, Array]:
    """Return places and thicknesses (m) of the slices of :func:`at_indentation`."""
    nodes, weights = _gauss(count)
    ends = np.array(profile.contact(delta)).reshape(-1, 2)
    middle, half = ends.mean(axis=1, keepdims=True), np.diff(ends) / 2
    phi = np.pi / 2 * nodes
    z = (middle + half * np.sin(phi)).ravel()
    return z, (half * np.cos(phi) * np.pi / 2 * weights).ravel() * profile.stretch(z)


_gauss = cache(np.polynomial.legendre.leggauss)


def at_force(profile: Profile, trace: Trace, force: float, count: int) -> Total:
    """Return the finger under an external force (N) greater than 0; other arguments as of :func:`at_indentation`.

    Raises:
        BeyondTrace: the trace ends before the force is reached; the message has the largest force.
        SceneError: the pad has no contact, or more of it than the finger has.
    """
    most = deepest(profile, trace)
    totals = dict[float, Total]()

    def excess(x: float) -> float:
        """Return the logarithm of the force over the one looked for, nearly a straight line over that of the depth."""
        if x not in totals:
            totals[x] = at_indentation(profile, trace, math.exp(x), count)
        return math.log(max(totals[x].totals["f_ext"], _SMALLEST_FORCE) / force)

    high = math.log(most)
    try:
        above = excess(high)
    except SceneError:  # the finger ends before its trace: from the first touch on, as far as there is a finger
        high -= _DOUBLINGS * math.log(2)
        while (above := excess(high)) < 0:
            high += math.log(2)
    if above < 0:
        raise BeyondTrace(
            f"the force is {force:.4g} N, and the trace of the cross-section to {trace.end[1]:.4g} N/m goes up to "
            f"{totals[high].totals['f_ext']:.4g} N of the whole finger; give a trace to a larger force"
        )
    low = high - above  # the force grows with the depth at least, as a rule faster
    while excess(low) > 0:
        low -= math.log(2)
    return totals[float(brentq(excess, low, high, xtol=1e-15, rtol=4 * np.finfo(float).eps))]


def under_one_force(
    profile: Profile, traces: Mapping[str, Trace], count: int, f_ext: float | None = None
) -> dict[str, Total]:
    """Return the finger in several states under one force, the largest that all of their traces reach.

    At one indentation the states bear other forces. Arguments are as of :func:`at_indentation`; ``f_ext`` is the force
    (N/m) up to which the traces are used, by default their ends.
    """
    ends = (at_indentation(profile, each, deepest(profile, each, f_ext), count) for each in traces.values())
    force = min(total.totals["f_ext"] for total in ends)
    return {name: at_force(profile, each, force * (1 - 1e-9), count) for name, each in traces.items()}


def deepest(profile: Profile, trace: Trace, f_ext: float | None = None) -> float:
    """Return the lowering since the first touch (m) at which the first slice comes to the end of the trace.

    With a force (N/m) on the trace, in place of the end.
    """
    end = trace.end[0] if f_ext is None else trace.under(f_ext)

    return _lowest(lambda z: profile.rise(z) + end * profile.width(z), profile.ends, _SEARCHED_FOR_DEEPEST)[1]
