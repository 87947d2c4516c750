"""All cases, by area."""

from benchmarks.verification import constitutive, invariance, microscale
from benchmarks.verification.case import Case

AREAS: dict[str, tuple[Case, ...]] = {
    "Constitutive": constitutive.CASES + invariance.CASES,
    "Microscale": microscale.CASES,
}
