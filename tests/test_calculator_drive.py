"""The calculator's page with a drive in place of a voltage: the numbers of Python."""

import json

import pytest

import fingerpad as fp
from fingerpad.calculator.page import page
from fingerpad.scene import Scene
from tests.browser import asked
from tests.test_calculator import FIELDS, SET, by_script, in_si


@pytest.mark.parametrize("force", [None, 0.5], ids=["section", "whole finger"])
def test_drive_is_that_of_python(force, tmp_path):
    """Mean, extremes and amplitudes within 1 % of the mean: the page has a quarter of the samples, and fewer gaps."""
    default = in_si({key: field.value for key, field in FIELDS.items()})
    cases = [("sine", 30.0, 50.0, "lossless"), ("square", 30.0, 50.0, "sliding dry"), ("triangle", 250.0, 0.0, "moist")]
    names = ("waveform", "frequency", "offset", "circuit")
    asked_for = [dict(zip(names, case, strict=True)) for case in cases]
    values = default | {"voltage": 150.0, "newtons": force is not None} | ({} if force is None else {"force": force})
    program = f"""const p = {json.dumps(values)};
    const answer = (here) => (p.newtons ? closedForm.whole(here) : closedForm.solve(here));
    console.log(JSON.stringify({json.dumps(asked_for)}.map((asked) => {{
      const {{ tissue, leak }} = data.circuits[asked.circuit];
      const found = drive.over_period(p, asked, tissue && {{ tissue, leak }}, answer);
      return [found.mean, found.low, found.high, found.amplitudes[1], found.amplitudes[2]];
    }})));"""
    for asked_one, found in zip(asked_for, by_script(program, tmp_path), strict=True):
        circuit = asked_one["circuit"]
        wave = {"waveform": asked_one["waveform"], "amplitude": 150.0, "offset": asked_one["offset"]}
        tissue = {"lossless": "lossless", "sliding dry": "dry", "moist": "moist"}[str(circuit)]
        electric = {"tissue": tissue, "leak": "none" if circuit == "lossless" else circuit}
        scene = Scene(voltage=wave | {"frequency": asked_one["frequency"]}, electric=electric)
        exact = fp.drive(scene if force is None else scene.replace(force=force))
        f = float(asked_one["frequency"])
        expected = [exact.f_t.mean(), exact.f_t.min(), exact.f_t.max(), exact.at(f), exact.at(2 * f)]
        assert found == pytest.approx(expected, abs=1e-2 * exact.f_t.mean())


def test_page_takes_a_drive(tmp_path):
    """It draws voltage, attraction and friction, and refuses a frequency beside its field."""
    program = f"""{SET}
    const find = (id) => document.getElementById(id), answers = [];
    set({{ f_ext: 75 }});
    for (const frequency of ["-5", "x"]) {{
      set({{ frequency }});
      answers.push(find("frequency_refused").textContent);
    }}
    const boxes = ["drive_u", "drive_sigma", "drive_friction"].map(find);
    const lines = boxes.map((box) => box.querySelectorAll("polyline").length);
    return [find("drive_said").textContent, lines, answers];"""
    said, lines, refused = asked(page(), program, tmp_path)
    assert "amplitude 200 V, peak to peak 400 V, rms 141.4 V" in said and lines == [1, 1, 1]
    allowed = "it must be from 0.001 to 1e+6 Hz."
    assert refused == [f"frequency is -5 Hz; {allowed}", f"frequency is x, which is no number; {allowed}"]
