"""The interface of a microscale model: the equivalent air gap of a ridge under its mean contact pressure.

Your own closure is one class, here a gap that no pressure changes::

    @dataclass(frozen=True)
    class Held(Closure):
        gap: float  # m

        def __call__(self, p_c):
            return AirGap(self.gap + 0 * np.asarray(p_c, dtype=float))
"""

from abc import ABC, abstractmethod
from collections import Counter, defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any, ClassVar, NamedTuple

import numpy as np
from numpy.typing import ArrayLike, NDArray

from variational.caution import Caution
from variational.coefficients import OF_SCENE, Named, parameter, refuse_not_positive

if TYPE_CHECKING:
    from variational.roughness.topography import HeightMap

Array = NDArray[np.float64]
Progress = Callable[[int, int], None]
"""Called with the number of contacts that are solved and of all."""
PAST_THE_FOLD = "past the fold"
"""State of a ridge whose attraction grows faster than its contact pressure: alone, it comes down or lets go at once."""
BALANCED = 0.1
"""Part of the pressure in contact from which its attraction is overestimated by some 8 %."""
STICKING = 1e3
"""Pull-off stress (Pa) from which a ridge is called sticking: a tenth of the least ridge pressure of interest, 10 kPa.
*Assumption*: a convention. Without such a value the voltage would be that of a stress of zero, which tails of the
repulsion reach at any voltage."""
_SHARE = 0.1  # of the contact force, from which ridges outside of a closure's range are mentioned
_PRESSURES = np.array([0.0, 1.0, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7])  # Pa, at which a closure is examined


class AirGap(NamedTuple):
    """Equivalent air gap of each ridge and its derivative."""

    d_eq: Array
    """Equivalent air gap (m), of the shape of the pressures."""
    derivative: Array | None = None
    """d d_eq / d p_c (m/Pa), of the shape of the pressures; None where it is not known. No solver reads it."""


class Closure(ABC):
    """A microscale model: mean contact pressure in, equivalent air gap out."""

    measured: ClassVar[tuple[str, ...]] = ("h_rms", "wavelength")
    """Parameters that a measured height map has, which are not given beside it; of closures with an ``of_map``."""
    shared: ClassVar[tuple[str, ...]] = ()
    """Parameters of a self-affine Gaussian surface, by which other closures describe the same one; empty where it is
    none."""
    end: ClassVar[str] = ""
    """What the largest of :attr:`pressures` is, in words."""
    extrapolates: ClassVar[bool] = True
    """Whether the air gap beyond :attr:`pressures` is an answer of the model; that of a table is held, and is none."""

    @property
    def pressures(self) -> tuple[float, float]:
        """Range of mean contact pressures (Pa) in which the air gap follows the pressure."""
        return 0.0, np.inf

    @abstractmethod
    def __call__(self, p_c: ArrayLike) -> AirGap:
        """Return the air gap at mean contact pressures ``p_c`` >= 0 (Pa); zero means no contact.

        The pressures are a number or an array of any shape, the air gaps have the same shape and are greater than zero.
        """
        ...

    def state(self, p_c: float, voltage: float) -> str:
        """Return ``""`` or a note on a ridge at this pressure (Pa) and voltage (V)."""
        return ""

    def spread(self, p_c: ArrayLike) -> Array:
        """Return the standard deviation of d_eq (m) from one surface to the next, of the shape of the pressures."""
        return np.zeros(np.shape(p_c))

    def balanced(self, p_c: ArrayLike, voltage: float) -> Array:
        """Return the part of the contact pressure that attraction balances where asperities touch, 0 or more.

        A closure that takes the whole pressure as a load overestimates the attraction by more, the larger this part.
        """
        return np.zeros(np.shape(p_c))

    def sticking_voltage(self) -> float | None:
        """Return the voltage (V) from which a flat ridge adheres without a load; None where it is not known."""
        return None

    def cautions(self, points: Sequence[tuple[ArrayLike, ArrayLike, float]], noun: str = "states") -> list[Caution]:
        """Return in how many points ridges under a tenth of the contact force or more are outside of the range.

        Also in how many attraction deforms the asperities (:meth:`balanced`), which the closure does not have.

        Args:
            points: pressure (Pa) and contact force of each ridge, and the voltage (V).
            noun: what the points are.
        """
        counts = Counter[str]()
        for p_c, force, voltage in points:
            borne = defaultdict[str, float](float)
            for pressure, share in zip(np.atleast_1d(p_c), np.atleast_1d(force) / np.sum(force), strict=True):
                borne[self.state(float(pressure), voltage)] += float(share)
            counts.update(place for place, share in borne.items() if place and share >= _SHARE)
        of, name = f"of {len(points)} {noun} the closure", type(self).__name__
        words = "is out of its range: the mean pressure of ridges is"
        found = [Caution("closure_range", f"in {n} {of} {words} {place}", n) for place, n in counts.items()]
        shares = [float(self.balanced(p_c, voltage).max(initial=0.0)) for p_c, _, voltage in points]
        if many := sum(share >= BALANCED for share in shares):
            text = (
                f"in {many} {of} {name} overestimates the attraction, which deforms the asperities: it balances up to "
                f"{100 * min(max(shares), 1.0):.0f} % of the pressure in contact (overestimated by 11 % at a share of "
                "14 %, by 85 % at 50 %: docs/microscale.md); the values are upper bounds, and "
                "roughness.field_in_contact=false gives lower ones"
            )
            found.append(Caution("attraction_deforms", text, max(shares)))
        return found


