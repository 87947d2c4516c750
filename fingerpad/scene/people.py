r"""How fingers differ from person to person: the spreads, and scenes drawn from them.

A spread is the distribution of a factor on some keys of a scene, with the median 1. It holds for every finger by name:
the finger's own values are then those of the middle person in its state. Factors are lognormal,
:math:`\ln x = \sigma z` with :math:`\sigma^2 = \ln(1 + c^2)` for a coefficient of variation c, or normal,
:math:`x = 1 + c z`. The standard normal z is cut off at :math:`\pm 3`. Spreads are independent.

Not in it: the share of ridge contact in gross contact, whose standard deviation between people is 0.10. It follows from
the shape of ridge tips, for which no factor on a key stands: each person would need a press.
"""

import math
from collections.abc import Callable, Mapping
from dataclasses import dataclass, fields, replace
from typing import Any, Literal

import numpy as np
import scipy
from numpy.typing import ArrayLike, NDArray

from fingerpad.scene.fingers import SOFT
from fingerpad.scene.messages import SceneError, show
from fingerpad.scene.scene import Scene
from variational.contact.friction import Friction

Array = NDArray[np.float64]
_CUT = 3.0  # of z
_PRESSURES = np.geomspace(1e2, 1e6, 5)  # Pa, at which a law with other numbers is compared
_MOST = 100_000  # people
PLACES = 6
"""Of a drawn factor after the point, fewer than those in which machines differ."""


@dataclass(frozen=True)
class Spread:
    """Distribution of a factor between people."""

    kind: Literal["lognormal", "normal"]
    cv: float
    """Coefficient of variation c."""
    keys: Callable[[Scene, float], dict[str, Any]]
    """Returns the changes of a scene, nested, that multiply its keys by a factor; has its source."""

    def factor(self, part: ArrayLike) -> Array:
        """Return the factors below which a part of all people is; ``part`` is from 0 to 1, of any shape."""
        low, high = scipy.special.ndtr([-_CUT, _CUT])
        z = scipy.special.ndtri(low + (high - low) * np.asarray(part, dtype=float))
        return np.exp(math.sqrt(math.log1p(self.cv**2)) * z) if self.kind == "lognormal" else 1 + self.cv * z


def _friction(scene: Scene, factor: float) -> dict[str, Any]:
    """Return a friction coefficient, or a law whose limit is a multiple of the scene's at every pressure.

    Coefficients of variation of 0.25 to 0.75 between 16 people, static (Ergonomics 2010, 53(6), abstract; row
    friction_between of data/findings.toml). *Assumption*: the middle of them.
    """
    own = scene.friction
    if not isinstance(own, Friction):
        return {"friction": factor * own}
    numbers = {f.name: factor * getattr(own, f.name) for f in fields(own) if f.name.startswith(("mu_", "tau_"))}  # type: ignore[arg-type]
    found = replace(own, **numbers)  # type: ignore[type-var]
    if not np.allclose(found.limit(_PRESSURES), factor * own.limit(_PRESSURES), rtol=1e-9, atol=0.0):
        raise SceneError(f"friction is {own}; no number of this law, such as mu_f, multiplies all of its friction")
    return {"friction": found}


def _stiffness(scene: Scene, factor: float) -> dict[str, Any]:
    """Return shear moduli, which go with the square of the speed of surface waves.

    3.2 ± 0.2 m/s at 26 ± 3 years (doi 10.1098/rsos.170321, abstract; row stiffness_people). *Assumption*: in all soft
    layers alike.
    """
    layers = {name: getattr(scene.materials, name) for name in SOFT}
    for name, law in layers.items():
        if not hasattr(law, "shear_modulus"):
            raise SceneError(f"materials.{name} is {law}; it must have a shear modulus to differ between people")
    return {"materials": {name: {"shear_modulus": factor * law.shear_modulus} for name, law in layers.items()}}


def _size(scene: Scene, factor: float) -> dict[str, Any]:
    """Return all lengths. 33 women have ridges 441 ± 33 µm apart (Králík and Novotný 2003, whose data were read).

    *Assumption*: all lengths go with the distance of ridges.
    """
    shape, along = scene.geometry, scene.slices
    if shape.file is not None or along.height is not None:
        key = "geometry.file" if shape.file is not None else "slices.height"
        raise SceneError(f"{key} is given; a finger of another size must have lengths in keys of its own")
    lengths = {name: factor * value for name, value in shape if isinstance(value, float)}
    return {"geometry": lengths, "slices": {name: factor * getattr(along, name) for name in ("radius", "length")}}


def _insulator(scene: Scene, factor: float) -> dict[str, Any]:
    """Return the stratum corneum's thickness as an insulator, without effect on stiffness.

    18.3 ± 4.9, 11.0 ± 2.2 and 14.9 ± 3.4 µm on forearm, shoulder and buttock of 71 people (doi
    10.1080/00015550310015419, abstract). *Assumption*: as on fingertips.
    """
    return {"electric": {"eps_sc": scene.electric.eps_sc / factor}}


def _roughness(scene: Scene, factor: float) -> dict[str, Any]:
    """Return the rms height. *Assumption*: 20 %; no spread between people was read."""
    if not hasattr(scene.roughness, "h_rms"):
        raise SceneError(f"roughness is {scene.roughness}; it must have an h_rms to differ between people")
    return {"roughness": {"h_rms": factor * scene.roughness.h_rms}}


SPREADS: Mapping[str, Spread] = {
    "friction": Spread("lognormal", 0.5, _friction),
    "stiffness": Spread("normal", 0.12, _stiffness),
    "size": Spread("normal", 0.075, _size),
    "stratum corneum": Spread("lognormal", 0.25, _insulator),
    "roughness": Spread("lognormal", 0.2, _roughness),
}
"""Spreads between people, for all fingers: the one table of them."""


def people(n: int, seed: int = 0, finger: str = "fitted", **changes: Any) -> list[Scene]:
    """Return the scenes of people drawn from the spreads between them, :data:`SPREADS`.

    The same seed gives the same people on every machine, and the first of them whatever their number. Draws are of
    NumPy's PCG64 generator.

    Args:
        n: number of people.
        seed: of the draws, 0 or more; another one gives other people.
        finger: name of the middle person's finger.
        changes: further values by key, as :meth:`fingerpad.scene.Scene.replace` takes them.

    Raises:
        SceneError: an argument is no such number; a key is at fault, or has nothing that differs between people.
    """
    for name, value, least, most in (("n", n, 1, _MOST), ("seed", seed, 0, 2**63)):
        if not isinstance(value, int | np.integer) or isinstance(value, bool) or not least <= value <= most:
            raise SceneError(f"{name} is {show(value)}; it must be a whole number from {least} to {most}")
    middle = Scene(finger=finger).replace(**changes)
    parts = np.random.Generator(np.random.PCG64(int(seed))).random((n, len(SPREADS)))
    columns = [each.factor(column).round(PLACES) for each, column in zip(SPREADS.values(), parts.T, strict=True)]
    return [with_factors(middle, dict(zip(SPREADS, row, strict=True))) for row in zip(*columns, strict=True)]


def with_factors(scene: Scene, factors: Mapping[str, float]) -> Scene:
    """Return the scene of a person by factors of :data:`SPREADS`; raises as :func:`people`."""
    found: dict[str, Any] = {}
    for name, factor in factors.items():
        found |= SPREADS[name].keys(scene, float(factor))
    return scene.replace(**found)
