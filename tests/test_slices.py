"""A whole finger as a sum of slices: closed forms, conservation, convergence, tables and what is refused."""

import json
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fingerpad as fp
from fingerpad.reduced import press
from fingerpad.results.pictures.solid import _strips, footprint, solid
from fingerpad.scene import Scene, SceneError
from fingerpad.scene.parameters import Slices
from fingerpad.slices.errors import MESH
from fingerpad.slices.estimate import with_newtons
from fingerpad.slices.finger import WholeFinger
from fingerpad.slices.total import BeyondTrace, at_force, at_indentation, profile
from fingerpad.slices.trace import Trace, TraceError, trace
from geometry.profiles import Profiles
from tests.measures import contact_state
from variational.state import ContactState, Errors

R_X, R_Z = 14e-3, 28e-3  # m
FOUNDATION = 1e9  # Pa/m
FRICTION = 0.25
MODELS = Path(__file__).parents[1] / "docs" / "models.json"
EXACT = 1e-6  # what a closed form must be met by


def foundation(points: int = 12, deepest: float = 1.5e-3) -> Trace:
    """Return the trace of a parabola on an elastic foundation, whose pressure is k times the indentation."""
    depth = np.geomspace(2e-5, deepest, points)
    width = 2 * np.sqrt(2 * R_X * depth)
    force = 2 / 3 * FOUNDATION * width * depth
    columns = {"f_ext": force, "f_t": FRICTION * force, "f_electrostatic": 0 * force}
    return Trace(depth, columns | {"contact_length": 0.2 * width, "gross_width": width})


def kept(voltage: float, model: str = "full") -> Trace:
    """Return the default finger's trace at full slip, from kept runs."""
    scenes, states = json.loads(MODELS.read_text())["numbers"]["scenes"], []
    for f_ext in (5.0, 10.0, 25.0, 50.0, 75.0, 100.0, 120.0, 150.0):
        found = scenes[f"{f_ext:g} N/m, {voltage:g} V"][model]["summary"]
        names = ("f_t", "bone_height", "f_electrostatic", "ridges_in_contact", "contact_length", "f_contact", "mu_app")
        values = {name: found[f"full_slip_{name}"] for name in names}
        states.append(ContactState(f_ext=f_ext, voltage=voltage, **values))
    return trace(states, Scene().geometry.ridge_wavelength)


@pytest.mark.parametrize("depth", [1e-5, 1e-4, 0.7e-3])
def test_paraboloid_on_an_elastic_foundation(depth):
    """Force π k √(R_x R_z) δ², area 2 π √(R_x R_z) δ; also above the first point of the trace, at 20 µm."""
    total = at_indentation(profile(Slices(radius=R_Z)), foundation(), depth, 48)
    root = np.sqrt(R_X * R_Z)
    assert total.totals["f_ext"] == pytest.approx(np.pi * FOUNDATION * root * depth**2, rel=EXACT)
    assert total.totals["gross_area"] == pytest.approx(2 * np.pi * root * depth, rel=EXACT)
    assert total.values["real_over_gross"] == pytest.approx(0.2, rel=EXACT)
    assert total.values["shear_stress"] == pytest.approx(FRICTION * FOUNDATION * depth / 2 / 0.2, rel=EXACT)
    assert at_force(profile(Slices()), foundation(), total.totals["f_ext"], 48).delta == pytest.approx(depth, rel=EXACT)


def test_pressure_is_what_the_contact_bears_over_its_length():
    """Force and attraction together; over all slices it makes the contact force."""
    total = at_indentation(profile(Slices()), kept(200.0), 0.7e-3, 24)
    borne = total.thickness @ (total.pressure * total.columns["contact_length"])
    assert borne == pytest.approx(total.totals["f_ext"] + total.totals["f_electrostatic"], rel=1e-12)
    assert total.totals["f_electrostatic"] > 0.5 * total.totals["f_ext"]


