"""All cases, by area."""

from benchmarks.verification import (
    adhesion,
    constitutive,
    cook,
    discretisation,
    energy,
    friction,
    invariance,
    microscale,
    normal_contact,
    tube,
)
from benchmarks.verification.case import Case

AREAS: dict[str, tuple[Case, ...]] = {
    "Constitutive": constitutive.CASES + invariance.CASES + tube.CASES,
    "Discretisation": discretisation.CASES + cook.CASES,
    "Normal contact": normal_contact.CASES,
    "Friction": friction.CASES,
    "Adhesion": adhesion.CASES,
    "Microscale": microscale.CASES,
    "Two scales": microscale.TWO_SCALES,
    "Energy": energy.CASES,
}
