"""The stability map: its plan, its kept runs, single runs of a coarse strip, and the page drawn from their numbers."""

import json
from dataclasses import asdict, replace

import numpy as np
import pytest
from matplotlib.figure import Figure
from matplotlib.image import imread

from benchmarks.harness import DOCS, kept
from benchmarks.stability import __main__ as keeping
from benchmarks.stability import page, plan, solve
from benchmarks.stability.__main__ import Runs, run_all
from benchmarks.stability.plan import Case, Outcome
from variational.solvers.coupling import Coupling
from variational.solvers.equations import Control
from variational.solvers.failure import NotConverged
from variational.solvers.newton import Solver

# A press of half an newton a metre on facets of 60 um: two seconds a run.
TINY = Case(contact_size=60e-6, force=0.5, voltage=50.0, element="P1", slide=0.0)
IRRECOVERABLE = replace(TINY, parameter=1.5e24)


@pytest.fixture(scope="module")
def panel() -> plan.Panel:
    """Two voltages and two contact sizes."""
    x = plan.Axis("voltage", "voltage (V)", (0.0, 50.0))
    y = plan.Axis("contact_size", "contact size (µm)", (60e-6, 80e-6), 1e-6)
    return plan.Panel("penalty", TINY, x, y)


@pytest.fixture(scope="module")
def tiny(panel, tmp_path_factory) -> Runs:
    """The panel's runs, and one that fails."""
    runs = Runs(tmp_path_factory.mktemp("stability") / "runs.jsonl")
    assert run_all([*panel.cases(), IRRECOVERABLE], runs, jobs=2, limit=300, hours=1) == 0
    return runs


def outcome(**values) -> Outcome:
    return Outcome("converged", **values)


# -- the plan ------------------------------------------------------------------------------------------
def test_map_is_not_too_large():
    assert len(set(plan.cases())) == len(plan.cases()) <= plan.MOST


def test_neighbours_of_the_default_are_in_the_map():
    """What the choice of the default rests on is run."""
    assert set(plan.neighbours().cases.values()) <= set(plan.cases())


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
    axes = [axis for panel, *_ in plan.charts().values() for axis in (panel.x, panel.y)]
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
        pseudo_transient=False,
        detour=400.0,
        voltage=300.0,
        nu=0.3,
    )
    assert case.reference == Case(contact_size=1.25e-6, voltage=300.0, nu=0.3)
    assert case.reference.reference == case.reference


@pytest.mark.parametrize("field", [f for f in asdict(Case()) if isinstance(getattr(Case(), f), float)])
def test_case_is_kept_by_what_is_changed(field):
    case = replace(Case(), **{field: 0.123})
    assert case.changed == {field: 0.123}
    assert Case(**case.changed) == case != Case()


# -- runs that are kept ------------------------------------------------------------------------------
def test_tiny_map_converges(tiny, panel):
    """Pressed by half a newton a metre the ridge bears it, whatever the voltage. Tolerance: the solve's."""
    for case in panel.cases():
        found = tiny.outcomes[case]
        assert found.status == "converged"
        assert found.f_ext == pytest.approx(0.5, rel=1e-7)
        assert found.newton >= found.steps > 1
        assert found.contact_length > 0 < found.penetration


def test_longer_steps_are_fewer(tiny, tmp_path):
    """Twice as long, of the press alone: at most half as many and one, the touch counted apart."""
    usual, longer = replace(TINY, voltage=0.0), replace(TINY, voltage=0.0, step_scale=2.0)
    runs = Runs(tmp_path / "runs.jsonl")
    run_all([longer], runs, jobs=1, limit=300, hours=1)
    touch = 1
    assert runs.outcomes[longer].steps - touch <= (tiny.outcomes[usual].steps - touch) / 2 + 1


def test_friction_at_full_slip(tmp_path):
    """Without voltage the screen drags with mu_0 times the force. Tolerance: the solve's."""
    case = replace(TINY, voltage=0.0, slide=1e-3)
    runs = Runs(tmp_path / "runs.jsonl")
    run_all([case], runs, jobs=1, limit=300, hours=1)
    assert runs.outcomes[case].full_slip
    assert runs.outcomes[case].f_t == pytest.approx(0.25 * 0.5, rel=1e-6)


