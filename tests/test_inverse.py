"""The key at which a quantity has a target, and refusals of impossible targets."""

import math

import numpy as np
import pytest

import fingerpad as fp
from fingerpad.cli import main
from fingerpad.runs.roots import Roots, newton
from fingerpad.scene import from_data
from fingerpad.scene.messages import SceneError
from tests.commands import refused
from tests.small_finger import NINE


# -- roots -----------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(("target", "roots"), [(0.25, [0.5, 1.5]), (0.01, [0.9, 1.1]), (1.0, [0.0, 2.0])])
def test_all_roots_of_a_parabola_are_found(target, roots):
    """A pair in one interval, a pair in several, and a pair at the ends. Tolerance: that of Brent's method."""
    assert Roots(lambda x: (x - 1) ** 2, 0.0, 2.0, target).find() == pytest.approx(roots, abs=1e-5)


def test_jump_is_no_root():
    search = Roots(lambda x: x + 5 * (x > 0.3), 0.0, 1.0, 3.0)
    assert search.find() == [] and search.jumps == pytest.approx([0.3], abs=1e-5)


def test_range_ends_where_answers_end():
    """A root between the last grid point with an answer and the first without one is found."""

    def function(x):
        if x > 0.93:
            raise SceneError("too far")
        return x

    search = Roots(function, 0.0, 1.0, 0.92)
    assert search.find() == pytest.approx([0.92], abs=1e-5)
    assert max(search.values) <= 0.93 < min(search.refusals)


# -- on the closed form ----------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("target", "over", "wanted"),
    [
        ({"mu_app": 2.0, "relative": True}, "f_ext", 0.5),
        ({"f_t": "30 N/m"}, "voltage", 30.0),
        ({"contact_length": "1.4 mm"}, "electric.d_i", 1.4e-3),
    ],
)
def test_section_has_the_target_at_the_key(target, over, wanted):
    """The model, run at the key that was found. Tolerance: of the key, 1e-6 of its range."""
    (root,) = fp.solve(over=over, **target).roots
    found = getattr(fp.run(root.scene, model="cylinders").full_slip, next(iter(target)))
    assert found == pytest.approx(wanted, rel=2e-5) and root.numbers[0].value == pytest.approx(wanted, rel=2e-5)


@pytest.mark.parametrize(
    ("target", "over", "force", "wanted"),
    [
        ({"f_t": "300 mN"}, "voltage", 0.5, 0.3),
        ({"f_t": 0.3}, "force", None, 0.3),
        ({"mu_app": 2, "relative": True}, "voltage", None, 0.5),
        ({"mu_app": 0.4}, "roughness.h_rms", None, 0.4),
    ],
)
def test_whole_finger_has_the_target_at_the_key(target, over, force, wanted):
    """The number is that of a run. Tolerance of the root: the search's."""
    (root,) = fp.solve(fp.Scene(force=force) if force else None, over, **target).roots
    totals = fp.run(root.scene, model="cylinders").finger.values("full_slip")
    assert totals[next(iter(target))] == root.numbers[0].value
    assert root.numbers[0].value == pytest.approx(wanted, rel=2e-5)


def test_friction_is_of_the_whole_finger():
    """As in the headline of a result, with or without a force; over f_ext it is that of the middle section."""
    finger, without, section = (
        fp.solve(scene, over, mu_app=0.5)
        for scene, over in ((fp.Scene(force=0.5), "voltage"), (None, "voltage"), (None, "f_ext"))
    )
    assert "µ_app of the whole finger at full slip" in str(finger) and "No force is given" not in str(finger)
    assert "No force is given. It is 0.5" in str(without)
    slid = fp.run(without.scene, model="cylinders").full_slip
    assert slid.f_ext == pytest.approx(75.0, rel=3e-3)  # at the centre, at another voltage
    assert without.values == pytest.approx(fp.solve(without.scene, mu_app=0.5).values, rel=1e-12)
    assert "µ_app of the middle section at full slip" in str(section) and "vary force for it" in str(section)


def test_drive_is_varied_by_its_amplitude():
    """A lossless sine attracts as its effective value does; a constant voltage in its place would have no losses."""
    sine = fp.Scene(voltage={"waveform": "sine", "amplitude": 100.0, "frequency": 1e3})
    (amplitude,) = fp.solve(sine, "voltage.amplitude", mu_app=0.5).values
    (voltage,) = fp.solve(mu_app=0.5).values
    assert amplitude / 2**0.5 == pytest.approx(voltage, rel=1e-4)
    with pytest.raises(SceneError, match="voltage is a drive and over is voltage; give one of its keys"):
        fp.solve(sine, mu_app=0.5)


