"""Keys of a scene by a table of measurements: estimation on known models, the closed form, refusals, the command."""

import math
import re

import numpy as np
import pandas as pd
import pytest
from scipy.stats import binom

import fingerpad as fp
from benchmarks import calibrate as study
from fingerpad.cli import main
from fingerpad.measurements import calibrate as module
from fingerpad.measurements.estimation import Data, estimate
from fingerpad.measurements.table import observations
from tests.commands import refused

SCENE = fp.Scene(force=0.5)
KEYS = {"friction": 0.31, "roughness.h_rms": 3.5e-6}
GRID = study.grid((0.2, 0.8), (0.0, 100.0, 200.0))


def table(values=KEYS, noise=0.0, quantities=study.QUANTITIES, seed=1, scene=SCENE, grid=GRID, **more):
    """Return a table of the closed form at values of keys."""
    rng = np.random.default_rng(seed)
    return study.table(fp.scene.with_values(scene, values), grid, quantities, noise, rng, **more)


# -- estimation ------------------------------------------------------------------------------------------------------
def data(y, people=(), spread=None, width=1e3):
    """Return rows of a model of two parameters with no bounds that act."""
    far = np.full(2, 50.0)
    rows = people or [np.arange(len(y))]
    return Data(y, np.ones(len(y)) if spread is None else spread, spread is not None, rows, 0 * far, width, (-far, far))


def decay(x):
    """Return the logarithm of a decay over time, with a floor: not linear in its parameters."""
    return np.log(np.exp(x[0]) * np.exp(-np.exp(x[1]) * np.linspace(0, 3, 12)) + 0.2)


@pytest.mark.parametrize("known", [False, True])
def test_regions_cover(known):
    """The 95 % regions contain 95 % of the true values: of 200 tables a number that a fair coin of 0.95 has, 1 in 1000.

    Of each parameter, with a spread that is given and with one that is estimated from twelve rows.
    """
    truth, inside = np.array([0.3, -0.2]), np.zeros(2)
    for seed in range(200):
        y = decay(truth) + 0.03 * np.random.default_rng(seed).normal(size=12)
        found = estimate(decay, np.zeros(2), data(y, spread=np.full(12, 0.03) if known else None))
        error = found.quantile * np.sqrt(np.diag(found.covariance))
        inside += abs(found.theta - truth) <= error
    low, high = binom.ppf([5e-4, 1 - 5e-4], 200, 0.95)
    assert np.all((low <= inside) & (inside <= high)), inside


def test_spread_between_people_is_that_of_the_analysis_of_variance():
    """Of means alone with as many rows of each person the restricted likelihood has a closed form, to roundoff.

    The variance of rows is the mean square within, and that between people (MS between - MS within) / rows of each.
    """
    rng, rows = np.random.default_rng(3), 5
    y = (rng.normal(size=(8, 1)) + 0.3 * rng.normal(size=(8, rows))).ravel()
    people = [np.arange(rows) + rows * k for k in range(8)]
    far = np.array([50.0])
    found = estimate(
        lambda x: np.full(len(y), x[0]), np.zeros(1), Data(y, np.ones(40), False, people, 0 * far, 1e4, (-far, far))
    )
    groups = y.reshape(8, rows)
    within = groups.var(axis=1, ddof=1).mean()
    between = rows * groups.mean(axis=1).var(ddof=1)
    assert found.sigma**2 == pytest.approx(within, rel=1e-3)
    assert found.omega[0] ** 2 == pytest.approx((between - within) / rows, rel=1e-3)
    assert found.theta[0] == pytest.approx(y.mean(), abs=1e-4)


