"""Which elements of another mesh a point may be in."""

import numpy as np

from variational.solvers.transfer import _near


def test_large_triangle_beside_many_small_ones_is_found():
    """A point in it, beside sixty triangles of a thousandth of its size, all with nearer centroids."""
    point, angles = np.array([[0.02, 0.02]]), np.linspace(0, 2 * np.pi, 60, endpoint=False)
    middles = point + 1.1e-3 * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    unit = np.array([[0.0, 0.0], [1.0, 0.0], [0.0, 1.0]])
    small = middles + 1e-3 * (unit - unit.mean(axis=0))[:, None]
    corners = np.concatenate([small, unit[:, None]], axis=1)
    assert 60 in _near(corners, point)[0]
