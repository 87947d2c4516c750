"""What is read off an outcome: errors against the reference, and one number for each kind of map."""

from collections.abc import Callable

from benchmarks.stability.cache import Cache
from benchmarks.stability.case import Case, Outcome


def comparable(case: Case, cache: Cache) -> tuple[Outcome, Outcome] | None:
    """Return the outcomes of a case and of its reference if both reached their loads."""
    here, finest = cache.get(case), cache.get(case.reference)
    if here is None or finest is None or "failed" in (here.status, finest.status):
        return None
    return here, finest


def relative_error(case: Case, cache: Cache, quantity: Callable[[Outcome], float]) -> float | None:
    """Return the relative error of a quantity, with its sign; None where there is nothing to compare."""
    pair = comparable(case, cache)
    if pair is None:
        return None
    exact = quantity(pair[1])
    return (quantity(pair[0]) - exact) / abs(exact) if exact else None


def friction_error(case: Case, cache: Cache) -> float | None:
    """Return the relative error of f_T at full slip."""
    return relative_error(case, cache, lambda o: o.f_t)


def length_error(case: Case, cache: Cache) -> float | None:
    """Return the relative error of the contact length at full slip."""
    return relative_error(case, cache, lambda o: o.contact_length)


def force_error(case: Case, cache: Cache) -> float | None:
    """Return the relative error of the normal force."""
    return relative_error(case, cache, lambda o: o.f_ext)


def penetration(case: Case, cache: Cache) -> float | None:
    """Return the deepest penetration (m) of the last state of a run that reached its loads."""
    here = cache.get(case)
    return None if here is None or here.status == "failed" else here.penetration