def test_criterion_of_a_straight_line():
    """AICc of a line by least squares: n ln(RSS/n) + n (1 + ln 2 pi) + 2 K n / (n - K - 1), with K = 3."""
    x = np.linspace(0, 1, 9)
    y = 1 + 2 * x + 0.1 * np.random.default_rng(1).normal(size=9)
    found = estimate(lambda p: p[0] + p[1] * x, np.zeros(2), data(y))
    residual = y - np.polyval(np.polyfit(x, y, 1), x)
    wanted = 9 * math.log(float(residual @ residual) / 9) + 9 * (1 + math.log(2 * math.pi)) + 6 * 9 / 5
    assert found.criterion == pytest.approx(wanted, abs=1e-3)
    assert found.quantile == pytest.approx(2.365, abs=1e-3)  # Student's table, seven degrees of freedom


# -- the closed form -------------------------------------------------------------------------------------------------
def test_rows_are_those_of_a_run():
    """Of each quantity, to the tolerance with which a force is found; the trace of one row is that of a run."""
    heads = ["friction (1)", "friction force (N)", "gross area (m^2)", "contact area (m^2)", "share (1)", "depth (m)"]
    found = table(quantities=[*heads, "air gap (m)"], grid=[(0.4, 120.0)]).iloc[0]
    run = fp.run(fp.scene.with_values(SCENE, {**KEYS, "force": 0.4, "voltage": 120.0}), model="cylinders")
    of = run.finger.full_slip
    wanted = [of.mu_app, of.f_t, of.gross_area, of.contact_area, of.contact_area / of.gross_area, of.indentation]
    assert [found[head] for head in heads] == pytest.approx(wanted, rel=1e-7)
    assert found["air gap (m)"] == pytest.approx(run.record["full_slip_d_eq"], rel=1e-3)  # interpolated in the trace


def test_voltages_together_are_those_one_at_a_time():
    """Traces of several voltages are computed at once; each is that of a table of its voltage alone, to roundoff."""
    scene = fp.Scene(finger="fitted", force=0.5)
    each = [table({}, grid=study.grid((0.2, 0.8), (volts,)), scene=scene) for volts in (0.0, 100.0, 200.0)]
    one = pd.concat(each).sort_values(["force (N)", "voltage (V)"]).to_numpy()
    assert table({}, scene=scene).to_numpy() == pytest.approx(one, rel=1e-7)


def test_five_keys_are_found_without_noise():
    """Within 1 %, the claim, from starts that are a third to half away."""
    rows = study.table(
        fp.scene.with_values(study.SCENE, study.TRUTH), GRID, study.QUANTITIES, 0.0, np.random.default_rng(0)
    )
    found = fp.calibrate(rows, study.SCENE, list(study.TRUTH), out=None, evidence=False)
    assert found.values.value.to_dict() == pytest.approx(study.TRUTH, rel=0.01)


def test_layer_is_found_by_presses_about_the_finger(monkeypatch):
    """Presses that are power laws of a modulus, from a start that is 40 % off; the other key is found with it.

    Rows are power laws of the key about the fitted finger only: 1 % is left where it was moved by as much.
    """
    of = module.prediction.cylinders.press.of

    def pressed(scene):
        softer = scene.materials.subcutis.shear_modulus / 25e3
        whole = of(SCENE)
        changed = {
            name: {state: [x * softer**power for x in each] for state, each in getattr(whole, name).items()}
            for name, power in (("lengths", -0.1), ("indentations", -0.3))
        }
        return module.replace(whole, **changed)

    monkeypatch.setattr(module.prediction.cylinders.press, "of", pressed)
    monkeypatch.setattr(type(module.prediction.MODEL), "check", lambda *_: None)
    truth = {"materials.subcutis.shear_modulus": 15e3, "friction": 0.3}
    rows = table(truth, quantities=["friction force (N)", "gross area (m^2)", "depth (m)"])
    found = fp.calibrate(rows, SCENE, list(truth), out=None, evidence=False)
    assert found.values.value.to_dict() == pytest.approx(truth, rel=0.01)


