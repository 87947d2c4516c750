"""The return mapping at a point."""

import numpy as np
import pytest
import ufl

from variational import return_mapping

EPS_T = 1e11
LIMIT = 2e4


def traction(u_x: float, anchor: float = 0.0, limit: float = LIMIT) -> float:
    """Evaluate the law at numbers."""
    return float(return_mapping.traction(ufl.as_ufl(u_x), anchor, limit, EPS_T))


@pytest.mark.parametrize("part", [-3.0, -1.1, -0.9, -0.2, 0.0, 0.2, 0.9, 1.1, 3.0])
def test_traction(part):
    """A spring up to the cone, the cone's radius beyond, against the motion. Tolerance: roundoff of the anchor."""
    anchor = 3e-7
    u_x = anchor + part * LIMIT / EPS_T
    assert traction(u_x, anchor) == pytest.approx(-np.clip(part, -1, 1) * LIMIT, rel=1e-12, abs=1e-12 * LIMIT)


@pytest.mark.parametrize("part", [-3.0, -0.5, 0.5, 3.0])
def test_anchor(part):
    """The new anchor slackens a spring that then gives the same traction. Tolerance: roundoff."""
    u_x = part * LIMIT / EPS_T
    t_t = traction(u_x)
    anchor = return_mapping.new_anchor(u_x, t_t, EPS_T)
    assert traction(u_x, anchor) == pytest.approx(t_t, rel=1e-14)
    assert anchor == pytest.approx((part - np.clip(part, -1, 1)) * LIMIT / EPS_T, abs=1e-12 * LIMIT / EPS_T)


def test_open_point_carries_its_anchor_along():
    """Without pressure there is no traction, and the spring stays slack."""
    assert traction(5e-7, 0.0, 0.0) == 0
    assert return_mapping.new_anchor(5e-7, 0.0, EPS_T) == 5e-7


@pytest.mark.parametrize("u_x", [5e-7, -5e-7, 0.0])
def test_open_point_has_no_stiffness(u_x):
    """Nothing holds a point without pressure, be its spring slack or not: its place was carried along."""
    x = ufl.variable(ufl.as_ufl(u_x))
    slope = ufl.diff(return_mapping.traction(x, 0.0, 0.0, EPS_T), x)
    assert float(ufl.algorithms.apply_derivatives.apply_derivatives(slope)) == 0
