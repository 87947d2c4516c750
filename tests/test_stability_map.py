"""The stability map: its plan, its cache, single runs of a coarse strip, and what is drawn and written of them."""

import json
from dataclasses import asdict, replace
from functools import partial

import numpy as np
import pytest
from matplotlib.image import imread
from mpi4py import MPI

from benchmarks import stability_map
from benchmarks.stability import cache as caching
from benchmarks.stability import pictures, plan, results, table
from benchmarks.stability.cache import Cache, run_all
from benchmarks.stability.case import Case, Outcome
from benchmarks.stability.loop import loop
from benchmarks.stability.solve import make_problem, make_solver, mesh_size
from geometry import strip
from geometry.mesh import load
from geometry.parameters import Fingertip
from variational.roughness.bam import BearingArea
from variational.solvers.equations import Control

# A press of half an newton a metre on facets of 60 um: two seconds a run.
TINY = Case(contact_size=60e-6, force=0.5, voltage=50.0, element="P1", slide=0.0)
HOPELESS = replace(TINY, parameter=1.5e20)
CLOSURE = BearingArea(h_0=0.514e-6, p_floor=1.0)


@pytest.fixture(scope="module")
def chart() -> plan.Chart:
    """Two voltages and two contact sizes."""
    x = plan.Axis("voltage", "voltage (V)", (0.0, 50.0))
    y = plan.Axis("contact_size", "contact size (µm)", (60e-6, 80e-6), 1e-6)
    return plan.Chart("tiny", "Tiny", (plan.Panel("penalty", TINY, x, y),))


@pytest.fixture(scope="module")
def tiny(chart, tmp_path_factory) -> Cache:
    """The chart's runs, and one that fails."""
    cache = Cache(tmp_path_factory.mktemp("stability") / "runs.jsonl")
    assert run_all([*chart.panels[0].cases(), HOPELESS], cache, jobs=2, limit=300, hours=1) == 0
    return cache


def outcome(**values) -> Outcome:
    return Outcome("converged", **values)


# -- the plan ------------------------------------------------------------------------------------------
def test_map_is_not_too_large():
    assert len(set(plan.cases())) == len(plan.cases()) <= plan.MOST


def test_neighbours_of_the_default_are_in_the_map():
    """What the choice of the default rests on is run."""
    assert {case for _, case in plan.neighbours().cases} <= set(plan.cases())


def test_too_large_a_map_is_refused(monkeypatch):
    monkeypatch.setattr(plan, "MOST", 100)
    with pytest.raises(ValueError, match="solves; at most 100"):
        plan.cases()


@pytest.mark.parametrize(
    ("field", "low", "high"),
    [
        ("voltage", 0.0, 400.0),
        ("contact_size", 3e-6, 40e-6),
        ("parameter", 1.5e10, 1.5e15),
        ("nu", 0.3, 0.4999),
        ("force", 0.5, 30.0),
        ("step_scale", 0.25, 4.0),
    ],
)
def test_ranges(field, low, high):
    """Each parameter is varied over its whole range in some chart of the default, through it."""
    axes = [axis for chart in plan.charts() for axis in (chart.panels[0].x, chart.panels[0].y)]
    values = [axis.values for axis in axes if axis.field == field]
    assert (low, high) in {(v[0], v[-1]) for v in values}
    assert all(getattr(Case(), field) in v for v in values)


def test_default_is_the_products():
    """The map's default is what a scene has by default."""
    from fingerpad.scene import Scene

    scene, case = Scene(), plan.DEFAULT
    assert (case.parameter, case.contact_size) == (scene.contact.eps_n, scene.mesh.contact)
    assert (case.element, case.voltage, case.mu_f) == (scene.numerics.element, scene.voltage, scene.friction)
    assert case.nu == scene.materials.dermis.poisson


def test_reference_keeps_the_physics():
    """Only what is numerical is put back; a reference is its own."""
    case = Case(
        parameter=1.5e10,
        element="P1",
        contact_size=40e-6,
        step_scale=4.0,
        creep=False,
        detour=400.0,
        voltage=300.0,
        nu=0.3,
    )
    assert case.reference == Case(contact_size=1.25e-6, voltage=300.0, nu=0.3)
    assert case.reference.reference == case.reference


