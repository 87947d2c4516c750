"""The whole finger on three meshes: every row of its table, in every state, within the errors that are printed."""

from itertools import combinations

import pytest

import fingerpad as fp
from fingerpad.results.quantities import FINGER
from fingerpad.slices.errors import COARSE
from tests.small_finger import small

pytestmark = pytest.mark.slow
SIZES = (20e-6, 10e-6, 5e-6)  # m
SHAPE = {"radius": 6e-3, "length": 8e-3}
ROUNDOFF = 1e-8
LOADS = {
    "three ridges": {"f_ext": 4.0},
    "one ridge": {"f_ext": 0.5},
    "force": {"force": 2e-3},
}


@pytest.fixture(
    scope="module",
    params=["three ridges", *(pytest.param(name, marks=pytest.mark.long) for name in ("one ridge", "force"))],
)
def runs(request) -> list[fp.Result]:
    """The small finger at 100 V with three contact sizes: under 4 and 0.5 N/m, and under a force."""
    load = LOADS[request.param]
    return [fp.run(small(slices=SHAPE).replace(**load, mesh={"contact": size})) for size in SIZES]


def test_all_rows_differ_by_no_more_than_their_errors(runs):
    """Each pair of meshes, by the sum of the two errors; without any tolerance but that of roots."""
    fingers, missed = [run.finger for run in runs], []
    for one, other in combinations(fingers, 2):
        assert list(one.states) == ["uncharged", "charged", "full_slip"]
        for name in one.states:
            for key in FINGER:
                mine, its = one.values(name)[key], other.values(name)[key]
                known = one.error[name].get(key, 0.0) + other.error[name].get(key, 0.0)
                if abs(mine - its) > known + ROUNDOFF * abs(its):
                    missed.append((name, key, mine, its, known))
    assert missed == []


def test_part_of_the_coarser_mesh_falls(runs):
    """Of the area in contact, by half or more from 20 to 5 µm: it covers, and it informs."""
    for name in runs[0].finger.states:
        first, last = (run.finger.carried[name][COARSE]["contact_area"] for run in (runs[0], runs[-1]))
        assert last < 0.5 * first, name


def test_traces_end_in_the_states_of_the_section(runs):
    """Of a run in N/m: as they are on the final mesh, without voltage too."""
    for run in runs:
        for name, state in run.named.items() if run.scene.force is None else ():
            end = run.finger.traces[name]
            assert end.columns["contact_length"][-1] == pytest.approx(state.contact_length, rel=1e-12)
            assert end.depth[-1] == pytest.approx(-state.bone_height, rel=1e-12)
