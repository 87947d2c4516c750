"""Breakdown of air by the field in the gap of each ridge, in states of the full model."""

from dataclasses import replace

import numpy as np
import pytest

import fingerpad as fp
from fingerpad.cli import main
from fingerpad.model.cautions import examine
from tests.small_finger import NINE
from variational.state import ContactState, RidgeStates

SINE = {"waveform": "sine", "amplitude": 400.0, "frequency": 100.0}
DRY = {"tissue": "dry", "leak": 300.0}
H_0 = fp.Scene().h_0
OUTPUT = {"receptors": False, "errors": False}


def state(voltage, gaps=(1.5e-6, 1.7e-6), length=(1e-4, 1e-4), **more) -> ContactState:
    """Return a state of ridges 0, 1 and so on."""
    zero = np.zeros(len(gaps))
    ridges = RidgeStates(np.arange(len(gaps)), np.array(length), zero, zero, zero, zero, np.array(gaps))
    given = {"step": 7, "load": "slide", "load_number": 3} | more
    return ContactState(
        f_ext=1.0, voltage=voltage, f_t=0.0, mu_app=0.0, f_contact=1.0, f_electrostatic=0.0, ridges_in_contact=2,
        contact_length=2e-4, ridges=ridges, **given,
    )  # fmt: skip


def in_states(scene, states) -> list[str]:
    return [str(each) for each in examine("gap", scene, states)]


def test_ridge_is_named_whose_gap_is_the_farthest_beyond():
    """Of 440 V, 440 * 1.7 / (1.7 + h_0) lie across the wider gap; of a ridge above the screen nothing is said."""
    across = 440 * 1.7e-6 / (1.7e-6 + H_0)
    (found,) = in_states(fp.Scene(), [state(300.0), state(-440.0), state(0.0)])
    words = "V are across a gap of 1.7 µm in ridge 1 in 'slide', step 7, and from 330 V on"
    assert found.startswith(f"{across:.4g} {words}")
    assert in_states(fp.Scene(), [state(440.0, length=(1e-4, 0.0))]) == []
    assert in_states(fp.Scene(), [replace(state(440.0), ridges=None)]) == []


def test_narrow_gaps_break_down_by_the_field():
    """At 350 V/µm: 0.2 µm bear 70 V, and 250 V put 70.0 V there where h_0 is 0.514 µm."""
    volts = 70.0 * (0.2e-6 + H_0) / 0.2e-6
    gaps = (0.2e-6, 1.5e-6)
    assert in_states(fp.Scene(), [state(0.999 * volts, gaps)]) == []
    (found,) = in_states(fp.Scene(), [state(1.001 * volts, gaps)])
    assert "across a gap of 0.2 µm in ridge 0 in" in found and "from 70 V on" in found


@pytest.mark.parametrize(
    ("drive", "electric"),
    [(SINE, DRY), (SINE, {"follows": "mean"}), (SINE | {"carrier": {"frequency": 5e3}}, DRY)],
    ids=["losses", "mean", "carrier"],
)
def test_period_counts_where_states_have_a_mean(drive, electric):
    """The mean attraction is that of some 280 V and 160 V, and the peaks of 500 V are beyond breakdown."""
    drive = drive | {"amplitude": 500.0}
    scene = fp.Scene(voltage=drive, electric=electric)
    (found,) = in_states(scene, [state(scene.volts)])
    peak = float(np.abs(scene.drive.across(1.7e-6)).max())
    assert found.startswith(f"{peak:.4g} V are across a gap of 1.7 µm in ridge 1") and "start of a period" in found
    assert in_states(fp.Scene(voltage=scene.volts), [state(scene.volts)]) == []
    if "follows" in electric:
        timed = fp.Scene(
            history=[{"name": "press", "f_ext": 1.0}, {"name": "wave", "voltage": drive, "duration": 0.1}],
            electric=electric,
        )
        assert in_states(timed, [state(scene.volts, load="wave", load_number=2)]) == [
            found.replace("'slide'", "'wave'")
        ]


@pytest.mark.parametrize(
    ("scene", "volts"),
    [
        (fp.Scene(voltage=5000.0), 5000.0),
        (fp.Scene(voltage={"waveform": "sine", "rms": 1000.0, "frequency": 1e3}), 1414.2),
        (fp.Scene(history=[{"name": "press", "f_ext": 10.0}, {"name": "charge", "voltage": -600.0}]), 600.0),
    ],
    ids=["constant", "drive", "history"],
)
def test_before_a_run(scene, volts):
    """The peak over gap and insulators, by Eq. 3 in the gap of a ridge under 10 kPa; four digits are printed."""
    gap = float(scene.closure()(1e4).d_eq)
    (found,) = map(str, examine("load", scene))
    assert float(found.partition(" V ")[0]) == pytest.approx(volts * gap / (gap + H_0), rel=5e-4)
    assert "in a ridge under 10 kPa" in found and "from 330 V on air breaks down there" in found


def test_estimate_names_breakdown_where_it_has_no_friction(capsys):
    main(["estimate", "--force", "0.5 N", "--set", "voltage=5000"])
    assert "from 330 V on air breaks down there" in capsys.readouterr().err


def test_run_tells_before_it_computes(monkeypatch):
    """A warning in Python, before anything is solved."""

    class Solved(Exception):
        pass

    def solve(*_):
        raise Solved

    monkeypatch.setattr("fingerpad.runs.solve.solved", solve)
    with pytest.warns(UserWarning, match="from 330 V on air breaks down"), pytest.raises(Solved):
        fp.run(fp.Scene(voltage=5000.0))


# -- losses in newtons and in direct states ----------------------------------------------------------------


@pytest.mark.slow
def test_direct_states_have_the_share_of_each_ridge(tmp_path):
    """From one frequency to another, where the share is another one, to the states at the ends of paths."""
    scene = fp.Scene(**NINE, f_ext=1.0, output=OUTPUT, voltage=SINE | {"amplitude": 150.0}, electric=DRY)
    frequencies = {"voltage.frequency": [15.0, 100.0]}
    paths = fp.sweep(scene, tmp_path / "paths", quiet=True, **frequencies)
    direct = fp.sweep(scene, tmp_path / "direct", states="full_slip", quiet=True, **frequencies)
    assert sorted(result.full_slip.reached.partition(" ")[0] for result in direct) == ["full", "path"]
    assert direct.array("f_t") == pytest.approx(paths.array("f_t"), rel=1e-6)
