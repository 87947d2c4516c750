"""Fields inside the finger: as arrays, in PyVista."""

from pathlib import Path

import numpy as np
import pytest
from mpi4py import MPI

import fingerpad as fp
from fingerpad.results.fields import Fields
from fingerpad.scene import from_data
from geometry import tags
from tests.runs import no_pictures
from tests.small_finger import NINE

pytestmark = pytest.mark.slow
PRESS, SLIDE = {"name": "press", "f_ext": 1.0}, {"name": "go on", "bone_height": -60e-6}
SCENE = NINE | {
    "history": [PRESS, SLIDE],
    "numerics": {"element": "P1"},
    "output": {"receptors": False, "errors": False},
}


@pytest.fixture(scope="module")
def ran(tmp_path_factory) -> fp.Result:
    """A press alone, of which one half is computed; on linear elements the strain is one number a cell."""
    with no_pictures():
        return fp.run(from_data(SCENE), out=tmp_path_factory.mktemp("run") / "out")


def straight(fields: Fields) -> np.ndarray:
    """Return which cells have neighbours of their own layer on all sides."""
    edges = np.sort(fields.triangles[:, [[0, 1], [1, 2], [2, 0]]], axis=2).reshape(-1, 2)
    _, edge = np.unique(edges, axis=0, return_inverse=True)
    layer = np.repeat(fields.layer, 3)
    least, most = np.full(edge.max() + 1, 99), np.zeros(edge.max() + 1)
    np.minimum.at(least, edge, layer)
    np.maximum.at(most, edge, layer)
    inner = (np.bincount(edge) == 2) & (least == most)
    return inner[edge].reshape(-1, 3).all(axis=1)


def test_strain_is_that_of_the_displacement(ran):
    """On both halves, of which one is the other's image, by the corners of cells without a curved edge.

    Curved are edges on the boundary and between layers. Tolerance: roundoff, but beside curved edges gmsh bends some
    of the inner ones a little.
    """
    fields = ran.fields["press"]
    reference, moved = (x[fields.triangles] for x in (fields.points, fields.points + fields.displacement))
    sides, now = (np.moveaxis(x[:, 1:] - x[:, :1], 1, 2) for x in (reference, moved))
    F = now @ np.linalg.inv(sides)
    expected = (np.moveaxis(F, 1, 2) @ F - np.eye(2)) / 2
    assert fields.strain.shape == fields.stress.shape == (len(fields.triangles), 3, 3)
    inside = straight(fields)
    assert 0.3 < inside.mean() < 1
    error = np.abs(fields.strain[:, :2, :2] - expected)[inside].max(axis=(1, 2))
    assert error.max() < 1e-3 * np.abs(expected).max() and (error < 1e-10).mean() > 0.8
    assert np.abs(expected[:, 0, 1]).max() > 1e-3 and not fields.strain[:, 2].any()
    assert {*np.unique(fields.layer)} <= {*tags.LAYERS.values()}


def test_stress_and_energy_are_those_of_the_law(ran):
    """Of nail and its bed, on both halves: by the strain, with Lamé's constants of the law.

    Tolerance: 1e-3. The law's stress is Cauchy's but for parts of some strains, the largest of which is below 1e-4.
    """
    fields = ran.fields["press"]
    inside = straight(fields)
    for name in ("nail", "nail bed"):
        law = getattr(ran.scene.materials, name.replace(" ", "_"))
        mine = inside & (fields.layer == tags.LAYERS[name])
        strain, stress = fields.strain[mine], fields.stress[mine]
        assert {*np.sign(fields.points[fields.triangles[mine], 0].mean(axis=1))} == {-1.0, 1.0}
        shear, trace = law.young / (2 + 2 * law.poisson), np.trace(strain, axis1=1, axis2=2)
        lame = 2 * shear * law.poisson / (1 - 2 * law.poisson)
        expected = 2 * shear * strain + lame * trace[:, None, None] * np.eye(3)
        assert np.abs(strain).max() < 1e-4
        np.testing.assert_allclose(stress, expected, rtol=0, atol=1e-3 * np.abs(expected).max())
        energy = (expected * strain).sum(axis=(1, 2)) / 2
        np.testing.assert_allclose(fields.sed[mine], energy, rtol=0, atol=1e-3 * energy.max())


