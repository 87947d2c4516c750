"""Single runs of a coarse strip: what they reach, and how a failure is recorded."""

from dataclasses import replace

import pytest

from benchmarks.stability import solve
from benchmarks.stability.solve import Case

# A press of half an newton a metre on facets of 60 um: two seconds a run.
TINY = Case(contact_size=60e-6, force=0.5, voltage=50.0, element="P1", slide=0.0)


@pytest.mark.slow
def test_friction_at_full_slip():
    """Pressed without voltage the ridge bears the force, and the screen drags with mu_0 times it, to the solve's."""
    found = solve.run(replace(TINY, voltage=0.0, slide=1e-3))
    assert found.status == "converged" and found.full_slip
    assert found.f_ext == pytest.approx(0.5, rel=1e-7)
    assert found.f_t == pytest.approx(0.25 * 0.5, rel=1e-6)
    assert found.contact_length > 0 < found.penetration


@pytest.mark.slow
def test_failure_is_recorded_with_its_reason():
    """A penalty 1e12 times the default leaves no digits: the run says by which name and in which load it ended."""
    found = solve.run(replace(TINY, parameter=1.5e24))
    assert found.status == "failed" and found.load == "press"
    assert found.reason.startswith("DIVERGED_") and found.reason in found.message
