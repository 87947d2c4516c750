"""All cases, by area."""

from benchmarks.verification import microscale
from benchmarks.verification.case import Case

AREAS: dict[str, tuple[Case, ...]] = {
    "Microscale": microscale.CASES,
}