@pytest.mark.parametrize("tilt", [0.2, 0.35, -0.785])
def test_tilted_sphere(tilt):
    """A sphere is the same at any angle, with its lowest point at −R sin α; roundoff of square roots at its tip."""
    sphere = {"radius": R_X, "length": 2 * R_X, "shape": "ellipsoid"}
    fingers = (profile(Slices(**sphere, tilt=angle)) for angle in (0.0, tilt))
    level, turned = (at_indentation(each, foundation(), 1e-3, 48) for each in fingers)
    assert turned.values == pytest.approx(level.values, rel=1e-9)
    assert_allclose(turned.z[turned.depth.argmax()], -R_X * np.sin(tilt), atol=2e-4)  # two slices are 0.2 mm apart


@pytest.mark.parametrize("tilt", [0.1, 0.35])
def test_tilted_paraboloid(tilt):
    """The plane cuts it in an ellipse of 2 π √(R_x R_z) δ / cos² α; upright layers are thicker by 1 / cos α there.

    Tolerance: slices are parabolas, of second order in the length of contact over R_z times the slope.
    """
    total = at_indentation(profile(Slices(radius=R_Z, tilt=tilt)), foundation(), 5e-5, 48)
    root, cosine = np.sqrt(R_X * R_Z), np.cos(tilt)
    assert total.totals["gross_area"] == pytest.approx(2 * np.pi * root * 5e-5 / cosine**2, rel=1e-4)
    assert total.totals["f_ext"] == pytest.approx(np.pi * FOUNDATION * root * 5e-5**2 / cosine, rel=1e-3)


def test_tilted_finger_of_the_default_length():
    """The parabola ends at some 20 degrees; half an ellipsoid touches with its pad at 45, on narrower slices."""
    with pytest.raises(SceneError, match="lowest at its end.*ellipsoid"):
        at_force(profile(Slices(tilt=0.5)), kept(200.0), 0.5, 48)
    fingers = (profile(Slices(shape="ellipsoid", tilt=angle)) for angle in (0.0, 0.785))
    level, tilted = (at_force(each, kept(200.0), 0.2, 48) for each in fingers)
    assert tilted.delta > level.delta
    assert tilted.totals["gross_area"] < level.totals["gross_area"]


def test_scale_of_the_slices():
    """A cylinder of twice the width is the cross-section on twice the scale: f = 2 f(h / 2)."""
    twice = profile(Slices(z=(0.0, 0.01), height=(0.0, 0.0), width=(2.0, 2.0)))
    total, one = at_indentation(twice, foundation(), 1e-3, 8), foundation().at(np.array([0.5e-3]))
    assert total.totals["f_ext"] == pytest.approx(0.01 * 2 * one["f_ext"][0], rel=EXACT)
    assert total.totals["contact_area"] == pytest.approx(0.01 * 2 * one["contact_length"][0], rel=EXACT)


def test_two_humps_touch_apart():
    """Two stretches of contact of a table are two sums; each bears the half."""
    z = (-10e-3, -6e-3, -5e-3, -4e-3, 0.0, 4e-3, 5e-3, 6e-3, 10e-3)
    humps = profile(Slices(z=z, height=(1e-3, 1e-4, 0.0, 1e-4, 1e-3, 1e-4, 0.0, 1e-4, 1e-3)))
    total = at_indentation(humps, foundation(), 0.3e-3, 16)
    left = total.thickness[total.z < 0] @ total.columns["f_ext"][total.z < 0]
    assert len(humps.contact(0.3e-3)) == 2 and len(total.z) == 32
    assert left == pytest.approx(total.totals["f_ext"] / 2, rel=1e-9)


