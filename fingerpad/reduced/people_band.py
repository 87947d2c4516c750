r"""The range of friction over people, by charged cylinders: many fingers about one result, computed together.

Each finger is that of the result with factors on its friction, stiffness, size, insulator and roughness
(:mod:`fingerpad.scene.people`). Its µ_app is that of the result, times the ratio of the charged cylinders', as in
:mod:`fingerpad.reduced.closure_band`. Its contact without voltage is that of the result by similarity: with lengths s
and moduli m times those of the result, :math:`L(f) = s\,L_1(f / (s m))`, with :math:`L_1` of the finger's press. A
result with a contact without voltage has its length, which grows as the press, or as the default finger's where there
is none. A force in newtons stays the same: that at the centre, per length, is then :math:`(s m) (s^2 m)^{-0.77}` times
the result's. The circuit of a drive stays the result's.

The range has nine in ten of :data:`POINTS` people, from the 5th to the 95th percentile. Their factors are a Latin
hypercube: each spread has the middles of as many equal parts, in the order of a Kronecker sequence (M. Roberts 2018,
"The unreasonable effectiveness of quasirandom sequences").
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cache, cached_property
from typing import TYPE_CHECKING, Any

import numpy as np
from numpy.typing import NDArray

from fingerpad.reduced import press
from fingerpad.reduced.cylinders import SHEAR, tip_of
from fingerpad.results.quantities import PEOPLE
from fingerpad.scene import Scene
from fingerpad.scene.messages import SceneError
from fingerpad.scene.parameters import POWER
from fingerpad.scene.people import SPREADS
from variational.attraction.cylinder import Cylinder, NoEquilibriumError, RidgeState
from variational.attraction.dielectric import insulator_thickness
from variational.attraction.tip import Tip
from variational.roughness.closure import Closure
from variational.state import ContactState

if TYPE_CHECKING:
    from fingerpad.results.result import Result

Array = NDArray[np.float64]
POINTS = 200
"""People of a range."""
_ENDS = (0.05, 0.95)  # parts of people below the ends of a range
_TOGETHER = 256  # fingers
_default = cache(Scene)


@dataclass(frozen=True)
class Fingers:
    """Fingers about one at full slip; arrays of shape (fingers,)."""

    scene: Scene
    """Of the one."""
    slip: ContactState
    """Its full slip."""
    uncharged: ContactState | None
    """The same without voltage, where it is known."""
    whole: bool
    """Whether the force in newtons is the same for all, else that per length."""
    factors: Mapping[str, Array]
    """By names of :data:`.SPREADS`; of the coating's thickness by ``coating``."""

    def mu_app(self) -> Array:
        """Return µ_app of each; infinite where it has no number (:func:`fingerpad.reduced.closure_band.friction`).

        Raises:
            SceneError: a finger whose contact is not known, or that is none of cylinders.
        """
        size, stiffness = self._factor("size"), self._factor("stiffness")
        f_ext = self.slip.f_ext * (size * stiffness * (size**2 * stiffness) ** -POWER if self.whole else size**0)
        similar, every = f_ext / (size * stiffness), np.arange(len(f_ext))
        own, left = replace(self._press, roll=size * stiffness * self._press.roll), np.ones_like(f_ext)

        def solved() -> tuple[Array, Array, Array]:
            """Return contact pressure (Pa), length in contact (m) and attraction (N/m)."""
            length, ridges = self._contact(similar, left)
            tip, forces = tip_of(self.scene.geometry, left * length / ridges).scaled(size), f_ext / ridges
            moduli = tip.modulus(forces, size * left * length / ridges)
            parts = np.array_split(every, -(-len(every) // _TOGETHER))
            found = [each for part in parts for each in self._solved(tip, np.asarray(moduli, float), forces, part)]
            none = (np.nan,) * 3
            p_c, lengths, pulled = np.array([(x.p_c, x.length, x.f_attraction) if x else none for x in found]).T
            return p_c, ridges * lengths, ridges * pulled

        if self._here is None and not self._press.slid:  # else friction has rolled its ridges off already
            left = own.left(self._limit, f_ext, 0.0, size * self._contact(similar, left)[0])
            _, length, pulled = solved()
            left = own.left(self._limit, f_ext, pulled / left, length / left)
        p_c, length, _ = solved()
        beyond = np.array([np.inf if law.extrapolates else law.pressures[1] for law in self._surfaces[1]])
        return np.where(p_c <= beyond, self._limit(p_c) * length / f_ext, np.inf)

    def _factor(self, name: str) -> Array:
        return self.factors.get(name, np.ones(len(next(iter(self.factors.values())))))

    @property
    def _here(self) -> ContactState | None:
        return self.uncharged if self.uncharged is not None and self.uncharged.contact_length > 0 else None

    @property
    def _press(self) -> press.Press:
        return press.of(_default() if self._here is not None and press.known(self.scene) is None else self.scene)

    def _contact(self, f_ext: Array, left: Array) -> tuple[Array, NDArray[Any]]:
        """Return length (m) and number of ridges in contact of the one finger without voltage, under forces (N/m).

        Of the ridges a part is left.
        """
        here, known, forces = self._here, self._press, np.append(f_ext, self.slip.f_ext)
        length, ridges = known.length(forces, "full_slip"), known.ridge_count(forces, "full_slip", np.append(left, 1.0))
        if here is not None:
            length = here.contact_length * length / length[-1]
            ridges = np.maximum(np.rint(here.ridges_in_contact * ridges / ridges[-1]), 1).astype(int)
        return length[:-1], ridges[:-1]

    @cached_property
    def _surfaces(self) -> tuple[Array, list[Any]]:
        """Effective insulator thickness (m) of each finger, and its closure."""
        electric, law = self.scene.electric, self.scene.closure()
        skin = self._factor("size") * self._factor("stratum corneum") * self.scene.geometry.sc_thickness
        coating: Any = self._factor("coating") * electric.d_i
        h_0: Any = insulator_thickness(skin, electric.eps_sc, coating, electric.eps_i)  # type: ignore[arg-type]
        if not law.shared:
            return h_0, [law] * len(h_0)
        rough = zip(self._factor("roughness"), h_0, strict=True)
        return h_0, [replace(law, h_rms=float(by * law.h_rms), h_0=float(each)) for by, each in rough]  # type: ignore[attr-defined,type-var]

    def _solved(self, tip: Tip, moduli: Array, forces: Array, chosen: NDArray[np.intp]) -> list[RidgeState | None]:
        """Return the states of a ridge of chosen fingers; None without an equilibrium."""
        (h_0, closures), drive = self._surfaces, self.scene.drive

        def gain(p_c: Array, number: NDArray[np.intp]) -> Array:  # by shear, see fingerpad.reduced.cylinders
            return SHEAR * np.maximum(self._limit(p_c, chosen[number]) - press.KNOWN * p_c, 0.0)

        ridge = Cylinder(tip[chosen], moduli[chosen], h_0[chosen], [closures[k] for k in chosen], gain)
        try:
            return [*ridge.under_loads(forces[chosen], self.slip.voltage if drive is None else drive.effective)]
        except NoEquilibriumError:
            halves = np.array_split(chosen, 2) if len(chosen) > 1 else []
            return [each for half in halves for each in self._solved(tip, moduli, forces, half)] or [None]

    def _limit(self, p_c: Array, number: Any = slice(None)) -> Array:
        """Return the limit of friction (Pa) of numbered fingers, or of all, at contact pressures (Pa)."""
        return self._factor("friction")[number] * self.scene.friction_law().limit(p_c)  # type: ignore[union-attr]


# -- the range -------------------------------------------------------------------------------------------------
def entering(closure: Closure) -> list[str]:
    """Return the names of the spreads that enter a range: of a closure of one's own neither roughness nor insulator."""
    return [name for name in SPREADS if closure.shared or name not in ("stratum corneum", "roughness")]


def _middles(count: int, spreads: int) -> Array:
    """Return middles of ``count`` equal parts of all people, shape (count, spreads), as a Latin hypercube."""
    ratio = 2.0
    for _ in range(100):  # the root of x^(spreads + 1) = x + 1
        ratio = (1 + ratio) ** (1 / (spreads + 1))
    points = np.outer(np.arange(1, count + 1), ratio ** -np.arange(1.0, spreads + 1)) % 1
    return (points.argsort(axis=0).argsort(axis=0) + 0.5) / count


def with_people(result: "Result") -> "Result":
    """Return a result with the range of its µ_app over people in its record, or with the reason why it has none.

    It is not there without friction at full slip. In the record, ready for JSON, it has ``mu_app`` of the result,
    ``low`` and ``high``, ``whole``, and ``spreads``, the coefficients of variation that enter. An end is None where
    more people than are beyond it have no number, since their ridges adhere. Without a range it has ``why`` alone.
    """
    slip, scene = result.full_slip, result.scene
    if slip is None or scene.friction_law() is None or not slip.mu_app > 0:
        return result
    finger = result.finger if result.finger is not None and "full_slip" in result.finger.states else None
    mu = slip.mu_app if finger is None else finger.states["full_slip"].mu_app
    names = entering(scene.closure())
    parts = dict(zip(names, _middles(POINTS, len(names)).T, strict=True))
    factors = {name: np.append(1.0, SPREADS[name].factor(part)) for name, part in parts.items()}
    try:
        here, *found = Fingers(scene, slip, result.uncharged, finger is not None, factors).mu_app()
    except SceneError as error:
        return replace(result, record=result.record | {PEOPLE: {"why": str(error)}})
    if not np.isfinite(here):
        return replace(result, record=result.record | {PEOPLE: {"why": "the result's own closure has no number"}})
    with np.errstate(invalid="ignore"):  # between two without a number
        low, high = (mu / here * np.quantile(found, _ENDS, method="hazen")).tolist()
    ends = {key: value if np.isfinite(value) else None for key, value in (("low", low), ("high", high))}
    kept = {"mu_app": mu, **ends, "whole": finger is not None, "spreads": {name: SPREADS[name].cv for name in names}}
    return replace(result, record=result.record | {PEOPLE: kept})
