"""All cases, by area."""

from benchmarks.verification import constitutive, cook, discretisation, invariance, microscale, tube
from benchmarks.verification.case import Case

AREAS: dict[str, tuple[Case, ...]] = {
    "Constitutive": constitutive.CASES + invariance.CASES + tube.CASES,
    "Discretisation": discretisation.CASES + cook.CASES,
    "Microscale": microscale.CASES,
}