@pytest.mark.parametrize("law", study.LAWS)
def test_law_that_made_a_table_is_chosen(law):
    """Coulomb's law and a constant shear stress differ in the power of the force, by far more than 3 %."""
    rows = table({}, 0.03, study.QUANTITIES[:1], scene=fp.Scene(force=0.5, **study.LAWS[law]))
    found = fp.calibrate(rows, SCENE, ["friction"], out=None).evidence
    assert set(found[found.kind == "friction law"].name) == {*study.LAWS, "both"} and len(found) == 8
    laws = found.set_index("name").AICc[list(study.LAWS)]
    assert laws.idxmin() == law and laws.max() - laws.min() > 6


def test_keys_that_act_as_one_are_named():
    """The two permittivities of a coating and its thickness act by their ratio alone: a factor of nothing is known."""
    found = fp.calibrate(
        table(noise=0.01), SCENE, ["friction", "electric.d_i", "electric.eps_i"], out=None, evidence=False
    )
    (tie,) = found.ties
    assert re.match(r"The table cannot tell apart electric.d_i and electric.eps_i: electric.\w+(\^1)? × ", tie)
    assert found.correlation.loc["electric.d_i", "electric.eps_i"] > 0.95
    assert "not known" in tie and tie in str(found)


@pytest.fixture(scope="module")
def people():
    """A table of six participants, whose friction differs by 40 %."""
    frames = [
        table(KEYS | {"friction": 0.31 * factor}, 0.03, study.QUANTITIES[:1], seed=k, participant=f"P{k}")
        for k, factor in enumerate((0.6, 0.8, 1.0, 1.1, 1.3, 1.6))
    ]
    return pd.concat(frames, ignore_index=True)


def test_participant_that_is_held_out_is_predicted(people):
    """Within a band that has the spread between the others, of which theirs alone, of 3 %, has nothing."""
    found = fp.calibrate(people, SCENE, list(KEYS), hold_out={"participant": "P1"}, out=None, evidence=False)
    held, own = found.rows[found.rows.held_out], found.rows[~found.rows.held_out]
    assert len(held) == 6 and held.measured.between(held.low, held.high).all()
    assert own.measured.between(own.low, own.high).mean() > 0.9
    assert np.log(held.high / held.low).min() > 5 * np.log(own.high / own.low).max()
    assert found.values.spread["friction"] == pytest.approx(0.35, abs=0.15)  # of five, of whom it is 0.37


# -- tables and refusals -----------------------------------------------------------------------------------------------
def test_cells_of_several_quantities(tmp_path):
    """Empty cells are no rows; a spread is of its quantity or of all others; volts peak to peak are those of a sine."""
    file = tmp_path / "mine.csv"
    file.write_text(
        "participant,Fn,voltage (Vpp),friction force (mN),friction force spread (mN),gross area (mm^2),spread (%)\n"
        "a,0.5,200,142,7.1,93,10\nb,0.5,0,,,104,20\n"
    )
    rows = observations(file, {"Fn": "force (N)"}).rows
    assert list(rows.quantity) == ["friction force", "gross area", "gross area"] and list(rows.line) == [2, 2, 3]
    assert list(rows.measured) == pytest.approx([0.142, 93e-6, 104e-6])
    assert list(rows.spread) == pytest.approx([0.05, 0.1, 0.2])
    assert rows.voltage[0] == pytest.approx(200 / 8**0.5) and list(rows.participant) == ["a", "a", "b"]


HEAD = "force (N),voltage (V),friction (1)"
ROWS = ["0.2,0,0.3", "0.4,0,0.3", "0.2,150,0.5", "0.4,150,0.45"]


