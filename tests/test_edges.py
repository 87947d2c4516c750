"""Ends of contact: where they are, meshes that are finest about them, and states solved again on these."""

from dataclasses import replace

import numpy as np
import pytest
from dolfinx.mesh import entities_to_geometry
from mpi4py import MPI

from fingerpad.accuracy.solves import StateRecorder, solve_again
from fingerpad.accuracy.states import contact_ends, edge_places
from fingerpad.model.finger import meshed
from fingerpad.model.options import FingerModel, by_rule, plan
from fingerpad.scene import from_data
from geometry import tags
from geometry.parameters import Fingertip, MeshSize
from geometry.profiles import Profiles
from tests.runs import path_of
from tests.small_finger import NINE
from variational.contact.penalty import Penalty
from variational.solvers.state_snapshot import SkinState, StateSnapshot
from variational.solvers.target import Control

PROFILES = Profiles(Fingertip())
ALONG = PROFILES.along_skin
SCENE = NINE | {"f_ext": 1.0, "voltage": 100.0}


def snapshot_of(gaps) -> StateSnapshot:
    """Return a state with a gap (m) over the arc length (m), each on a ridge, at points 2.5 um apart."""
    skin, nothing = {}, np.zeros(0)
    for j, gap in gaps.items():
        s = (j + np.linspace(-0.3, 0.3, 117)) * 483e-6
        places = PROFILES.point(s, PROFILES.skin(s))
        skin[j] = SkinState(nothing, nothing, nothing, places[::-1], gap(s[::-1]), nothing, {})
    return StateSnapshot(nothing, nothing, skin, {}, {}, {}, np.zeros(2), Control(), 0.0)


def test_ends_are_where_the_gap_is_zero():
    """Of a parabola on one ridge, closed over 81 um, and none on the other. Tolerance: lines between points."""
    found = contact_ends(snapshot_of({0: lambda s: s**2 - 40.5e-6**2, 2: lambda s: 0 * s + 1e-6}), ALONG, 10e-6)
    np.testing.assert_allclose(found, [-40.5e-6, 40.5e-6], atol=0.1e-6)


def test_facets_are_small_outwards_of_ends_on_coarse_facets():
    """On both sides alike, by the mirror image; an end that is known is one place. Roundoff of the ends moves none."""
    size = MeshSize(contact=16e-6)
    assert size.edge == pytest.approx(1e-6)
    found = edge_places([(np.array([-50e-6, 40e-6]), 20e-6)], size)
    np.testing.assert_allclose(found, [40e-6, 44e-6, 50e-6, 54e-6], rtol=1e-9)
    assert edge_places([(np.array([-50e-6, 40e-6]) * (1 + 1e-13), 20e-6)], size) == found
    known = edge_places([(np.array([-50e-6, 40e-6]), 1e-6)], size)
    np.testing.assert_allclose(known, [40e-6, 50e-6], rtol=1e-9)


@pytest.mark.mpi
def test_mesh_is_finest_where_contact_ends():
    """Facets of a sixteenth there, of the contact size elsewhere on the ridge."""
    scene = by_rule(from_data(NINE))
    end = 55e-6
    model = FingerModel(scene, plan(scene)).changed(edges=(end,))
    body = meshed(model, MPI.COMM_WORLD, half=True)
    profiles = Profiles(scene.geometry)
    facets = body.facets(tags.ridge(0))
    body.mesh.topology.create_connectivity(1, 0)
    here: list[tuple[float, float]] = []
    if len(facets):
        places = body.mesh.geometry.x[entities_to_geometry(body.mesh, 1, facets)][:, :2, :2]
        s = profiles.along_skin(places.reshape(-1, 2)).reshape(-1, 2)
        here = [(min(pair), max(pair)) for pair in s.tolist()]
    every = sorted({pair for part in MPI.COMM_WORLD.allgather(here) for pair in part})
    size = {(a + b) / 2: b - a for a, b in every}
    near = min(size, key=lambda middle: abs(middle - end))
    assert size[near] < 1.5 * model.mesh.edge
    assert max(size.values()) > 8 * model.mesh.edge


# -- states solved again -----------------------------------------------------------------------------------
@pytest.fixture(scope="module")
def path():
    scene = from_data(SCENE)
    simulation = path_of(scene, lambda step, done: keeper.record(step))
    keeper = StateRecorder(simulation)
    simulation.run()
    return simulation.model, keeper.solve().states


@pytest.mark.slow
def test_normal_contact_on_half_a_finger_is_that_of_the_whole(path):
    """The mesh of the whole is the half's and its mirror image. Tolerance: of the solves and of the air gaps."""
    model, states = path
    normal = {name: states[name] for name in ("uncharged", "charged")}
    half = solve_again(model, normal, MPI.COMM_WORLD)
    whole = solve_again(model.changed(options=replace(model.options, symmetric_start=False)), normal, MPI.COMM_WORLD)
    assert half.unknowns < 0.6 * whole.unknowns
    assert not half.states["charged"].snapshot.d_eq.keys() & {-1, -2}
    for name in normal:
        one, other = half.states[name], whole.states[name]
        np.testing.assert_allclose(one.lengths, other.lengths, rtol=1e-5, atol=1e-12)
        for key in ("f_contact", "bone_height", "p_max"):
            assert getattr(one.state, key) == pytest.approx(getattr(other.state, key), rel=1e-6), (name, key)
        assert one.sed == pytest.approx(other.sed, rel=1e-5)


@pytest.mark.slow
def test_states_over_a_stiffer_screen_sink_in_half_as_deep(path):
    """Of full slip too, whose friction stays. The states themselves are over the springs of the scene, each of them.

    Tolerance: the pressure changes with the length of the contact, by some per cent.
    """
    model, states = path
    stiffer = model.contact.over_stiffer_screen()
    assert isinstance(stiffer, Penalty)
    found = solve_again(model, states, MPI.COMM_WORLD, stiffer=stiffer)
    assert found.stiffer is not None and not found.soft
    assert found.stiffer.states.keys() == found.states.keys() == {"uncharged", "charged", "full_slip"}

    def deepest(state):
        return min(float(skin.position[..., 1].min()) for skin in state.snapshot.skin.values())

    for name, state in found.states.items():
        assert deepest(found.stiffer.states[name]) == pytest.approx(deepest(state) / 2, rel=0.1), name
        over = found.stiffer.states[name].state
        assert over.contact_length < state.state.contact_length
        assert over.contact_length == pytest.approx(state.state.contact_length, rel=0.1)
    slip, over = found.states["full_slip"].state, found.stiffer.states["full_slip"].state
    assert over.all_slip and over.f_t == pytest.approx(slip.f_t, rel=0.02)
