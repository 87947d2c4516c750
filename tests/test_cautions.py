"""Cautions of a state are the same whatever computed it: a run, a body, a cheaper model, a table."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

import fingerpad as fp
import geometry
from benchmarks import drive
from benchmarks.harness import DOCS, kept
from fingerpad.cli import main
from fingerpad.model.cautions import examine, on_states
from fingerpad.reduced import cylinders
from fingerpad.scene import Scene, from_data
from fingerpad.scene.remarks import LEAKAGE
from tests.small_finger import small
from variational.contact.penalty import Penalty
from variational.materials.ogden import Ogden
from variational.roughness.bam import BearingArea
from variational.roughness.closure import AirGap, Closure
from variational.state import ContactState, RidgeStates, StepRecord

THICK = 50e-6 / 3.4  # h_0 of 50 um of polyimide (m)
SKIN, RIDGE = Ogden(86.76e3, -14.53, 0.48), geometry.ridge(size=30e-6)
RISES, DEEP = "d_eq rises with pressure", "deeper in the screen than a tenth of the air gap"
COARSE = {"contact": 40e-6, "receptor": 80e-6, "interface": 200e-6, "growth": 0.8}
OUTPUT = {"receptors": False, "errors": False, "each_load": False}


@dataclass(frozen=True)
class Gap(Closure):
    """A closure that holds up to a pressure."""

    gap: float = 2e-6
    limit: float = 1e5

    def __call__(self, p_c):
        return AirGap(self.gap + 0 * np.asarray(p_c, dtype=float))

    def state(self, p_c, voltage):
        return "too high" if p_c > self.limit else ""


def state(p_c=(5e4,), force=(1.0,), voltage=200.0, penetration=1e-8) -> ContactState:
    p_c, force = np.array(p_c), np.array(force)
    length = np.divide(force, p_c, out=np.zeros_like(p_c), where=p_c > 0)
    zero = np.zeros_like(p_c)
    ridges = RidgeStates(np.arange(len(p_c)), length, force, zero, zero, p_c, zero)
    record = StepRecord(penetration, *[0] * 11)
    return ContactState(
        f_ext=1.0, voltage=voltage, f_t=0.0, mu_app=0.0, f_contact=float(force.sum()), f_electrostatic=0.0,
        ridges_in_contact=len(p_c), contact_length=float(length.sum()), ridges=ridges, record=record,
    )  # fmt: skip


def on(*states, closure=Gap()) -> list[str]:  # noqa: B008
    return [str(each) for each in on_states(states, closure)]


def examined(kind, scene) -> list[str]:
    return [str(each) for each in examine(kind, scene)]


# -- rules -------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(("share", "told"), [(0.09, False), (0.11, True)])
def test_ridges_under_a_tenth_of_the_force_are_left_out(share, told):
    """As those that come and go at the edge."""
    found = on(state((5e4, 2e5, 0.0), (1 - share, share, 0.0)))
    words = "in 1 of 1 states the closure is out of its range: the mean pressure of ridges is too high"
    assert found == ([words] if told else [])


@pytest.mark.parametrize(("penetration", "told"), [(0.19e-6, False), (0.21e-6, True)])
def test_penetration_beyond_a_tenth_of_the_air_gap(penetration, told):
    """With a voltage or without, of an air gap of 2 um."""
    for voltage in (0.0, 200.0):
        found = on(state(penetration=1e-8), state(voltage=voltage, penetration=penetration))
        assert [text.startswith(f"in 1 of 2 states the skin is {DEEP}, 0.21 µm where") for text in found] == [
            True
        ] * told


@pytest.mark.parametrize(
    ("closure", "voltage", "told"),
    [
        (fp.BoundaryElements(0.514e-6), 30.0, False),
        (fp.BoundaryElements(0.514e-6), -60.0, True),
        (fp.Persson(0.514e-6), 200.0, True),
        (fp.BoundaryElements(0.514e-6, field_in_contact=False), 200.0, False),
        (BearingArea(0.514e-6), 200.0, False),
    ],
)
def test_attraction_that_deforms(closure, voltage, told):
    """Closures with a field in contact overestimate the attraction above some 50 V; the others have none of this."""
    found = on(state(voltage=10.0), state(voltage=voltage), closure=closure)
    words = f"in 1 of 2 states the closure {type(closure).__name__} overestimates the attraction, which deforms"
    assert any(text.startswith(words) for text in found) == told


def test_figures_of_the_caution_are_those_of_the_page():
    """Overestimates of 11 % and 85 % at shares of 14 % and 50 %, by the kept contacts of the page."""
    rows = kept("microscale", DOCS).numbers["adhesive"]
    found = {}
    for row in (row for row in rows if row["in_contact"]):
        alone = row["rigid"]
        pull = 8.854e-12 * row["voltage"] ** 2 / 2 / Scene().h_0 ** 2
        share = round(100 * pull * alone["fraction"] / alone["p_c"])
        found[share] = round(100 * (alone["attraction"] / row["deforms"]["attraction"] - 1))
    assert (found[14], found[50]) == (11, 85)


def test_states_without_contact_voltage_or_closure_have_none():
    """The closure acts through a voltage alone."""
    high = {"p_c": (2e5,), "penetration": 1.0}
    assert on_states([state((0.0,), (0.0,), penetration=1.0)], Gap()) == [] == on_states([state(**high)], None)
    assert not any("out of its range" in text for text in on(state(voltage=0.0, **high)))


# -- doors -------------------------------------------------------------------------------------------------
def body(roughness, contact=Penalty(1.5e12, 5e10)) -> fp.Body:  # noqa: B008
    return fp.Body(RIDGE, SKIN, contact=contact, friction=0.25, roughness=roughness)


def test_body_with_a_thick_insulator():
    """Its air gap rises with the attraction, from 0.4 um at 500 V; a thin insulator has no caution."""
    assert body(BearingArea(0.51e-6)).press(4.4).charge(100.0).cautions == []
    pad = body(BearingArea(THICK)).press(4.4)
    assert pad.cautions == []
    (caution,) = pad.charge(500.0).cautions
    assert RISES in caution.text and (caution.code, caution.number) == ("closure_range", 2)


@pytest.mark.slow
@pytest.mark.parametrize(
    ("values", "words"),
    [({"contact": {"eps_n": 1e11}}, DEEP), ({"roughness": {"young": 3e4}}, "beyond zero separation")],
)
def test_run(values, words):
    """Springs of the screen too soft, and a roughness that the skin fills: friction is the same for any softer one."""
    history = [{"name": "press", "f_ext": 1.0}, {"name": "charge", "voltage": 20.0}]
    scene = small().replace(mesh=COARSE, output=OUTPUT, history=history, **values)
    assert sum(words in text for text in map(str, fp.run(scene).cautions)) == 1


@pytest.mark.parametrize("young", [1e5, 1e4])
def test_cylinders_and_tables(young, capsys, tmp_path):
    """Of clamped closures, whose friction is one number; a folder that is read back has the same values."""
    found = fp.run(fp.Scene(roughness={"young": young}), out=tmp_path, model="cylinders")
    assert (
        "closure_range" in {each.code for each in found.cautions}
        and fp.Result.load(tmp_path).cautions == found.cautions
    )
    assert any("beyond zero separation" in text.text for text in found.cautions)
    assert found.full_slip.mu_app == pytest.approx(0.5427, abs=1e-4)
    for command in ("estimate", "microscale"):
        assert main([command, "--set", f"roughness.young={young}"]) == 0
        assert "the closure is out of its range: the mean pressure of ridges is beyond" in capsys.readouterr().out


def test_state_without_ridges_has_their_mean():
    """Of a cheaper model, whose ridges are alike: 7 N/m on 40 um, 175 kPa."""
    whole = state((5e4, 3e5), (1.0, 6.0))
    alone = replace(whole, ridges=None, ridges_in_contact=2)
    assert [on_states([alone], Gap(limit=limit)) != [] for limit in (1.7e5, 1.8e5)] == [True, False]


# -- a real finger leaks charge --------------------------------------------------------------------------------------
PRESS = {"name": "press", "f_ext": 1.0}


def under(voltage, *before) -> Scene:
    wave = {"name": "wave", "duration": 0.1, "voltage": voltage}
    return from_data({"history": [PRESS, *before, wave]})


def sine(**keys) -> dict:
    return {"waveform": "sine", "amplitude": 120.0, "frequency": 20.0} | keys


def table(*voltages: float) -> dict:
    return {"waveform": "file", "times": [0.0, *([0.02] if len(voltages) > 2 else []), 0.1], "values": list(voltages)}


# -- what it is of -----------------------------------------------------------------------------------------
def test_constant_voltage_has_the_note_alone():
    """It may be the rms value of an alternating one: no caution, and nothing at 0 V."""
    assert examined("note", Scene()) == [LEAKAGE] and examined("scene", Scene()) == []
    assert examined("note", from_data({"voltage": 0.0})) == []


def test_note_has_what_eq_3_leaves_out():
    """In µ_app of a dry finger, by docs/drive.json, as it is printed: in whole percent."""
    found = dict(zip(drive.SHOWN, kept("drive").numbers["left_out"]["sliding dry"], strict=True))
    shown = [f"{abs(100 * found[f]):.0f} % {'high' if found[f] > 0 else 'low'} at {f / unit:g} {name}"
             for f, unit, name in ((10.0, 1, "Hz"), (1e3, 1e3, "kHz"), (1e4, 1e3, "kHz"))]  # fmt: skip
    assert f"µ_app by Eq. 3 is {shown[0]}, {shown[1]} and {shown[2]} (200 V rms, 75 N/m" in LEAKAGE


@pytest.mark.parametrize(
    ("electric", "words"),
    [
        ({"tissue": "dry"}, "After 0.1 s its attraction is 1.30 times that of Eq. 3, since the skin conducts."),
        (
            {"tissue": "dry", "leak": 300.0},
            "Charge leaks with a time constant of 12.1 ms: after 0.1 s",
        ),
    ],
)
def test_constant_voltage_in_a_circuit_has_short_sentences(electric, words):
    """1.30 is the square of (h_0 + g) / (d_i / eps_i + g): the gap of 1.6 µm behind the coating alone."""
    (note,) = examined("note", from_data({"electric": electric}))
    assert words in note and all(len(each.split()) <= 20 for each in note.replace("Eq. 3", "Eq.3").split(". "))
    h_0, coating, gap = Scene().h_0, 1e-6 / 3.9, 1.6e-6
    assert ((h_0 + gap) / (coating + gap)) ** 2 == pytest.approx(1.30, abs=5e-3)


@pytest.mark.parametrize(
    ("voltage", "mean"),
    [
        (sine(offset=200.0), 200.0),
        (sine(offset=-30.0), -30.0),
        (table(-50.0, 50.0), 0.0),
        (table(0.0, 100.0), 50.0),
        (table(100.0, 100.0, 0.0), 60.0),
        (sine(), 0.0),
        (sine(offset=1.0), 0.0),
    ],
)
def test_waveform_with_a_mean_has_a_caution_that_names_it(voltage, mean):
    """In place of the note, also where a load before is at a constant voltage."""
    scene = under(voltage, {"name": "charge", "voltage": 50.0})
    found = examined("scene", scene)
    assert [f"has a mean of {mean:g} V, which leaks away" in text for text in found] == [True] * (mean != 0)
    assert examined("note", scene)[1:] == ([] if mean else [LEAKAGE])
    assert examined("note", scene)[0].startswith("Drive history[2].voltage: ")


# -- doors -------------------------------------------------------------------------------------------------
def test_a_result_has_it_once():
    """Here the closed form."""
    found = cylinders.solve(Scene())
    assert found.notes.count(LEAKAGE) == 1 and str(found).count(LEAKAGE) == 1
    assert LEAKAGE not in str(cylinders.solve(from_data({"voltage": 0.0})))
