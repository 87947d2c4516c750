"""All cases, by area."""

from benchmarks.verification import adhesion, friction, microscale, normal_contact
from benchmarks.verification.case import Case

AREAS: dict[str, tuple[Case, ...]] = {
    "Normal contact": normal_contact.CASES,
    "Friction": friction.CASES,
    "Adhesion": adhesion.CASES,
    "Microscale": microscale.CASES,
}