@pytest.mark.parametrize("field", [f for f in asdict(Case()) if isinstance(getattr(Case(), f), float)])
def test_key_tells_cases_apart(field):
    assert replace(Case(), **{field: 0.123}).key != Case().key == Case().key


# -- runs and their cache ------------------------------------------------------------------------------
def test_tiny_map_converges(tiny, chart):
    """Pressed by half a newton a metre the ridge bears it, whatever the voltage. Tolerance: the solve's."""
    for case in chart.panels[0].cases():
        found = tiny.get(case)
        assert found.status == "converged"
        assert found.f_ext == pytest.approx(0.5, rel=1e-7)
        assert found.newton >= found.steps > 1
        assert found.contact_length > 0 < found.penetration


def test_longer_steps_are_fewer(tiny, tmp_path):
    """Twice as long, of the press alone: at most half as many and one, the touch counted apart."""
    usual, longer = replace(TINY, voltage=0.0), replace(TINY, voltage=0.0, step_scale=2.0)
    cache = Cache(tmp_path / "runs.jsonl")
    run_all([longer], cache, jobs=1, limit=300, hours=1)
    touch = 1
    assert cache.get(longer).steps - touch <= (tiny.get(usual).steps - touch) / 2 + 1


def test_friction_at_full_slip(tmp_path):
    """Without voltage the screen drags with mu_0 times the force. Tolerance: the solve's."""
    case = replace(TINY, voltage=0.0, slide=1e-3)
    cache = Cache(tmp_path / "runs.jsonl")
    run_all([case], cache, jobs=1, limit=300, hours=1)
    assert cache.get(case).full_slip
    assert cache.get(case).f_t == pytest.approx(0.25 * 0.5, rel=1e-6)


@pytest.mark.parametrize("sides", ["carried", "free"])
def test_strip_off_the_screen_follows_the_bone(sides):
    """Lifted and moved sideways without touching, all of it translates alike, lateral faces included."""
    case = replace(TINY, sides=sides)
    build = partial(strip.build, Fingertip(), mesh_size(case.contact_size))
    body = load(MPI.COMM_WORLD, build, strip.LAYERS)
    problem = make_problem(case, body)
    solver = make_solver(case, body, problem)
    solver.control = Control(5e-6, 2e-6)
    solver.solve()
    np.testing.assert_allclose(problem.displacement(), [[5e-6, 2e-6]] * problem.V.dofmap.index_map.size_local)


def test_failure_is_recorded_with_its_reason(tiny):
    """A penalty 1e8 times the default leaves no digits: the run says by which name and in which load it ended."""
    found = tiny.get(HOPELESS)
    assert found.status == "failed"
    assert found.reason.startswith("DIVERGED_")
    assert found.reason in found.message
    assert found.load == "press"
    assert found.cutbacks >= 0 < found.newton


def test_cache_is_reused(tiny, chart, monkeypatch):
    """A map started again, from the file, runs nothing."""
    again = Cache(tiny.path)
    monkeypatch.setattr(caching, "solve", lambda case, limit: pytest.fail("a run that was there"))
    assert again.outcomes == tiny.outcomes
    assert run_all([*chart.panels[0].cases(), HOPELESS], again, jobs=2, limit=1, hours=1) == 0


def test_line_that_was_cut_short(tmp_path):
    """What a kill leaves of the line in hand costs that run alone, and the next line is whole."""
    cache = Cache(tmp_path / "runs.jsonl")
    cache.add(TINY, outcome(newton=7))
    with cache.path.open("a") as file:
        file.write(json.dumps({"key": HOPELESS.key})[:-5])
    again = Cache(cache.path)
    assert again.missing([TINY, HOPELESS, HOPELESS]) == [HOPELESS]
    again.add(HOPELESS, outcome(newton=8))
    assert [Cache(cache.path).get(case).newton for case in (TINY, HOPELESS)] == [7, 8]


def test_time_limit():
    """A run that takes too long is stopped and reported so: steps of a billionth never end on any machine."""
    found = caching.solve(replace(TINY, step_scale=1e-9), limit=1)
    assert (found.status, found.reason, found.seconds) == ("failed", "TIME_LIMIT", 1)


