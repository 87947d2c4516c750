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

import numpy as np
from numpy.typing import ArrayLike, NDArray
from scipy.integrate import cumulative_simpson
from scipy.optimize import minimize_scalar

from geometry.parameters import Fingertip

Array = NDArray[np.float64]
_APART = 1e-6  # m, between points that the mesh has where the nail begins
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
        return phi, np.asarray(cumulative_simpson(speed, x=phi, initial=0.0), dtype=float)

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
    def _ridge_series(self) -> Array:
        """Cosine coefficients of the ridge's height above its mean, with the given peak-to-peak amplitude."""
        c = np.asarray(self.finger.ridge_profile, dtype=float)
        shape = np.cos(np.outer(_PHASES, np.arange(1, len(c) + 1))) @ c
        return c * self.finger.ridge_amplitude / np.ptp(shape)

    def _wave(self, theta: ArrayLike) -> Array:
        """Height of a ridge above its mean at the phase theta."""
        harmonics = np.arange(1, len(self._ridge_series) + 1)
        return np.asarray(np.cos(np.asarray(theta)[..., None] * harmonics) @ self._ridge_series, dtype=float)

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
                inside = minimize_scalar(
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
        return float(minimize_scalar(lambda at: float(height(at)), bounds=ends, method="bounded", options=options).fun)

    def skin(self, s: ArrayLike) -> Array:
        """Return the depth of the outer surface."""
        return self._mean_depth - self._ridge_height(s)

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

    def meissner_sites(self) -> Array:
        """Return two sites a ridge, in the papillae beside it; shape (2 ridge_count, 2)."""
        centres = np.array(self.ridges, dtype=float)[:, None]
        s = ((centres + np.array([-0.25, 0.25])) * self.finger.ridge_wavelength).ravel()
        return self.point(s, self.ve_d(s) + self.finger.meissner_offset)

    # -- refusals --------------------------------------------------------------------------------------
    def check(self) -> None:
        """Refuse a set of parameters that describes no fingertip.

        Raises:
            GeometryError: layers touch or cross, the ridges do not fit, or the bone is not inside the
                subcutaneous tissue; the message names the parameters.
        """
        f = self.finger
        if self.ridged_arc + f.ridge_wavelength > self.nail_arc:
            most = int(2 * self.nail_arc / f.ridge_wavelength - 2)
            raise GeometryError(
                f"ridge_count {f.ridge_count} of ridge_wavelength {f.ridge_wavelength:g} m do not fit between "
                f"the nail's edges; at most {most - 1 + most % 2} do"
            )
        s = np.linspace(-self.nail_arc, self.nail_arc, 64 * f.ridge_count + 1)
        curves = [("skin", self.skin), ("SC-VE junction", self.sc_ve)]
        curves += [("VE-D junction", self.ve_d), ("D-subcutis junction", self.d_sub)]
        thickness = ["sc_thickness", "ve_thickness", "dermis_thickness"]
        for (upper, above), (lower, below), name in zip(curves, curves[1:], thickness, strict=False):
            gap = float((below(s) - above(s)).min())
            if gap <= 0:
                raise GeometryError(
                    f"{upper} and {lower} cross by {-gap:.3g} m; "
                    f"{name} is {getattr(f, name):g} m and must exceed {getattr(f, name) - gap:.3g} m"
                )
        a, b = f.width / 2, f.height / 2
        sharpest = min(a**2 / b, b**2 / a)
        if float(self.d_sub(0.0)) >= sharpest:
            raise GeometryError(
                f"the skin layers are {float(self.d_sub(0.0)):.3g} m deep, more than the outline's radius of "
                f"curvature, {sharpest:.3g} m: reduce dermis_thickness or make width and height more alike"
            )
        self._check_sites()
        self._check_bone()
        self._check_edge()

    def _check_sites(self) -> None:
        """Refuse receptor sites that are not in their layers."""
        f = self.finger
        tip = float(self.ve_d(0.0))
        top = float(self.ve_d(f.ridge_wavelength / 4))
        thickness = tip - float(self.sc_ve(0.0))
        if f.merkel_offset >= thickness:
            raise GeometryError(
                f"merkel_offset is {f.merkel_offset:g} m; it must be below the thickness of the viable epidermis at "
                f"the tips of its ridges, {thickness:.4g} m"
            )
        depth = float(self.d_sub(0.0)) - top
        if f.meissner_offset >= depth:
            raise GeometryError(
                f"meissner_offset is {f.meissner_offset:g} m; it must be below the height of the papillae above the "
                f"subcutis, {depth:.4g} m"
            )

    def _check_bone(self) -> None:
        f = self.finger
        rim = self.bone(np.linspace(-np.pi, np.pi, 721))
        s = np.linspace(-self.nail_arc, self.nail_arc, 2001)
        nearest, distance = _signed_distance(rim, self.point(s, self.d_sub(s)), self.point(s, self.d_sub(s) + 1e-6))
        between_ends = (nearest > 0) & (nearest < len(s) - 1)
        touching = between_ends & (distance <= 0)
        if touching.any():
            x, y = rim[np.flatnonzero(touching)[0]]
            raise GeometryError(
                f"the bone touches the skin's layers at x = {x:.3g} m, y = {y:.3g} m: change bone_width "
                f"({f.bone_width:g} m), bone_height ({f.bone_height:g} m) or bone_centre ({f.bone_centre:g} m)"
            )
        s = np.linspace(self.nail_arc, self.half_perimeter, 501)
        nearest, distance = _signed_distance(
            rim[rim[:, 0] >= 0], self.point(s, f.nail_thickness), self.point(s, f.nail_thickness + 1e-6)
        )
        if distance.min() <= 0:
            raise GeometryError(
                f"the bone reaches the nail: its top, bone_centre + bone_height / 2, is at {rim[:, 1].max():.4g} m "
                f"and must stay below the nail's inner face at {f.height - f.nail_thickness:.4g} m"
            )

    def _check_edge(self) -> None:
        """Refuse layers that do not get from the nail's edge to the bone."""
        f, end = self.finger, self.nail_arc
        foot = self.bone(np.pi - np.arcsin(2 * f.nail_bed_half_width / f.bone_width))
        start = self.point(end, self.d_sub(end))
        line = start + np.linspace(0, 0.99, 100)[:, None] * (foot - start)
        inside = (2 * line[:, 0] / f.bone_width) ** 2 + (2 * (line[:, 1] - f.bone_centre) / f.bone_height) ** 2 < 1
        if inside.any() or (line[:, 0] <= 0).any():
            raise GeometryError(
                "the skin's layers end inside the bone at the nail's edge: reduce dermis_thickness "
                f"({f.dermis_thickness:g} m) or bone_width ({f.bone_width:g} m), or change nail_half_width "
                f"({f.nail_half_width:g} m) or nail_bed_half_width ({f.nail_bed_half_width:g} m)"
            )
        for name, depth in (("SC-VE", self.sc_ve(end)), ("VE-D", self.ve_d(end))):
            if abs(float(depth) - f.nail_thickness) < _APART:
                raise GeometryError(
                    f"nail_thickness is {f.nail_thickness:g} m, the depth of the {name} junction at the nail's edge; "
                    f"it must differ by {_APART:g} m or more"
                )


def _signed_distance(points: Array, curve: Array, inward: Array) -> tuple[NDArray[np.intp], Array]:
    """Return the index of the nearest curve point and the distance, positive on the side of ``inward``."""
    step = points[:, None, :] - curve[None, :, :]
    nearest = np.argmin((step**2).sum(axis=-1), axis=1)
    step = step[np.arange(len(points)), nearest]
    side = (step * (inward - curve)[nearest]).sum(axis=-1)
    return nearest, np.sign(side) * np.linalg.norm(step, axis=-1)
