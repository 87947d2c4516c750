"""The ridge law: its ramps, its tables from one cell, and a block on it."""

import signal

import numpy as np
import pytest
from mpi4py import MPI

from fingerpad.io.interrupt import Interrupted
from fingerpad.reduced import ridge_cell
from fingerpad.scene import from_data
from geometry import tags
from geometry.bodies import block
from geometry.mesh import load
from variational.body import Body
from variational.contact.ridge_law import RidgeLaw, RidgeTable, ramps
from variational.materials.saint_venant import SaintVenant
from variational.problem import Interface
from variational.roughness.bam import BearingArea
from variational.solvers.continuation import StepFailed, Target

COARSE = {"mesh": {"contact": 30e-6}, "f_ext": 10.0, "voltage": 0.0}
PERIOD = 0.5e-3
Y = np.array([-20e-6, -8e-6, 0.0, 2e-6])
TABLE = RidgeTable(Y, np.array([9.0, 3.0, 1.0, 0.0]), np.array([2.0, 1.5, 1.2, 0.0]), np.array([8e-5, 5e-5, 3e-5, 0.0]))


# -- tables ------------------------------------------------------------------------------------------------
def test_ramps_are_linear_between_knots():
    """A sum of ramps against linear interpolation; beyond the lowest knot the first slope goes on. Roundoff."""
    c = ramps(TABLE.y, TABLE.contact)
    y = np.array([-20e-6, -13e-6, -3e-6, 0.0, 1e-6, 2e-6, 1e-3])
    found = (c * np.maximum(TABLE.y - y[:, None], 0)).sum(axis=1)
    np.testing.assert_allclose(found, np.interp(y, TABLE.y, TABLE.contact), rtol=1e-12, atol=1e-12)
    beyond = (c * np.maximum(TABLE.y + 32e-6, 0)).sum()
    assert beyond == pytest.approx(15.0, rel=1e-12)


@pytest.mark.parametrize(
    ("change", "sentence"),
    [
        ({"y": Y[::-1]}, "do not ascend"),
        ({"contact": np.array([9.0, 3.0, 1.0, 0.1])}, "ends before its forces vanish"),
        ({name: np.linspace(-1, 0, 60) for name in ("y", "contact", "attraction", "length")}, "60 rows; at most"),
    ],
)
def test_what_is_no_table_is_refused(change, sentence):
    with pytest.raises(ValueError, match=sentence):
        RidgeTable(**(vars(TABLE) | change))


@pytest.mark.parametrize(("exponent", "stretch"), [("printed", 0.60), ("abaqus", 0.70)])
def test_confined_dermis(exponent, stretch):
    """Under 30 kPa it loses 40 % of its volume, 30 % with the other sign; half of the last digit."""
    dermis = from_data({"materials": {"exponent": exponent}}).solids()[tags.DERMIS]
    assert ridge_cell.confined(dermis, 30e3) == pytest.approx(stretch, abs=0.005)


# -- a block on the law ------------------------------------------------------------------------------------
WIDTH, MU_F, FORCE = 1e-3, 0.3, 6.0


@pytest.fixture(scope="module")
def slid():
    """A stiff block two periods wide pressed on the law and slid to full slip."""
    body = load(MPI.COMM_WORLD, block(WIDTH, WIDTH / 4, WIDTH / 8))
    solids = {tags.STRATUM_CORNEUM: SaintVenant(1e10, 0.0)}
    law = Interface(RidgeLaw(TABLE, PERIOD, 1e10), MU_F, 0.514e-6)
    walk = Body(body, solids, law, BearingArea(0.514e-6), force_scale=FORCE, touch_depth=2e-6).continuation
    walk.run(Target("press", f_ext=FORCE))
    height = walk.surface_state.y.copy()
    walk.run(Target("slide", bone_x=20e-6, until_full_slip=True))
    return walk, height


def test_block_is_at_the_height_that_bears_it(slid):
    """Two ridges bear 6 N/m, so contact less attraction is 3 N/m each: where the table says, by hand.

    Between -20 and -8 um the net force falls from 7 to 1.5 N/m, so 3 N/m is at -8 - 12 * 1.5 / 5.5 um. Tolerance: the
    block yields by 1e-6 of its height.
    """
    np.testing.assert_allclose(slid[1], -8e-6 - 12e-6 * 1.5 / 5.5, rtol=1e-3)