@dataclass(frozen=True)
class RoughSurface(Named, Closure):
    """A closure of self-affine Gaussian roughness on stratum corneum; SI units."""

    h_0: float = field(metadata=OF_SCENE)
    """Effective insulator thickness (m)."""
    h_rms: float = parameter(1e-9, 1e-3, "m", default=3.1e-6)
    """Root mean square height of the roughness (m)."""
    wavelength: float = parameter(1e-8, 1e-2, "m", default=100e-6)
    """Largest wavelength lambda_0 of the roughness (m); q_0 = 2 pi / lambda_0."""
    young: float = parameter(1.0, 1e12, "Pa", default=1e6)
    """Elastic modulus of the stratum corneum on the microscale (Pa)."""

    def __post_init__(self) -> None:
        """Refuse numbers that are no lengths and pressures.

        Raises:
            ValueError: one that is not finite and greater than 0; in one sentence.
        """
        refuse_not_positive(self)

    @classmethod
    def of_map(cls, measured: "HeightMap", progress: Progress | None = None) -> dict[str, Any]:
        """Return the parameters that a measured height map gives; ``progress`` is called after each contact.

        Raises:
            ValueError: a map without roughness, or one that does not resolve it; in one sentence.
        """
        from variational.roughness.spectrum import roughness_table

        return dict(roughness_table(measured))

    def inside(self, p_c: ArrayLike) -> Array:
        """Return mean contact pressures (Pa) as an array inside :attr:`pressures`, which they are up to roundoff.

        Raises:
            ValueError: a pressure outside; in one sentence.
        """
        p_c, (low, high) = np.asarray(p_c, dtype=float), self.pressures
        if (out := ~((p_c >= low * (1 - 1e-9)) & (p_c <= high * (1 + 1e-9)))).any():
            raise ValueError(
                f"the contact pressure is {p_c[out].flat[0]:g} Pa; {type(self).__name__} has {low:.4g} to {high:.4g} Pa"
            )
        return np.asarray(np.clip(p_c, low, high), dtype=float)


def air_gaps(closure: Closure, p_c: ArrayLike) -> Array:
    """Return a closure's air gaps (m) at mean contact pressures (Pa), of their shape.

    Raises:
        ValueError: not an air gap for each pressure; in one sentence. Its values are not examined.
    """
    name, shape = type(closure).__name__, np.shape(p_c)
    found = closure(p_c)
    if not isinstance(found, AirGap):
        raise ValueError(f"closure {name} returns {type(found).__name__}; it must return an AirGap")
    d_eq = np.asarray(found.d_eq, dtype=float)
    if d_eq.shape != shape:
        raise ValueError(f"closure {name} returns air gaps of shape {d_eq.shape} for pressures of shape {shape}")
    return d_eq


def check(closure: Closure) -> None:
    """Refuse what is no closure.

    Raises:
        ValueError: it fails, or returns another shape than that of the pressures, or air gaps that are not finite and
            greater than zero; in one sentence.
    """
    name = type(closure).__name__
    if not isinstance(closure, Closure):
        raise ValueError(f"closure is {closure!r}; it must be a Closure, with p_c in and an AirGap out")
    try:
        with np.errstate(all="ignore"):
            found = air_gaps(closure, _PRESSURES)
            air_gaps(closure, float(_PRESSURES[-1]))
        said = closure.state(float(_PRESSURES[-1]), 100.0)
    except Exception as error:
        own = isinstance(error, ValueError) and str(error).startswith(f"closure {name} returns")
        raise error if own else ValueError(f"closure {name} cannot be evaluated: {error}") from error
    bad = ~(np.isfinite(found) & (found > 0))
    if bad.any():
        k = int(np.argmax(bad))
        raise ValueError(
            f"closure {name} returns an air gap of {found[k]:g} m at a pressure of {_PRESSURES[k]:g} Pa; it must be "
            "finite and greater than 0"
        )
    if not isinstance(said, str):
        raise ValueError(f"closure {name} returns {said!r} as a ridge's state; it must be text")