@pytest.mark.parametrize("voltage", [0.0, 100.0, 200.0])
def test_friction_of_the_sum_is_the_coefficient_times_its_contact_force(voltage):
    """Nothing is lost between slices: F_T = µ_0 (F_ext + F_el), and F_ext is the force asked for; roundoff."""
    total = at_force(profile(Slices()), kept(voltage), 0.5, 48)
    sums = total.totals
    assert sums["f_ext"] == pytest.approx(0.5, rel=1e-12)
    assert sums["f_t"] == pytest.approx(FRICTION * (sums["f_ext"] + sums["f_electrostatic"]), rel=1e-7)
    assert total.thickness.sum() == pytest.approx(np.ptp(profile(Slices()).contact(total.delta)), rel=1e-12)


def test_slices_refined():
    """The error falls as the number of slices to the power of -2 at least: the trace's cubics have kinks in slope."""
    sums = [at_indentation(profile(Slices()), kept(200.0), 0.68e-3, n).totals["f_t"] for n in (8, 32, 128, 2048)]
    errors = np.abs(np.array(sums[:3]) / sums[3] - 1)
    assert np.all(errors[1:] < errors[:-1] / 16) and errors[1] < 1e-4


def test_states_that_go_back_are_left_out():
    """Behind a jump the bone may come up again: the trace stays monotonic."""
    states = [
        contact_state(f_ext=force, contact_length=1e-4, bone_height=-depth)
        for force, depth in ((3.0, 3e-4), (1.0, 1e-4), (2.0, 2e-4), (4.0, 2.9e-4), (5.0, 4e-4), (5.0, 5e-4))
    ]
    assert trace(states, 5e-4).columns["f_ext"].tolist() == [1.0, 2.0, 3.0, 5.0]


# -- results -------------------------------------------------------------------------------------------
def whole() -> WholeFinger:
    shape, trace = Slices(count=8), kept(200.0)
    total = at_force(profile(shape), trace, 0.5, shape.count)
    carried = {"full_slip": {MESH: {"f_t": 0.02, "mu_app": 0.03}}}
    return WholeFinger({"full_slip": total}, "kept runs", carried, {"full_slip": trace}, shape)


def test_result_from_its_file():
    """What result.nc holds gives the same finger again; its states have their quantities as attributes."""
    finger = whole()
    bare = fp.Result(Scene(slices={"count": 8}), "full", None, None, None, finger=finger)
    again = fp.Result.from_xarray(bare.to_xarray()).finger
    assert again.flat() == finger.flat() and str(again) == str(finger)
    slip = again.full_slip
    assert again.charged is None and slip.f_t == finger.values("full_slip")["f_t"]
    assert slip.error.f_t == finger.error["full_slip"]["f_t"]


def test_footprint_has_a_panel_for_each_state(tmp_path):
    """And one along the finger; its areas are those of the sums."""
    finger = whole()
    drawn = footprint(finger, tmp_path / "footprint.png")
    area = 1e6 * finger.states["full_slip"].totals["gross_area"]
    assert len(drawn.axes) == 2 and f"full slip\n{area:.1f} mm² gross" in drawn.axes[0].get_title()
    assert (tmp_path / "footprint.png").stat().st_size > 1000
    state, along = drawn.axes
    assert along.get_ylabel() == state.get_ylabel() and along.get_ylim() == state.get_ylim()
    bands = [text.get_text() for text in drawn.legends[0].get_texts()]
    assert [words.partition(" ")[0] for words in bands] == ["light:", "dark:"] and "ridges" in bands[1]


