"""Curves of the fingertip's cross-section as plain NumPy functions.

Every curve is a depth below the elliptical outline, measured along its inward normal, as a function of the
arc length s from the lowest point (positive towards x > 0). The phase of a ridge is theta = 2 pi s / wavelength,
so all interfaces have the same number of periods (Table 1's three wavelengths are the one of the outline,
mapped to deeper offset curves).

The crests of the ridges are on the outline. A measured profile may have them beside the middle of its ridge, where the
outline is already a micrometre or two above its lowest point; then the whole skin is lowered by that much, so that the
lowest crest is at y = 0 in every case.
"""

from dataclasses import dataclass
from functools import cached_property
from typing import TYPE_CHECKING

import numpy as np
import scipy  # its parts are imported where they are used first: to read a scene needs none
from numpy.typing import ArrayLike, NDArray

from geometry.parameters import Fingertip

if TYPE_CHECKING:
    from scipy.spatial import cKDTree


Array = NDArray[np.float64]
_ALONG = 400  # places a ridge, between which the skin is straight
_ITERATIONS, _ROUNDOFF = 50, 1e-14  # of angles (rad)
_PHASES = np.linspace(0, np.pi, 2001)  # rad, half a period of a ridge's profile, which is even


class GeometryError(ValueError):
    """A set of parameters that describes no fingertip; the message names the parameter at fault."""


