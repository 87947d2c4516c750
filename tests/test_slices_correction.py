"""A trace corrected by states on a finer mesh: what is exact at these states, and its two errors."""

from dataclasses import replace

import numpy as np
import pytest

from fingerpad.scene.parameters import Slices
from fingerpad.slices.correction import Pair, corrected, correction_errors, mesh_errors
from fingerpad.slices.total import at_force, profile
from fingerpad.slices.trace import trace
from variational.state import ContactState, RidgeStates

WAVELENGTH, MU_0 = 0.48e-3, 0.25
FORCES = np.geomspace(1.0, 100.0, 9)
FINGER, COUNT, FORCE = profile(Slices()), 24, 0.4
FACETS = 16e-6, 1e-6


def state(f_ext: float, attraction: float = 1.0, longer: float = 1.0, lower: float = 1.0, f_t: float = 1.0):
    """Return a section by power laws of the force, times factors; two ridges bear it."""
    f_el, length = attraction * 10.0 * f_ext**0.5, longer * 1e-4 * f_ext**0.6
    ridges = RidgeStates(np.array([0, 1]), length * np.array([0.7, 0.3]), *(np.zeros(2) for _ in range(5)))
    return ContactState(
        f_ext=f_ext, voltage=200.0, f_t=f_t * MU_0 * (f_ext + f_el), mu_app=0.0, f_contact=f_ext + f_el,
        f_electrostatic=f_el, ridges_in_contact=2, contact_length=length, bone_height=-lower * 1e-4 * f_ext**0.5,
        ridges=ridges,
    )  # fmt: skip


def of(*factors: float):
    return trace([state(force, *factors) for force in FORCES], WAVELENGTH)


def test_constant_ratios_are_taken_away():
    """A coarse mesh that is wrong by one factor a quantity gives the trace of the fine one, by any of its states."""
    fine = of()
    for at in (FORCES[2], FORCES[-1]):
        pair = Pair(state(at, 1.02, 0.97, 0.99), state(at), FACETS)
        found = corrected(of(1.02, 0.97, 0.99), [pair], WAVELENGTH)
        assert found.depth == pytest.approx(fine.depth, rel=1e-12)
        for name, values in fine.columns.items():
            exact = 2e-2 if name == "gross_width" else 1e-12  # of ridges that are counted, and a length
            assert found.columns[name] == pytest.approx(values, rel=exact), name


def test_two_states_are_met_and_ratios_go_evenly_between():
    """In the logarithm of the force; friction stays Coulomb's of the contact force."""
    ratios = (FORCES[2], 0.04), (FORCES[6], 0.02)
    coarse, pairs = of(), [Pair(state(at), state(at, 1 + more), FACETS) for at, more in ratios]
    found = corrected(coarse, pairs, WAVELENGTH)
    ratio = found.columns["f_electrostatic"] / coarse.columns["f_electrostatic"]
    assert ratio == pytest.approx(1 + 0.01 * np.array([4, 4, 4, 3.5, 3, 2.5, 2, 2, 2]), rel=1e-12)
    borne = found.columns["f_ext"] + found.columns["f_electrostatic"]
    assert found.columns["f_t"] == pytest.approx(MU_0 * borne, rel=1e-12)


def test_error_of_the_mesh_is_that_of_two_meshes():
    """Twice the change over r^p - 1: of first order in the facets at the ends for lengths, else p = 2 in all elements.

    The change of a length is at least the root of the ridges' squared ones.
    """
    pair = Pair(state(50.0, longer=0.98, lower=1.01), state(50.0), FACETS)
    found = mesh_errors(pair, WAVELENGTH)
    assert found["contact_area"] == pytest.approx(0.04 / (16 - 1), rel=1e-9)
    assert found["indentation"] == pytest.approx(0.02 / 3, rel=1e-9)
    assert mesh_errors(pair, WAVELENGTH, 1)["indentation"] == pytest.approx(0.02, rel=1e-9)
    ridges = replace(pair.fine.ridges, length=pair.fine.ridges.length[::-1].copy())
    turned = mesh_errors(Pair(pair.fine, replace(pair.fine, ridges=ridges), FACETS), WAVELENGTH)
    assert turned["contact_area"] == pytest.approx(2 * 0.4 * 2**0.5 / (16 - 1), rel=1e-9)
    bare = mesh_errors(Pair(state(50.0, 0.0), state(50.0, 0.0), FACETS), WAVELENGTH)
    assert set(bare) == {*found} - {"f_electrostatic"}
    still = Pair(state(50.0, f_t=0.0), replace(state(50.0), f_t=1e-13), FACETS)
    assert not {"f_t", "mu_app"} & set(mesh_errors(still, WAVELENGTH)), "roundoff is no friction"


def test_error_of_the_correction_is_what_other_states_change():
    """Of one state, all that it changes; of more, what the sum changes without one of them but the last."""
    coarse, one = of(), Pair(state(FORCES[6]), state(FORCES[6], 1.02), FACETS)
    found = correction_errors(FINGER, coarse, [one], WAVELENGTH, FORCE, COUNT)
    sums = [at_force(FINGER, each, FORCE, COUNT).values for each in (corrected(coarse, [one], WAVELENGTH), coarse)]
    assert found["f_electrostatic"] == pytest.approx(1 - sums[1]["f_electrostatic"] / sums[0]["f_electrostatic"])
    assert found["f_electrostatic"] == pytest.approx(0.02, rel=0.03)
    same = Pair(state(FORCES[2]), state(FORCES[2], 1.02), FACETS)
    assert max(correction_errors(FINGER, coarse, [same, one], WAVELENGTH, FORCE, COUNT).values()) < 1e-12
    other = Pair(state(FORCES[2]), state(FORCES[2], 1.04), FACETS)
    found = correction_errors(FINGER, coarse, [other, one], WAVELENGTH, FORCE, COUNT)
    assert 0.001 < found["f_electrostatic"] < 0.02
