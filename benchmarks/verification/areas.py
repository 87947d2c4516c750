"""All cases, by area."""

from benchmarks.verification import constitutive, cook, discretisation, energy, invariance, microscale, tube, two_scales
from benchmarks.verification.case import Case

AREAS: dict[str, tuple[Case, ...]] = {
    "Constitutive": constitutive.CASES + invariance.CASES + tube.CASES,
    "Discretisation": discretisation.CASES + cook.CASES,
    "Microscale": microscale.CASES,
    "Two scales": two_scales.CASES,
    "Energy": energy.CASES,
}