@dataclass(frozen=True)
class Profiles:
    """Outline, interfaces and receptor sites of a fingertip; lengths in m."""

    finger: Fingertip

    # -- outline ---------------------------------------------------------------------------------------
    @cached_property
    def _arc_table(self) -> tuple[Array, Array]:
        a, b = self.finger.width / 2, self.finger.height / 2
        phi: Array = np.linspace(0.0, np.pi, 20001, dtype=np.float64)
        speed = np.sqrt((a * np.cos(phi)) ** 2 + (b * np.sin(phi)) ** 2)
        return phi, np.asarray(scipy.integrate.cumulative_simpson(speed, x=phi, initial=0.0), dtype=float)

    def _angle(self, s: ArrayLike) -> Array:
        phi, arc = self._arc_table
        s = np.asarray(s, dtype=float)
        return np.sign(s) * np.interp(np.abs(s), arc, phi)

    def arc_length(self, x: float) -> float:
        """Return the arc length of the dorsal point of the outline at abscissa ``x`` >= 0."""
        phi, arc = self._arc_table
        return float(np.interp(np.pi - np.arcsin(x / (self.finger.width / 2)), phi, arc))

    def point(self, s: ArrayLike, depth: ArrayLike = 0.0) -> Array:
        """Return the points at arc length ``s`` and ``depth`` below the outline; shape (n, 2)."""
        a, b = self.finger.width / 2, self.finger.height / 2
        phi = self._angle(s)
        normal = np.stack([-np.sin(phi) / a, np.cos(phi) / b], axis=-1)
        normal /= np.linalg.norm(normal, axis=-1, keepdims=True)
        outline = np.stack([a * np.sin(phi), b * (1 - np.cos(phi)) - self.lowered], axis=-1)
        return np.asarray(outline + np.asarray(depth, dtype=float)[..., None] * normal, dtype=float)

    def below(self, points: Array) -> tuple[Array, Array]:
        """Return the arc lengths and depths (m) of points, shape (n, 2), nearer to the outline than its evolute."""
        a, b = self.finger.width / 2, self.finger.height / 2
        x, y = points[:, 0], points[:, 1] + self.lowered - b
        phi = np.arctan2(x / a, -y / b)
        for _ in range(_ITERATIONS):  # Newton's method for the angle at which the way to the point is normal
            sin, cos = np.sin(phi), np.cos(phi)
            off = (x - a * sin) * a * cos + (y + b * cos) * b * sin
            slope = -((a * cos) ** 2) - (b * sin) ** 2 - (x - a * sin) * a * sin + (y + b * cos) * b * cos
            phi = phi - off / slope
            if np.abs(off / slope).max(initial=0.0) < _ROUNDOFF:
                break
        sin, cos = np.sin(phi), np.cos(phi)
        normal = np.stack([-sin / a, cos / b]) / np.hypot(sin / a, cos / b)
        angles, arc = self._arc_table
        return np.sign(phi) * np.interp(np.abs(phi), angles, arc), (x - a * sin) * normal[0] + (y + b * cos) * normal[1]

    @property
    def half_perimeter(self) -> float:
        """Arc length from the lowest to the highest point of the outline."""
        return float(self._arc_table[1][-1])

    @property
    def nail_arc(self) -> float:
        """Arc length from the lowest point to the nail's edge; the skin's layers end there."""
        return self.arc_length(self.finger.nail_half_width)

    @property
    def ridged_arc(self) -> float:
        """Arc length from the lowest point to the groove beyond the last full ridge."""
        return self.finger.ridge_count * self.finger.ridge_wavelength / 2

    # -- depths ----------------------------------------------------------------------------------------
    def _window(self, s: ArrayLike) -> Array:
        """One where there are ridges, falling smoothly to zero over the period beyond the last one."""
        t = np.clip((np.abs(s) - self.ridged_arc) / self.finger.ridge_wavelength, 0.0, 1.0)
        return np.asarray(1 - t**3 * (10 - 15 * t + 6 * t**2), dtype=float)

    @cached_property
    def harmonics(self) -> Array:
        """Cosine coefficients of the ridge's height above its mean, with the given peak-to-peak amplitude."""
        c = np.asarray(self.finger.ridge_profile, dtype=float)
        shape = np.cos(np.outer(_PHASES, np.arange(1, len(c) + 1))) @ c
        return c * self.finger.ridge_amplitude / np.ptp(shape)

    def _wave(self, theta: ArrayLike) -> Array:
        """Height of a ridge above its mean at the phase theta."""
        harmonics = np.arange(1, len(self.harmonics) + 1)
        return np.asarray(np.cos(np.asarray(theta)[..., None] * harmonics) @ self.harmonics, dtype=float)

    def _ridge_height(self, s: ArrayLike) -> Array:
        theta = 2 * np.pi * np.asarray(s, dtype=float) / self.finger.ridge_wavelength
        return np.asarray(self._wave(theta) * self._window(s), dtype=float)

    @cached_property
    def _summits(self) -> tuple[tuple[float, float], ...]:
        """Phases from 0 to pi, and heights above the mean, of the profile's maxima, the highest first."""
        values = self._wave(_PHASES)
        padded = np.concatenate([values[1:2], values, values[-2:-1]])  # even about both ends
        found = []
        for k in np.flatnonzero((padded[1:-1] >= padded[:-2]) & (padded[1:-1] >= padded[2:])):
            theta, height = float(_PHASES[k]), float(values[k])
            if 0 < k < len(_PHASES) - 1:
                inside = scipy.optimize.minimize_scalar(
                    lambda t: -float(self._wave(t)),
                    bounds=(_PHASES[k - 1], _PHASES[k + 1]),
                    method="bounded",
                    options={"xatol": 1e-10},
                )
                theta, height = float(inside.x), -float(inside.fun)
            found.append((theta, height))
        return tuple(sorted(found, key=lambda pair: -pair[1]))

    @property
    def crests(self) -> tuple[float, ...]:
        """Arc lengths of a ridge's crests from its middle, from -1/2 to 1/2 wavelength, in order.

        Every maximum in the upper half of the profile is one; of a profile with its crest at the middle, that alone.
        """
        least = self._summits[0][1] - self.finger.ridge_amplitude / 2
        right = [t / (2 * np.pi) * self.finger.ridge_wavelength for t, height in self._summits if height >= least]
        return tuple(sorted({side * s + 0.0 for s in right for side in (-1.0, 1.0)}))

    def touching_arcs(self, fraction: float, step: float) -> Array:
        """Return arc lengths from a ridge's middle, at most ``step`` apart, of what touches: a part about each crest.

        Args:
            fraction: width of a part, over the wavelength.
            step: (m).
        """
        half = fraction * self.finger.ridge_wavelength / 2
        across: Array = np.linspace(-half, half, 1 + int(np.ceil(2 * half / step)), dtype=np.float64)
        if self.crests == (0.0,):
            return across
        every = np.unique(np.array(self.crests)[:, None] + across)
        return np.asarray(every[np.abs(every) <= self.finger.ridge_wavelength / 2])

    def radius(self, s: ArrayLike) -> Array:
        """Return the radius of curvature (m) of the skin at arc lengths from a ridge's middle, infinite where none."""
        harmonics = 2 * np.pi / self.finger.ridge_wavelength * np.arange(1, len(self.harmonics) + 1)
        phases = np.asarray(s, dtype=float)[..., None] * harmonics
        slope = np.sin(phases) @ (harmonics * self.harmonics)
        bend = np.abs(np.cos(phases) @ (harmonics**2 * self.harmonics))
        return np.asarray(np.divide((1 + slope**2) ** 1.5, bend, out=np.full_like(bend, np.inf), where=bend > 0))

    @property
    def _mean_depth(self) -> float:
        """Depth of the skin's mean line: the highest crests are on the outline."""
        return self._summits[0][1]

    @cached_property
    def lowered(self) -> float:
        """How far the outline's lowest point is below y = 0 (m): by what the outline rises up to the first crest."""
        if self._summits[0][0] == 0:
            return 0.0
        f = self.finger
        a, b = f.width / 2, f.height / 2

        def height(s: ArrayLike) -> Array:
            phi, depth = self._angle(s), self.skin(s)
            along = np.cos(phi) / b / np.hypot(np.sin(phi) / a, np.cos(phi) / b)
            return np.asarray(b * (1 - np.cos(phi)) + depth * along)

        s = np.linspace(0, 1.5 * f.ridge_wavelength, 3001)
        k = int(np.argmin(height(s)))
        ends = s[max(k - 1, 0)], s[min(k + 1, len(s) - 1)]
        options = {"xatol": 1e-9 * f.ridge_wavelength}
        return float(
            scipy.optimize.minimize_scalar(
                lambda at: float(height(at)), bounds=ends, method="bounded", options=options
            ).fun
        )

    def skin(self, s: ArrayLike) -> Array:
        """Return the depth of the outer surface."""
        return self._mean_depth - self._ridge_height(s)

    @cached_property
    def _along(self) -> tuple[Array, Array, "cKDTree"]:
        count = _ALONG * self.finger.ridge_count + 1
        s: Array = np.linspace(-self.ridged_arc, self.ridged_arc, count, dtype=np.float64)
        xy = self.point(s, self.skin(s))
        return s, xy, scipy.spatial.cKDTree(xy)

    def along_skin(self, points: Array) -> Array:
        """Return the arc lengths (m) of points on the ridged skin, shape (n,), from their places (m), shape (n, 2)."""
        s, xy, tree = self._along
        nearest = np.clip(tree.query(points)[1], 1, len(s) - 2)
        before, after = xy[nearest - 1], xy[nearest + 1]
        part = ((points - before) * (after - before)).sum(axis=1) / ((after - before) ** 2).sum(axis=1)
        return np.asarray(s[nearest - 1] + part * (s[nearest + 1] - s[nearest - 1]))

    def sc_ve(self, s: ArrayLike) -> Array:
        """Return the depth of the junction of stratum corneum and viable epidermis, parallel to the skin."""
        return self._mean_depth + self.finger.sc_thickness - self._ridge_height(s)

    def ve_d(self, s: ArrayLike) -> Array:
        """Return the depth of the junction of viable epidermis and dermis.

        Intermediate ridges under the papillary ridges' centres, limiting ridges under the grooves, dermal
        papillae between. *Assumption* as a shape: two half-waves of the heights in Table 1.
        """
        f = self.finger
        theta = 2 * np.pi * np.asarray(s, dtype=float) / f.ridge_wavelength
        height = np.where(np.cos(theta) >= 0, f.intermediate_ridge_height, f.limiting_ridge_height)
        mean = (f.intermediate_ridge_height + f.limiting_ridge_height) / 4
        wave = height / 2 * (1 + np.cos(2 * theta)) - mean
        return self._mean_depth + f.sc_thickness + f.ve_thickness + wave * self._window(s)

    def d_sub(self, s: ArrayLike) -> Array:
        """Return the depth of the junction of dermis and subcutaneous tissue, a smooth offset curve."""
        f = self.finger
        total = f.sc_thickness + f.ve_thickness + f.dermis_thickness
        return np.full_like(np.asarray(s, dtype=float), self._mean_depth + total)

    def bone(self, phi: ArrayLike) -> Array:
        """Return points of the bone's rim at angle ``phi`` from its lowest point; shape (n, 2)."""
        f = self.finger
        x = f.bone_width / 2 * np.sin(phi)
        return np.stack([x, f.bone_centre - f.bone_height / 2 * np.cos(phi)], axis=-1)

    # -- receptors -------------------------------------------------------------------------------------
    @property
    def ridges(self) -> range:
        """Numbers of the ridges, along the arc; 0 is centred on x = 0."""
        half = (self.finger.ridge_count - 1) // 2
        return range(-half, half + 1)

    def merkel_sites(self) -> Array:
        """Return one site a ridge, above the intermediate ridge's tip; shape (ridge_count, 2)."""
        s = np.array(self.ridges) * self.finger.ridge_wavelength
        return self.point(s, self.ve_d(s) - self.finger.merkel_offset)

    def pacinian_sites(self) -> Array:
        """Return one site a ridge, as far below the dermis as Meissner sites are in it; shape (ridge_count, 2).

        *Assumption*: the junction is at some 2 mm, the depth that was fitted to Pacinian afferents.
        """
        s = np.array(self.ridges) * self.finger.ridge_wavelength
        return self.point(s, self.d_sub(s) + self.finger.meissner_offset)

    def meissner_sites(self) -> Array:
        """Return two sites a ridge, in the papillae beside it; shape (2 ridge_count, 2)."""
        centres = np.array(self.ridges, dtype=float)[:, None]
        s = ((centres + np.array([-0.25, 0.25])) * self.finger.ridge_wavelength).ravel()
        return self.point(s, self.ve_d(s) + self.finger.meissner_offset)