def test_finger_in_three_dimensions_has_the_ridges_of_its_slices(tmp_path):
    """Pieces of ridges lie on the screen, on the lowest skin, with the contact area and the highest mean pressure.

    Tolerance: outer halves of the outermost slices are not drawn.
    """
    shape, trace = Slices(count=64), kept(200.0)
    total, section = at_force(profile(shape), trace, 0.5, shape.count), Profiles(Scene().geometry)
    finger = WholeFinger({"full_slip": total}, "kept runs", {}, {"full_slip": trace}, shape)
    (ax, bar) = solid(finger, section, tmp_path / "solid.png", None, "full_slip").axes
    skin, ridges = ax.collections
    pieces, values = _strips(total, None, section.finger.ridge_wavelength)
    across, along = pieces[:, 1] - pieces[:, 0] + pieces[:, 2] - pieces[:, 3], pieces[:, 2] - pieces[:, 1]
    area = float((across[:, 0] / 2 * along[:, 1]).sum())
    assert area == pytest.approx(1e6 * total.totals["contact_area"], rel=0.02)
    assert (pieces[:, :, 2] == 0).all() and ax.get_zlim()[0] <= 0 < ax.get_zlim()[1]
    assert np.asarray(ridges.get_array()).max() == values.max() == pytest.approx(1e-3 * total.pressure.max(), rel=0.01)
    assert "(kPa)" in bar.get_title() and (tmp_path / "solid.png").stat().st_size > 10_000


def slip_alone(**changes: object) -> fp.Result:
    """Full slip at the centre, as a point of a sweep of full slip alone has it."""
    slip = fp.run(model="cylinders").full_slip
    slip = replace(slip, bone_height=-float(press.of(fp.Scene()).indentation(slip.f_ext, "full_slip")), error=Errors())
    return with_newtons(fp.Result(fp.Scene(**changes), "full", None, None, slip))


def test_full_slip_alone_has_a_finger():
    """By the press of the closed form. Of the closed form's own full slip it is the closed form's sum.

    Tolerance: the error that the estimate states, since away from the centre full slip has the contact of the press.
    """
    found = slip_alone()
    own = fp.run(fp.Scene(force=found.finger.f_ext), model="cylinders")
    assert list(found.finger.states) == ["full_slip"] and found.headline.quantity.name == "mu_app"
    error = found.finger.error["full_slip"]
    for name in ("f_t", "mu_app", "contact_area"):
        mine, its = (each.finger.values("full_slip")[name] for each in (found, own))
        assert mine == pytest.approx(its, abs=error[name]) and error[name] < 0.05 * mine, name
    assert found.headline.of == "whole finger"


# -- refusals ------------------------------------------------------------------------------------------
def test_force_beyond_the_trace():
    """The message has how far the trace goes, in N/m and in N."""
    with pytest.raises(BeyondTrace, match=r"the force is 3 N, and .* to 150 N/m goes up to 1\.\d+ N of the whole"):
        at_force(profile(Slices(length=0.1)), kept(200.0), 3.0, 16)
    with pytest.raises(BeyondTrace, match="indented by 0.00196 m, and the trace .* ends at 0.00099 m under 150 N/m"):
        at_indentation(profile(Slices()), kept(200.0), 2e-3, 16)
    with pytest.raises(TraceError, match="beyond the trace"):
        kept(200.0).at(np.array([2e-3]))


def test_more_contact_than_the_finger_has():
    with pytest.raises(SceneError, match=r"the finger ends at z = -0.005 m, and at an indentation .* goes beyond"):
        at_force(profile(Slices(length=10e-3)), foundation(), 20.0, 8)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        ({"height": [0, 1e-3]}, "slices.height is given without slices.z"),
        ({"z": [0, 0], "height": [0, 1e-3]}, "it must grow from each place to the next"),
        ({"z": [0, 1e-3], "height": [0, 1e-3], "radius": 0.02}, "slices.radius is 0.02 and slices.height is given"),
    ],
)
def test_tables_are_refused(table, words):
    with pytest.raises(SceneError) as error:
        Scene(slices=table)
    assert words in str(error.value)


@pytest.mark.parametrize(
    ("force", "words"),
    [
        ("0.5", "it has no unit"),
        (0.0, "force is 0 N; it must be from 1e-05 to 200 N"),
        (500.0, "did you mean 0.5?"),
    ],
)
def test_forces_are_refused(force, words):
    with pytest.raises(SceneError) as error:
        Scene(force=force)
    assert words in str(error.value)