def test_all_values_are_found():
    """The sign of a voltage changes no force."""
    low, high = fp.solve(mu_app=0.5, between=("-0.3 kV", 300)).values
    assert low == pytest.approx(-high, rel=1e-5) and high > 100


@pytest.mark.parametrize(
    ("name", "value", "over", "relative"), [("mu_app", 2.0, "voltage", True), ("f_t", 30.0, "f_ext", False)]
)
def test_margin_is_the_error_of_the_model_over_the_slope(name, value, over, relative):
    """Two targets that differ by the error have keys that differ by the margin. Tolerance: the curvature."""

    def root(factor):
        return fp.solve(over=over, relative=relative, **{name: value * factor}).roots[0]

    found = root(1.0)
    error = found.numbers[0].error / found.numbers[0].value
    assert (root(1 + error).keys[0] - root(1 - error).keys[0]) / 2 == pytest.approx(found.margins[0], rel=1e-2)


def test_margin_is_not_known_elsewhere():
    (other,) = fp.solve(over="electric.d_i", mu_app=1.1, relative=True).roots
    assert math.isnan(other.margins[0]), "no full run has such a thick coating"


# -- the command -----------------------------------------------------------------------------------------------------
def test_command_prints_the_key(capsys):
    words = ["--target=mu_app=1.1", "--relative", "--over=electric.d_i", "--from=1 um", "--to=0.1 mm"]
    assert main(["solve", *words]) == 0
    (d_i,) = fp.solve(over="electric.d_i", mu_app=1.1, relative=True, between=(1e-6, 1e-4)).values
    assert f"electric.d_i = {1e6 * d_i:.4g} µm" in capsys.readouterr().out


@pytest.mark.parametrize(
    ("words", "said"),
    [
        ([], "no target is given; give a quantity and its value"),
        (["--target=mu_app=2", "--target=f_t=3 N/m"], "2 targets are given over voltage; give as many as keys"),
        (
            ["--target=mu_app=2", "--target=f_t=3 N/m", *["--over=voltage"] * 2],
            "voltage is varied, and is given o",
        ),
        (["--target=f_t=3", "--at=voltage=0,1", "--over=friction"], "at voltage is [0, 1]; it must have one value for"),
        (
            ["--target=mu_app=2", "--target=f_t=3 N", "--over=friction", "--over=mesh.contact"],
            "mesh.contact has no",
        ),
        (["--target=mu=2"], "mu is not a quantity of a target; it must be one of mu_app,"),
        (["--target=f_t=0.3 V"], "target f_t is '0.3 V'; its unit is not a unit of force"),
        (["--target=f_t=0.3 N", "--over=f_ext"], "F_T is of the whole finger and over is f_ext; give force"),
        (["--target=contact_length=1 mm", "--set=force=0.5"], "L_R is of the section and force is given; give f_ext"),
        (["--target=mu_app=2", "--relative", "--set=friction=0"], "the whole finger has no full slip with friction"),
        (["--target=mu_app=2", "--over=contact.formulation"], "over is contact.formulation; it must be a key of one"),
        (["--target=mu_app=2", "--over=voltage.rms"], "voltage.rms has no value in the scene to vary around"),
        (["--target=mu_app=2", "--over=mesh.contact"], "mu_app does not depend on mesh.contact here"),
        (["--target=mu_app=2", "--from=9"], "one of --from and --to is given without the other"),
        (["--target=mu_app=2", "--from=9", "--to=8"], "the range of voltage is 9 to 8; the last value"),
        (["--target=mu_app=0.1"], "at voltage 0 to 400 V mu_app is 0.25 to"),
        (["--target=mu_app=9999", "--relative", "--to=5000", "--from=0"], "is not reached; at 3008 V there is no"),
    ],
)
def test_impossible_target_is_refused_in_one_sentence(words, said, capsys):
    assert said in refused(capsys, "solve", *words)


# -- several keys, and Newton's method ---------------------------------------------------------------------------------
def curved(x):
    """Two functions with roots at (0.3, 0.6) and (0.64, 0.28), and their slopes."""
    a, b = x
    return np.array([a**2 + b - 0.69, a * b - 0.18]), np.array([[2 * a, 1.0], [b, a]])


