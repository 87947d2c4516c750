"""The same scene gives the same digits with every dolfinx: Debian's 0.9, and 0.11 from PyPI by `make test-pip`."""

import pytest

from fingerpad.scene import load
from tests.runs import run
from tests.small_finger import SMALL

pytestmark = pytest.mark.slow

# By Debian 13's dolfinx 0.9.0 and PETSc 3.22.
DIGITS = {
    "uncharged_contact_length": 0.000143324377,
    "charged_f_electrostatic": 2.86955915,
    "charged_contact_length": 0.000197859755,
    "full_slip_f_t": 1.4678207,
    "full_slip_mu_app": 0.489273567,
    "full_slip_f_electrostatic": 2.8712828,
    "full_slip_contact_length": 0.000197363705,
    "full_slip_bone_height": -0.000103815516,
}
# The coupling iteration ends at 1e-6 of the air gap, and takes the same iterations here; what remains is roundoff.
TOLERANCE = 1e-6


@pytest.fixture(scope="module")
def summary(tmp_path_factory):
    return run(load(SMALL.with_name("coarse.toml")).replace(output={"errors": False}), tmp_path_factory.mktemp("run"))


@pytest.mark.parametrize("name", DIGITS)
def test_digits(summary, name):
    assert summary[name] == pytest.approx(DIGITS[name], rel=TOLERANCE)
