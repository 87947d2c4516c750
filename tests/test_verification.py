"""The verification cases on small meshes, and the page drawn from their numbers."""

import numpy as np
import pytest
from scipy.integrate import quad

from benchmarks.harness import DOCS, kept
from benchmarks.verification.__main__ import AREAS
from benchmarks.verification.adhesion import maugis_force, maugis_ratio
from benchmarks.verification.case import KINDS, Row

pytestmark = pytest.mark.slow
CASES = [case for cases in AREAS.values() for case in cases]


@pytest.mark.parametrize("case", CASES, ids=lambda case: case.name)
def test_case(case):
    """Every number is within the tolerance that its row explains."""
    rows = case.rows(True)
    assert rows
    assert [f"{row.quantity}: {row.computed} instead of {row.reference}" for row in rows if not row.holds] == []


def test_maugis_tractions():
    """The reference's tractions bear its force and, by Flamant, close the gap in contact and leave h_0 at its end.

    Tolerance: quadrature of weak singularities.
    """
    a, radius, e_star, sigma_0, h_0 = 3e-4, 0.1, 1.1e6, 2200.0, 4e-7
    c = a * maugis_ratio(a, radius, e_star, sigma_0, h_0)

    def pressure(x):
        if abs(x) >= a:
            return -sigma_0
        pull = np.arctan(np.sqrt((c**2 - a**2) / (a**2 - x**2)))
        return e_star / (2 * radius) * np.sqrt(a**2 - x**2) - 2 * sigma_0 / np.pi * pull

    def integral(f, *breaks):
        ends = sorted({-c, -a, a, c, *breaks})
        return sum(quad(f, *pair, limit=200, epsabs=0, epsrel=1e-9)[0] for pair in zip(ends, ends[1:], strict=False))

    def gap(x):
        sunk = integral(lambda s: pressure(s) * np.log(max(abs((x - s) / a), 1e-300)), x)
        return x**2 / (2 * radius) - 2 / (np.pi * e_star) * sunk

    expected = maugis_force(a, radius, e_star, sigma_0, h_0)
    assert integral(pressure) == pytest.approx(expected, rel=1e-7)
    gaps = [gap(x) - gap(0.0) for x in (0.5 * a, a, c)]
    assert gaps == pytest.approx([0.0, 0.0, h_0], abs=1e-7 * h_0)


def test_numbers_in_git_are_of_every_case():
    """Each case is on the page, and each of its numbers holds."""
    areas = kept("verification", DOCS).numbers
    assert {area: [case["name"] for case in cases] for area, cases in areas.items()} == {
        area: [case.name for case in cases] for area, cases in AREAS.items()
    }
    rows = [Row(**row) for cases in areas.values() for case in cases for row in case["rows"]]
    assert [row.quantity for row in rows if not row.holds] == []
    assert {row.kind for row in rows} == set(KINDS)
