"""Random scenes of the stability page: how they are drawn, what is kept of their runs, and their table."""

import pytest

from benchmarks.stability import scenes
from fingerpad.scene import Scene

STUCK = "step 26 (slide, 18.3 % done) found no equilibrium beyond f_ext 12.6 N/m, 296 V: DIVERGED_LOCAL_MIN; try more"
FINER = {"contact": 15e-6, "factorisations": 40, "newton_iterations": 90, "reason": STUCK}
WIDER = {"contact": 30e-6, "factorisations": 7, "newton_iterations": 20, "reason": "ridge 4 came near the screen"}


def summary(*restarts, contact=30e-6, **values):
    work = {"factorisations": 50, "newton_iterations": 100, "full_slip": True, "path_mesh": {"contact": contact}}
    return work | {"restarts": list(restarts)} | values


def test_scenes_are_within_their_ranges():
    default = Scene()
    for number in range(scenes.COUNT):
        data = scenes.drawn(number)
        assert 2 <= data["f_ext"] <= 200 and 0 <= data["voltage"] <= 300 and 0.05 <= data["friction"] <= 1
        for name, value in data["roughness"].items():
            assert 0.59 < value / getattr(default.roughness, name) < 1.41  # of three digits
        for layer in ("subcutis", "dermis", "viable_epidermis", "stratum_corneum"):
            usual = getattr(default.materials, layer).shear_modulus
            assert 0.69 < data["materials"][layer]["shear_modulus"] / usual < 1.31
    assert {scenes.drawn(number)["materials"]["exponent"] for number in range(2)} == {"printed", "abaqus"}


@pytest.mark.parametrize(
    ("found", "factorisations", "failure"),
    [
        (summary(), 50, ""),
        (summary(WIDER), 57, ""),
        (summary(FINER, contact=15e-6), 90, "slide: DIVERGED_LOCAL_MIN"),
        (summary(full_slip=False, failure=STUCK), 50, "slide: DIVERGED_LOCAL_MIN"),
        ({"failure": "TIME_LIMIT: more than 180 s"}, 0, "TIME_LIMIT"),
    ],
)
def test_row(found, factorisations, failure):
    """Restarts cost what they cost; what they are for is kept where they need smaller elements."""
    kept_row = scenes.row(found)
    assert (kept_row["factorisations"], kept_row["failure"]) == (factorisations, failure)
    assert kept_row["full_slip"] == found.get("full_slip", False)