@pytest.mark.parametrize(
    ("head", "rows", "options", "words"),
    [
        (HEAD, ROWS[:1], "--fit friction roughness.h_rms", "has 1 value to fit and fit has 2 keys"),
        (HEAD, ROWS[2:], "--fit friction electric.d_i", "all values of .* are at 150 V, and electric.d_i acts by"),
        (HEAD, ROWS[:2], "--fit friction slices.radius", "slices.radius has no effect on any row"),
        (HEAD.replace(" (V)", ""), ROWS, "--fit friction", "has 'voltage' without a unit"),
        (HEAD + ",room", [f"{row},21" for row in ROWS], "--fit friction", "the column 'room', whose meaning is not"),
        (HEAD, ROWS, "", "fit has no key"),
        (HEAD, ROWS, "--fit friction friction", "fit has friction twice"),
        (HEAD, ROWS, "--fit roughness", "fit has roughness; it must be a number of the finger"),
        (HEAD, ROWS, "--fit friction.tau_0", "friction.tau_0 is not a key of friction with the law Coulomb"),
        (HEAD, ROWS, "--fit rughness.h_rms", "did you mean roughness"),
        (HEAD, ROWS, "--fit voltage", "fit has voltage; it must be a number of the finger"),
        (HEAD, ROWS, "--fit slices.tilt", "slices.tilt, and it is 0 in the scene; give it a start above 0"),
        (HEAD, ROWS, "--fit friction --hold-out participant=7", "hold_out has participant '7', which no row of"),
        (HEAD, ROWS, "--fit friction --hold-out 7", "--hold-out is 7; write it as"),
        (HEAD + ",spread (%)", [f"{ROWS[0]},3", f"{ROWS[1]},"], "--fit friction", "no spread above 0 in line 3"),
    ],
)
def test_refusals(head, rows, options, words, tmp_path, capsys):
    """Each in one sentence that names the place."""
    file = tmp_path / "mine.csv"
    file.write_text("\n".join([head, *rows]) + "\n")
    found = refused(capsys, "calibrate", str(file), *options.split(), "--out", str(tmp_path / "out"))
    assert re.search(words, found) and not (tmp_path / "out").exists()


# -- the command -------------------------------------------------------------------------------------------------------
def test_command_writes_scene_rows_and_report(people, tmp_path, capsys, monkeypatch):
    """Full runs are at the ends and the middle of the rows; here they are of the closed form, on other traces.

    The scene that is written is the fitted one. A full run that fails is an exit code of 1.
    """
    file, out, scenes = tmp_path / "people.csv", tmp_path / "out", {}
    people.to_csv(file, index=False)

    def sweep(found, *_, **__):
        scenes.update({module.batch.key(scene): scene for scene in found.values()})
        return {name: {"mu_app": 1.0} if not failing else {"failure": "no room"} for name in found}

    failing = False
    monkeypatch.setattr(module.batch, "sweep", sweep)
    monkeypatch.setattr(module.Result, "load", lambda place: fp.run(scenes[place.name], model="cylinders"))
    command = ["calibrate", str(file), "--fit", *KEYS, "--hold-out", "participant=P1", "--out", str(out)]
    assert main(command) == 0
    text = capsys.readouterr().out
    assert "Held out: 6 of 6 values in their 95 % band" in text and "Fitted to 30 values of 5 participants" in text
    assert len(re.findall(r"N, \d+ V .*[+-]0\.[0-3] %", text)) == 3
    assert {(scene.force, scene.volts) for scene in scenes.values()} == {(0.2, 0.0), (0.2, 200.0), (0.8, 200.0)}
    rows = pd.read_csv(out / "rows.csv")
    assert len(rows) == 36 and rows.held_out.sum() == 6
    page = (out / "report.html").read_text(encoding="utf-8")
    assert page.count("<circle") == 36 and "200 V held out" in page and "boundary elements" in page
    kept = fp.Scene.load(out / "scene.toml")
    value = float(re.search(r"friction +([\d.]+) ", text)[1])
    assert kept.friction == pytest.approx(value, rel=1e-3) and kept.roughness.h_rms != SCENE.roughness.h_rms
    failing = True
    assert main([*command, "--quiet"]) == 1 and "Full run failed at 0.2 N, 0 V: no room." in capsys.readouterr().out
