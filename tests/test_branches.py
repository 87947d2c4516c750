"""Forces of a trace of full slip, and sizes of elements of all traces."""

import numpy as np
import pytest

import fingerpad as fp
from fingerpad.model.options import FingerModel, by_rule, plan
from fingerpad.runs import branches, newtons
from fingerpad.slices.traces import LIGHT, MARGIN


def test_forces_are_evenly_apart_and_have_those_that_are_kept():
    top = 80.0
    kept = (branches.QUARTER * top, top / MARGIN)
    found = branches._forces(top * LIGHT, top, kept)
    assert set(kept) < set(found) and found[-1] == top
    ratios = np.diff(np.log([top * LIGHT, *found]))
    apart = -np.log(LIGHT) / (branches.POINTS - 1)
    assert (ratios > 0).all() and ratios.max() < 1.5 * apart
    assert len(found) == pytest.approx(branches.POINTS, abs=2)


def test_longer_trace_goes_on_from_its_end():
    """What was kept below the present force is not among the forces again."""
    found = branches._forces(80.0, 144.0, (36.0, 131.0))
    assert found[0] > 80.0 and 36.0 not in found and 131.0 in found and found[-1] == 144.0


@pytest.mark.parametrize(("contact", "coarse"), [(4e-6, 8e-6), (5e-6, 10e-6), (8e-6, 10e-6), (40e-6, 40e-6)])
def test_elements_of_the_traces_are_twice_as_large(contact, coarse):
    """Facets only as far as they do not trap the edge of a charged contact."""
    scene = fp.Scene().replace(mesh={"contact": contact})
    model = FingerModel(by_rule(scene), plan(scene))
    sizes = newtons.coarser(model)
    assert sizes["contact"] == coarse
    for name in ("growth", "interface", "coarsest", "receptor"):
        assert sizes[name] == 2 * getattr(model.mesh, name)
