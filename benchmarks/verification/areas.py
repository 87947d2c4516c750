"""All cases, by area."""

from benchmarks.verification import constitutive, cook, invariance, microscale, tube
from benchmarks.verification.case import Case

AREAS: dict[str, tuple[Case, ...]] = {
    "Constitutive": constitutive.CASES + invariance.CASES + tube.CASES,
    "Discretisation": cook.CASES,
    "Microscale": microscale.CASES,
}