@pytest.mark.parametrize("sides", ["carried", "free"])
def test_strip_off_the_screen_follows_the_bone(sides):
    """Lifted and moved sideways without touching, all of it translates alike, lateral faces included."""
    body = solve.make(replace(TINY, sides=sides))
    body.solver.control = Control(5e-6, 2e-6)
    body.solver.solve()
    nodes = body.problem.V.dofmap.index_map.size_local
    np.testing.assert_allclose(body.problem.displacement(), [[5e-6, 2e-6]] * nodes)


def test_failure_is_recorded_with_its_reason(tiny):
    """A penalty 1e8 times the default leaves no digits: the run says by which name and in which load it ended."""
    found = tiny.outcomes[IRRECOVERABLE]
    assert found.status == "failed"
    assert found.reason.startswith("DIVERGED_")
    assert found.reason in found.message
    assert found.load == "press"
    assert found.cutbacks >= 0 < found.newton


@pytest.mark.parametrize("allowed", [True, False])
def test_newton_alone_is_never_pseudo_transient(monkeypatch, allowed):
    """Of every solve of a path with voltage, also where a later iteration of the loop finds no equilibrium."""
    asked, newton = set(), Solver.solve

    def solve_and_note(self, pseudo_transient=False, *more, **how):
        asked.add(pseudo_transient)
        newton(self, pseudo_transient, *more, **how)

    monkeypatch.setattr(Solver, "attempt", lambda self, stop: False)
    monkeypatch.setattr(Solver, "solve", solve_and_note)
    solve.run(replace(TINY, pseudo_transient=allowed))
    assert asked == {allowed, False}


def test_inverted_elements_are_counted_by_layer(monkeypatch):
    """Every failed solve of a path counts for one of the strip's layers."""

    def fail(self, pseudo_transient=False):
        raise NotConverged("DIVERGED", inverted=True)

    monkeypatch.setattr(Coupling, "solve", fail)
    found = solve.run(TINY)
    assert (found.status, found.reason) == ("failed", "DIVERGED")
    assert sum(found.inverted.values()) > 1
    assert set(found.inverted) <= {"stratum corneum", "viable epidermis", "dermis"}


def test_kept_runs_are_not_repeated(tiny, panel, monkeypatch):
    """A map started again, from the file, runs nothing."""
    again = Runs(tiny.path)
    monkeypatch.setattr(keeping, "solve", lambda case, limit: pytest.fail("a run that was there"))
    assert again.outcomes == tiny.outcomes
    assert run_all([*panel.cases(), IRRECOVERABLE], again, jobs=2, limit=1, hours=1) == 0


def test_one_row_is_made_alone(tmp_path, monkeypatch, capsys):
    """With its reference where errors are shown; printed as on the page, kept with the other runs."""
    lengths = {plan.DEFAULT: 9e-5, plan.DEFAULT.reference: 1e-4}
    monkeypatch.setattr(keeping, "solve", lambda case, limit: outcome(contact_length=lengths.get(case, 1e-4)))
    asked = ["--out", str(tmp_path), "--docs", str(tmp_path), "--jobs", "1", "--row"]
    assert keeping.main([*asked, "default"]) == 0
    assert set(Runs(tmp_path / "runs.jsonl").outcomes) == set(lengths)
    last = capsys.readouterr().out.splitlines()[-1]
    assert last.startswith("| default | ● converged |")
    assert "| 90.00 | – | -10 |" in last
    assert keeping.main([*asked, "Newton alone, with cutback"]) == 0
    assert len(Runs(tmp_path / "runs.jsonl").outcomes) == 3
    assert not list(tmp_path.glob("*.md"))


def test_rows_have_names_of_their_own():
    names = [name for group in (plan.neighbours(), *plan.named().values()) for name in group.cases]
    assert len(names) == len(set(names))


def test_line_that_was_cut_short(tmp_path):
    """What a kill leaves of the line in hand costs that run alone, and the next line is whole."""
    runs = Runs(tmp_path / "runs.jsonl")
    runs.add(TINY, outcome(newton=7))
    with runs.path.open("a") as file:
        file.write(json.dumps({"case": IRRECOVERABLE.changed})[:-5])
    again = Runs(runs.path)
    assert again.missing([TINY, IRRECOVERABLE, IRRECOVERABLE]) == [IRRECOVERABLE]
    again.add(IRRECOVERABLE, outcome(newton=8))
    assert [Runs(runs.path).outcomes[case].newton for case in (TINY, IRRECOVERABLE)] == [7, 8]


