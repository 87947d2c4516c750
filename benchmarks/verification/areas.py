"""All cases, by area."""

from benchmarks.verification import energy, microscale, two_scales
from benchmarks.verification.case import Case

AREAS: dict[str, tuple[Case, ...]] = {
    "Microscale": microscale.CASES,
    "Two scales": two_scales.CASES,
    "Energy": energy.CASES,
}
