"""What a penalty changes: on a law that is known, and on the default scene's runs with other stiffnesses."""

import numpy as np
import pytest

from benchmarks.errors import stiffer
from fingerpad.accuracy.solves import over_stiffer
from fingerpad.richardson import ORDER, rigid
from variational.contact.penalty import Penalty
from variational.solvers.equations import Control
from variational.solvers.transfer import SkinState, StateSnapshot


def test_law_is_extrapolated_exactly():
    """To roundoff."""

    def q(eps):
        return 1 + 0.3 * eps**-ORDER

    assert rigid({"q": q(4.0)}, {"q": q(8.0)})["q"] == pytest.approx(1 - q(4.0), rel=1e-12)


def test_both_stiffnesses_are_doubled():
    assert Penalty(3e12, 5e10).over_stiffer_screen() == Penalty(6e12, 1e11)


def test_stiffer_springs_bear_the_same_friction():
    """Of the stuck skin: half the elastic slip of twice the stiffness; all else of the state stays."""
    line = np.array([0.0, 1e-6])
    history = {"anchor": np.array([2e-7, -3e-8]), "pressure": line}
    skin = SkinState(line, line, line, line, history)
    state = StateSnapshot(line, line, {4: skin}, {}, {4: 2e-6}, {4: 0.5}, line, Control(), 0.0)
    found = over_stiffer(state)
    assert found.skin[4].history["anchor"].tolist() == [1e-7, -1.5e-8]
    assert found.skin[4].history["pressure"] is line and found.u is line and found.gain == {4: 0.5}


@pytest.mark.parametrize("state", ["uncharged", "charged", "full_slip"])
def test_order_predicts_the_contact_over_a_stiffer_screen(state):
    """From 500 and 1500 MPa/mm, what 5000 changes of the default scene's contact: to a factor of two."""
    predicted, found = stiffer()[state]
    assert found < 0
    assert 0.5 < predicted / found < 2