def test_time_limit():
    """A run that takes too long is stopped and reported so: steps of a billionth never end on any machine."""
    found = keeping.solve(replace(TINY, step_scale=1e-9), limit=1)
    assert (found.status, found.reason, found.seconds) == ("failed", "TIME_LIMIT", 1)


def test_crash_is_an_outcome():
    """Whatever ends the process, here a case that it refuses, is recorded."""
    found = keeping.solve(replace(TINY, element="P9"), limit=300)
    assert (found.status, found.reason) == ("failed", "CRASH_1")
    assert "P9" in found.message


def test_no_run_is_started_late(tmp_path):
    assert run_all([TINY, IRRECOVERABLE], Runs(tmp_path / "runs.jsonl"), jobs=2, limit=1, hours=0) == 2


# -- their numbers -------------------------------------------------------------------------------------
@pytest.fixture
def compared(tmp_path) -> Runs:
    """A case 2 % above its reference in friction, 10 % below in length."""
    runs = Runs(tmp_path / "runs.jsonl")
    runs.add(TINY, outcome(f_t=1.02, contact_length=90e-6, penetration=1e-7))
    runs.add(TINY.reference, outcome(f_t=1.0, contact_length=100e-6))
    return runs


def test_errors(compared):
    assert compared.error(TINY, "f_t") == pytest.approx(0.02)
    (row,) = compared.numbers([TINY, IRRECOVERABLE])["runs"]
    assert row["error_contact_length"] == pytest.approx(-0.1)
    assert row["penetration"] == 1e-7


def test_nothing_is_compared_with_a_failed_reference(compared):
    compared.add(TINY.reference, Outcome("failed", f_t=1.0))
    assert compared.error(TINY, "f_t") is None


# -- picture and page ----------------------------------------------------------------------------------
def test_map_shows_each_run(tiny, panel):
    """Every cell has its symbol and iterations, every axis its unit."""
    ax = Figure().subplots()
    page._map(ax, panel, rows_of(tiny, panel), "penalty", page.outcome_cell)
    assert [text.get_text() for text in ax.texts] == [f"●\n{tiny.outcomes[case].newton}" for case in panel.cases()]
    assert (ax.get_xlabel(), ax.get_ylabel()) == ("voltage (V)", "contact size (µm)")


def rows_of(tiny, panel):
    return {Case(**row["case"]): row for row in tiny.numbers([*panel.cases(), IRRECOVERABLE])["runs"]}


def test_tables_hold_each_run(tiny, panel):
    """A run that failed is listed with its reason, and counted; a run that is missing is listed as not run."""
    named = plan.Named({"1.5e20 Pa/m": IRRECOVERABLE, "default": Case()})
    rows = rows_of(tiny, panel)
    text = page.named_table(named, rows)
    assert f"✕ failed: {tiny.outcomes[IRRECOVERABLE].reason}" in text
    assert "| default | not run |" in text
    assert "| Tiny | penalty | 4 | 4 | 0 | 0 | 0 |" in page.counts_table({"Tiny": [panel]}, rows)


def test_page_is_drawn_from_the_kept_numbers(tmp_path):
    """Every table is whole, every run of the plan is in the numbers, and the picture is there."""
    (tmp_path / "stability.json").write_bytes((DOCS / "stability.json").read_bytes())
    text = page.draw(tmp_path).read_text(encoding="utf-8")
    assert imread(tmp_path / "stability.png").std() > 0.05
    blocks = [b.splitlines() for b in text.split("\n\n") if b.startswith("|")]
    assert len(blocks) == 3 + len(plan.named())  # the default's, the counts' and the random scenes'
    for block in blocks:
        assert len({line.count("|") for line in block}) == 1
    shown = {case for panels in plan.charts().values() for panel in panels for case in panel.cases()}
    assert shown <= {Case(**row["case"]) for row in kept("stability", tmp_path).numbers["runs"]}