def test_friction_is_the_cone_of_the_contact_force(slid):
    """Coulomb's law acts on the contact force, which the attraction raises: mu_f times twice the table's.

    Tolerance: the solver's 1e-9 of the force; the height of the block as it tips under friction, 1e-3 of a force.
    """
    walk, _ = slid
    assert walk.slip[1]
    contact = 2 * np.interp(-8e-6 - 12e-6 * 1.5 / 5.5, TABLE.y, TABLE.contact)
    assert -walk.solver.reaction[0] == pytest.approx(MU_F * contact, rel=1e-3)
    assert walk.observer.ridge_loads(walk.surface_state).f_contact[0] == pytest.approx(contact, rel=1e-3)


# -- the cell ----------------------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def cell(tmp_path_factory):
    folder = tmp_path_factory.mktemp("tables")
    return ridge_cell.tables(from_data(COARSE), folder), folder


@pytest.mark.mpi
def test_signal_on_one_rank_stops_all(tmp_path):
    """The cell is made by each rank alone; a rank without the signal must not wait for one that has it."""
    last = MPI.COMM_WORLD.rank == MPI.COMM_WORLD.size - 1

    def pause():
        if last:
            raise Interrupted(signal.SIGTERM, 1)

    with pytest.raises(Interrupted) as stopped:
        ridge_cell.tables(from_data(COARSE), tmp_path, pause=pause)
    assert stopped.value.signal == signal.SIGTERM and not list(tmp_path.iterdir())


def test_table_spans_the_load_and_the_release(cell):
    """Pressed to f_max, and nothing once it has let go; forces rise as the ridge sinks."""
    for table in (cell[0].normal, cell[0].slip):
        assert table.contact[0] == pytest.approx(5.0, rel=1e-6)  # f_max of 10 N/m, to the solver's tolerance
        assert (np.diff(table.contact) <= 0).all()
        assert not table.attraction.any()
        assert table.y[table.contact > 0].max() == pytest.approx(0, abs=1e-6)  # lets go where it first touched


def test_fine_facets_are_on_the_part_of_the_ridge_that_the_scene_gives():
    """Facets of 30 um grow off that part, so that a wider one has more unknowns; and the tables' name tells them."""
    narrow, wide = (from_data({"f_ext": 10.0, "mesh": COARSE["mesh"] | {"touching_fraction": f}}) for f in (0.2, 0.9))
    counts = [ridge_cell._Cell(scene, 5.0).solver.layout.global_size for scene in (narrow, wide)]
    assert counts[0] < 0.9 * counts[1]
    assert ridge_cell._made_of(narrow) != ridge_cell._made_of(wide)


def test_ridge_that_lets_go_at_the_first_lift_has_no_lifted_states(monkeypatch):
    """Its table then ends with the state that slides."""
    found = ridge_cell._Cell(from_data(COARSE), 2.5)

    def lost(target):
        raise StepFailed("jumps off")

    monkeypatch.setattr(found.walk, "run", lost)
    assert found._lift() == []


def test_table_does_not_know_of_the_layers_below(cell, tmp_path, monkeypatch):
    """A cell with three times the dermis has the same table: what flat layers yield is taken off exactly.

    Compared where both have a height; tolerance: the mesh of another body, 1 % of a contact of 3 facets.
    """
    monkeypatch.setattr(ridge_cell, "_DERMIS", 300e-6)
    other = ridge_cell.tables(from_data(COARSE), tmp_path)
    y = np.linspace(-12e-6, -5e-6, 5)
    np.testing.assert_allclose(other.normal.at(y)[0], cell[0].normal.at(y)[0], rtol=0.01)


def test_table_is_kept(cell, monkeypatch):
    """Read again it is the same, and nothing is computed."""
    monkeypatch.setattr(ridge_cell, "_Cell", None)
    again = ridge_cell.tables(from_data(COARSE | {"f_ext": 11.0}), cell[1])
    np.testing.assert_array_equal(again.slip.length, cell[0].slip.length)
    assert again.seconds == cell[0].seconds


def test_table_is_read_by_the_ranks_that_want_it(cell, monkeypatch):
    """On another communicator than that of all ranks, which would wait for those that want none."""
    monkeypatch.setattr(ridge_cell, "_Cell", None)
    monkeypatch.setattr(ridge_cell, "MPI", None)
    again = ridge_cell.tables(from_data(COARSE), cell[1], MPI.COMM_SELF)
    assert again.name == cell[0].name


def test_table_of_another_voltage_is_another(cell, monkeypatch):
    monkeypatch.setattr(ridge_cell, "_Cell", None)
    with pytest.raises(TypeError):
        ridge_cell.tables(from_data(COARSE | {"voltage": 100.0}), cell[1])
