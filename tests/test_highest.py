"""The highest pressure from mean pressures of facets: exact for parabolas, blind to a saw, as good on the half."""

import numpy as np
import pytest

from variational.resultants import highest


def facets(edges, p, closed=None):
    """Return forces (N/m), widths (m), parts in contact (m) and ends (m) of facets under a pressure (Pa)."""
    gauss, weights = np.polynomial.legendre.leggauss(8)
    width = np.diff(edges)
    x = edges[:-1, None] + width[:, None] * (1 + gauss) / 2
    force = (p(x) @ weights) * width / 2
    ends = np.stack([np.stack([edges[k : len(edges) - 1 + k], 0 * width], axis=1) for k in (0, 1)], axis=1)
    return force, width, width.copy() if closed is None else closed, ends


@pytest.mark.parametrize("seed", range(4))
def test_a_parabola_is_found_exactly_in_any_order_of_uneven_facets(seed):
    rng = np.random.default_rng(seed)
    edges = np.concatenate([[-1.0], np.sort(rng.uniform(-0.9, 0.9, 12)), [1.0]])
    at = rng.uniform(-0.3, 0.3)
    found = rng.permutation(13)
    given = facets(edges, lambda x: 3.0 - (x - at) ** 2)
    assert highest(*(each[found] for each in given)) == pytest.approx(3.0, rel=1e-12)
    turned = [each[found] for each in given]
    turned[3] = turned[3][:, ::-1]  # from the second end to the first
    assert highest(*turned) == pytest.approx(3.0, rel=1e-12)


def test_a_saw_of_five_per_cent_within_facets_moves_it_by_less_than_a_thousandth():
    edges = np.linspace(-1.0, 1.0, 15)
    width = edges[1] - edges[0]

    def pressure(x, saw=0.0):
        t = (x + 1) / width % 1
        return np.sqrt(np.maximum(1 - x**2, 0)) * (1 + saw * (6 * t * (1 - t) - 1))  # of no mean

    smooth, rough = (highest(*facets(edges, lambda x, saw=saw: pressure(x, saw))) for saw in (0.0, 0.05))
    assert smooth == pytest.approx(1.0, abs=1e-3)
    assert rough == pytest.approx(smooth, abs=1e-3)
    assert pressure(np.linspace(-1, 1, 10001), 0.05).max() > 1.015  # what single points would give


def test_it_converges_with_the_facets_to_the_highest_value_of_a_hertzian_pressure():
    errors = []
    for count in (8, 16, 32):
        edges = np.linspace(-1.1, 1.0, count + 1)
        errors.append(abs(highest(*facets(edges, lambda x: np.sqrt(np.maximum(1 - x**2, 0)))) - 1))
    assert errors[1] < errors[0] / 4
    assert errors[2] < errors[1] / 4


def test_the_half_of_a_symmetric_contact_has_the_value_of_the_whole():
    edges = np.linspace(-1.0, 1.0, 13)
    whole = facets(edges, lambda x: 2.0 - x**2)
    half = [each[6:] for each in whole]
    mirrored = [np.concatenate([each, each]) for each in half[:3]]
    mirrored.append(np.concatenate([half[3], half[3] * [-1.0, 1.0]]))
    assert highest(*mirrored) == pytest.approx(highest(*whole), rel=1e-12)