def test_skin_over_the_contact_is_compressed(ran):
    """On average within 0.3 mm, normal to the screen, by no more than the highest pressure; stress is symmetric."""
    fields = ran.fields["press"]
    x, y = fields.points[fields.triangles].mean(axis=1).T
    mean = fields.stress[np.hypot(x, y) < 0.3e-3, 1, 1].mean()
    assert -ran.steps[-1].p_max < mean < 0
    np.testing.assert_array_equal(fields.stress, np.moveaxis(fields.stress, 1, 2))


def test_fields_of_a_read_result_are_those_of_the_run(ran):
    """Tensors have 32 bits in the file."""
    again = fp.Result.load(ran.folder).fields
    assert list(again) == list(ran.fields)
    for name, fields in ran.fields.items():
        for key, values in vars(fields).items():
            exact = key not in ("stress", "strain")
            np.testing.assert_allclose(getattr(again[name], key), values, rtol=0 if exact else 1e-7, atol=1e-30)


def test_pyvista_has_the_fields_and_writes_them(ran, tmp_path):
    """A block for each load and named state, in m and Pa; saved by PyVista and read again."""
    pyvista = pytest.importorskip("pyvista")
    ran.to_pyvista().save(tmp_path / "fields.vtm")
    for blocks in (ran.to_pyvista(), pyvista.read(tmp_path / "fields.vtm")):
        for load in ("press", "go on"):
            grid, fields = blocks[load], ran.fields[load]
            assert set(grid.celltypes) == {pyvista.CellType.TRIANGLE}
            np.testing.assert_array_equal(grid.points[:, :2], fields.points)
            for name in ("stress", "strain", "sed"):
                values = getattr(fields, name)
                np.testing.assert_allclose(grid[name].reshape(values.shape), values, rtol=1e-7, atol=1e-30)
            np.testing.assert_array_equal(grid["layer"], fields.layer)
            lowest = grid.warp_by_vector("displacement").points[:, 1].min()
            assert lowest == pytest.approx((fields.points + fields.displacement)[:, 1].min(), abs=1e-12)


@pytest.mark.mpi
@pytest.mark.skipif(MPI.COMM_WORLD.size == 1, reason="one rank has no other to agree with")
def test_ranks_write_what_one_does(tmp_path):
    """The same cells in the same order, and numbers to 1e-8 of the largest, the solver's tolerance."""
    comm = MPI.COMM_WORLD
    place = Path(comm.bcast(str(tmp_path)))
    with no_pictures():
        many, one = (
            fp.run(from_data(SCENE), out=place / name / str(rank), comm=each)
            for name, rank, each in (("all", 0, comm), ("one", comm.rank, MPI.COMM_SELF))
        )
    assert bool(many.fields) == (comm.rank == 0)
    for load in many.fields:
        for key, expected in vars(one.fields[load]).items():
            np.testing.assert_allclose(getattr(many.fields[load], key), expected, atol=1e-8 * np.abs(expected).max())


def test_what_is_missing_is_one_sentence(ran, monkeypatch):
    """A model without a mesh has no fields; without PyVista the remedy is named."""
    found = fp.run(model="cylinders")
    assert found.fields == {}
    for wanted in (found.to_pyvista, lambda: found.fields["full_slip"]):
        with pytest.raises(ValueError, match="the result of the model 'cylinders' has no fields here; full runs have"):
            wanted()
    with pytest.raises(ValueError, match="has no fields of 'stress'; it has those of 'press', 'go on', 'uncharged'"):
        ran.fields["stress"]
    monkeypatch.setitem(__import__("sys").modules, "pyvista", None)
    nothing = Fields(*(np.zeros((0, 2)),) * 7)
    with pytest.raises(ImportError, match="to_pyvista needs pyvista, which is not installed; pip install pyvista, or"):
        nothing.to_pyvista()


@pytest.mark.parametrize("errors", [False, True])
def test_bone_of_full_slip_is_where_its_fields_have_it(tmp_path, errors):
    """The nodes on the bone, some 45, move by ``bone_x``, to roundoff; also from the folder, and on the final mesh.

    Both are solved for 0.2 mm and more behind the place where slip begins.
    """
    scene = NINE | {"f_ext": 1.0, "voltage": 60.0, "output": {"receptors": False, "errors": errors}}
    with no_pictures():
        result = fp.run(from_data(scene), out=tmp_path)
    for found in (result, fp.Result.load(tmp_path)):
        moved = found.fields["full_slip"].displacement[:, 0]
        assert np.isclose(moved, found.full_slip.bone_x, rtol=0, atol=1e-12).sum() > 30