@pytest.mark.parametrize(("known", "most"), [(1.0, 5), (np.array([[1.0, 1.0], [math.nan] * 2]), 8), (math.nan, 11)])
def test_newton_needs_few_states(known, most):
    """With all slopes, those of one function, and none: of the first two 1e-4 in few states more."""
    counts = []

    def state(x):
        counts.append(x)
        off, slopes = curved(x)
        return off, slopes * known

    place, _, why = newton(state, np.array([0.6, 0.4]), np.full((2, 2), math.nan), ("a", "b"))
    assert np.abs(curved(place)[0]).max() <= 1e-4 and not why and len(counts) <= most


@pytest.mark.parametrize(
    ("function", "words"),
    [
        (lambda x: (x - 1.5, np.ones((1, 1))), "the range of a ends there"),
        (lambda x: (x - 0.3 + np.where(x > 0.3, 0.1, -0.17), np.ones((1, 1))), "states beside it are further away"),
    ],
)
def test_target_that_is_not_met_leaves_the_nearest_state(function, words):
    """Beyond the range, and in a jump."""
    place, _, why = newton(function, np.array([0.5]), np.ones((1, 1)), ("a",))
    assert words in why and np.abs(function(place)[0]) <= 0.5


@pytest.mark.parametrize(
    ("slopes", "words"), [([[1, 0], [2, 0]], "b has no effect here: its slope is 0"), ([[1, 2], [2, 4]], "a and b act")]
)
def test_keys_that_do_not_tell_targets_apart_are_refused(slopes, words):
    with pytest.raises(SceneError, match=words):
        newton(lambda x: (np.ones(2), np.array(slopes, float)), np.zeros(2), np.zeros((2, 2)), ("a", "b"))


def test_command_finds_two_keys_for_two_voltages(capsys):
    """Friction without a voltage is that of the law; with one the coating decides. The runs there have the targets."""
    words = ["--target=f_t=0.1 N", "--target=f_t=0.2 N", "--at=voltage=0,200", "--over=friction", "--over=electric.d_i"]
    assert main(["solve", *words, "--set=force=0.5"]) == 0
    keys, targets, at = ("friction", "electric.d_i"), ("0.1 N", "0.2 N"), {"voltage": (0, 200)}
    found = fp.solve(fp.Scene(force=0.5), keys, f_t=targets, at=at)
    assert str(found) in capsys.readouterr().out
    for voltage, f_t in zip(at["voltage"], (0.1, 0.2), strict=True):
        totals = fp.run(found.roots[0].scene, voltage=voltage, model="cylinders").finger.values("full_slip")
        assert totals["f_t"] == pytest.approx(f_t, rel=1e-4)


LEAN = NINE | {"f_ext": 1.0, "voltage": 100.0, "output": {"errors": False, "receptors": False}}


@pytest.mark.slow
@pytest.mark.parametrize(
    ("over", "target", "states"),
    [
        ("voltage", {"mu_app": 0.68}, 3),
        ("electric.d_i", {"mu_app": 2.9, "relative": True}, 4),  # one of them without voltage
        (("friction", "electric.d_i"), {"mu_app": (0.26, 0.75), "at": {"voltage": (0, 100)}}, 6),
    ],
)
def test_full_model_meets_targets_in_three_states(over, target, states):
    """To 1e-4, from the scene's own values, since a small finger has no closed form. A run there has the number."""
    found = fp.solve(from_data(LEAN), over, model="full", **target)
    (root,) = found.roots
    assert len(found.states) <= states and f"{len(found.states)} states of the full model" in str(found)
    wanted = np.atleast_1d(target["mu_app"]) * (0.25 if "relative" in target else 1.0)
    assert [number.value for number in root.numbers] == pytest.approx(wanted, rel=1e-4)
    assert fp.run(root.scene).full_slip.mu_app == pytest.approx(wanted[-1], rel=1e-4)


@pytest.mark.slow
def test_target_out_of_reach_keeps_the_nearest_state():
    """At the end of the range, with a warning that says so."""
    with pytest.warns(UserWarning, match="at voltage 105 V mu_app is 0.7.*; the range of voltage ends there"):
        found = fp.solve(from_data(LEAN), between=(95, 105), model="full", mu_app=0.9)
    assert found.values == [105.0] and "! Targets are not met" in str(found)