def test_crash_is_an_outcome():
    """Whatever ends the process, here a case that it refuses, is recorded."""
    found = caching.solve(replace(TINY, element="P9"), limit=300)
    assert (found.status, found.reason) == ("failed", "CRASH_1")
    assert "P9" in found.message


def test_no_run_is_started_late(tmp_path):
    assert run_all([TINY, HOPELESS], Cache(tmp_path / "runs.jsonl"), jobs=2, limit=1, hours=0) == 2


# -- what is read off them -----------------------------------------------------------------------------
@pytest.fixture
def compared(tmp_path) -> Cache:
    """A case 2 % above its reference in friction, 10 % below in length."""
    cache = Cache(tmp_path / "runs.jsonl")
    cache.add(TINY, outcome(f_t=1.02, contact_length=90e-6, penetration=1e-7))
    cache.add(TINY.reference, outcome(f_t=1.0, contact_length=100e-6))
    return cache


def test_errors(compared):
    assert results.friction_error(TINY, compared) == pytest.approx(0.02)
    assert results.length_error(TINY, compared) == pytest.approx(-0.1)
    assert results.penetration(TINY, compared) == 1e-7


def test_nothing_is_compared_with_a_failed_reference(compared):
    compared.add(TINY.reference, Outcome("failed", f_t=1.0))
    assert results.friction_error(TINY, compared) is None


# -- the scalar fixed point ----------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("pressure", "voltage", "diverges"),
    [(2e3, 100.0, True), (5e3, 150.0, True), (20e3, 150.0, False), (2e3, 50.0, False)],
)
def test_fixed_point(pressure, voltage, diverges):
    """Out of phase it diverges just where the gain exceeds one half; keyed on the contact pressure it never does."""
    found = loop(CLOSURE, pressure, voltage)
    assert (found.by_external is None) == diverges == (found.gain > 0.5)
    assert found.by_contact is not None


# -- pictures and page ---------------------------------------------------------------------------------
def test_picture(tiny, chart, tmp_path):
    """Every cell of the first map has its symbol and iterations, every axis its unit."""
    figure = pictures.draw(chart, tiny, tmp_path / "tiny.png")
    assert imread(tmp_path / "tiny.png").std() > 0.05
    texts = [text.get_text() for text in figure.axes[0].texts]
    assert texts == [f"●\n{tiny.get(case).newton}" for case in chart.panels[0].cases()]
    assert {ax.get_xlabel() for ax in figure.axes} == {"voltage (V)"}
    assert {ax.get_ylabel() for ax in figure.axes} == {"contact size (µm)"}


def test_page(tiny, chart, tmp_path):
    """It holds each run of charts and named failures, with the reason of one that failed."""
    named = plan.Named("irrecoverable", "A penalty too high.", (("1.5e20 Pa/m", HOPELESS),))
    table.write(tmp_path / "stability.md", [chart], plan.neighbours(), [named], CLOSURE, tiny, left=0)
    text = (tmp_path / "stability.md").read_text()
    assert text.count("| ● converged |") == 4
    assert f"✕ failed: {tiny.get(HOPELESS).reason}" in text
    assert "stability/tiny.png" in text


def test_tables_are_whole(tiny, chart, tmp_path):
    """All rows of a table have as many cells as its head."""
    table.write(tmp_path / "stability.md", [chart], plan.neighbours(), plan.named(), CLOSURE, tiny, left=3)
    blocks = [b.splitlines() for b in (tmp_path / "stability.md").read_text().split("\n\n") if b.startswith("|")]
    assert len(blocks) == 3 + len(plan.named())  # the default's, the fixed point's and the chart's
    for block in blocks:
        assert len({line.count("|") for line in block}) == 1


def test_command_draws_what_is_there(tmp_path, capsys):
    """Without running anything all pictures and the page come out, and say what is missing."""
    arguments = ["--draw", "--out", str(tmp_path / "out"), "--docs", str(tmp_path / "docs")]
    assert stability_map.main(arguments) == 0
    assert f"{len(plan.cases())} runs are missing" in capsys.readouterr().out
    for chart in plan.charts():
        assert (tmp_path / "docs" / "stability" / f"{chart.name}.png").exists()
    assert "not run" in (tmp_path / "docs" / "stability.md").read_text()
