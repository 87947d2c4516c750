"""What every run is checked for: balance of forces, and the cone of friction at full slip."""

import pytest

from fingerpad.model import balance
from variational.state import ContactState

SLIP = {"f_contact": 100.0, "f_electrostatic": 25.0, "f_ext": 75.0, "f_t": -25.0, "voltage": 200.0, "mu_app": 1 / 3}


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({}, ""),
        ({"f_ext": 75.1}, "out of balance by -0.1 N/m"),
        ({"f_t": 25.1}, "friction at full slip is 25.1 N/m and its limit 25 N/m"),
    ],
)
def test_balance_and_cone(change, words):
    """Errors of 0.1 N/m are a thousand times what the solves leave."""
    slip = ContactState(**(SLIP | {"ridges_in_contact": 3, "contact_length": 1e-3} | change))
    found = balance.broken(slip, 1e-4, 0.25)
    assert words in found and bool(found) == bool(words)
    assert balance.broken(None, 1e-4, 0.25) == ""


def test_friction_of_another_law_is_not_compared_with_coulomb_s():
    slip = ContactState(**(SLIP | {"ridges_in_contact": 3, "contact_length": 1e-3, "f_t": 30.0}))
    assert balance.broken(slip, 1e-4, None) == ""
