"""Measured findings beside ours: rules of the verdicts, fits with known answers, and what the page claims in words."""

import numpy as np
import pytest

from benchmarks.harness import DOCS, kept
from benchmarks.measured import __main__ as command
from benchmarks.measured import finger, forms, page, rows, scenes
from benchmarks.measured.verdict import BUILT, HIT, MISS, PART, STRIKING, by_factor, by_form, by_share
from benchmarks.runs import FORCES, VOLTAGES


@pytest.fixture(scope="module")
def judged():
    return {row.key: row for row in page.judged(DOCS)}


def test_rules():
    """The same for all rows of a kind; a bound belongs to the better verdict."""
    assert [by_share(share) for share in (1.0, 0.99, 0.5, 0.49)] == [HIT, PART, PART, MISS]
    assert [by_factor(*ours, 2.0, 4.0) for ours in ((2, 4), (1.9, 3), (2, 8), (0.9, 3), (3, 8.1))] == [
        HIT,
        *(PART, PART, MISS, MISS),
    ]
    assert by_factor(1.6, 1.6, 2.0, 2.0, 1.25) == HIT and by_factor(1.5, 1.5, 2.0, 2.0, 1.25) == PART


def test_exponents_of_a_power():
    """U² and U³ over any base, each force by itself."""
    u = np.array(VOLTAGES)
    values = np.array([5 + 0.3 * u**2, 1e-3 + 1e-9 * u**3])
    assert rows.exponents(values, VOLTAGES[1:4]) == pytest.approx([2.0, 3.0], abs=1e-9)


@pytest.mark.parametrize(
    ("misfits", "others", "verdict"),
    [
        ((0.1,), (0.11,), HIT),
        ((0.05,), (0.1,), PART),
        ((0.11,), (0.0,), MISS),
        ((0.11,), (0.5,), MISS),
        ((0.05, 0.05), (0.05, 0.2), HIT),
        ((0.05, 0.05), (0.05, 0.05), PART),
        ((0.05, 0.11), (0.05, 0.05), PART),
        ((0.11, 0.11), (0.05, 0.05), MISS),
    ],
)
def test_form_has_to_fit_and_another_not_to(misfits, others, verdict):
    """Where another form with as many parameters fits too, the curve does not show which form it has."""
    assert by_form(misfits, others) == verdict


@pytest.mark.parametrize("fit", [forms.of_each, forms.of_largest])
@pytest.mark.parametrize(("form", "parameter"), [(forms.exponential, 4.0), (forms.power, 2.2), (forms.line, 0.3)])
def test_forms_find_their_own_curves(form, parameter, fit):
    """The parameter comes back at any scale, and nothing is left."""
    x = np.linspace(0.1e-3, 1e-3, 8)
    found = fit(form, x, 3e4 * form(x, parameter))
    assert found.parameter == pytest.approx(parameter, rel=1e-4) and found.misfit < 1e-4


@pytest.mark.parametrize("form", [forms.paraboloid, forms.ellipse])
def test_pressures_find_their_own_curves(form):
    """The half width comes back, in units of the outermost ridge; the other form leaves some per cent."""
    x = np.linspace(-3e-3, 3e-3, 13)
    pressure = 2e4 * form(x, 1.2)
    found = forms.of_largest(form, x, pressure)
    assert found.parameter == pytest.approx(1.2, rel=1e-4) and found.misfit < 1e-4
    other = forms.ellipse if form is forms.paraboloid else forms.paraboloid
    assert 0.005 < forms.of_largest(other, x, pressure).misfit < 0.1


def test_misfits_of_a_known_curve(monkeypatch):
    """A constant beside 1 and 3: half the distance of the logarithms, and of the values, is left."""
    x, y = np.array([1.0, 2.0]), np.array([1.0, 3.0])

    def flat(x, parameter):
        return np.ones_like(x)

    monkeypatch.setitem(forms.BOUNDS, flat, (0.0, 1.0))
    assert forms.of_each(flat, x, y).misfit == pytest.approx(np.log(3) / 2)
    assert forms.of_largest(flat, x, y).misfit == pytest.approx(1 / 3)


@pytest.fixture(scope="module")
def grid():
    return rows.grid(kept("paper").numbers, kept("models").numbers)


def areas(grid, **changed):
    """Return the grid with the gross areas of whole fingers over those of the uncharged press, by state."""
    plain = grid.full_finger["charged_0_gross_area"]
    of = {f"{state}_gross_area": plain * np.asarray(factor) for state, factor in changed.items()}
    return grid._replace(full_finger=dict(grid.full_finger) | of)


@pytest.mark.parametrize(
    ("key", "changed", "verdict"),
    [
        ("area_before", {"charged_200": 1.02}, HIT),
        ("area_before", {"charged_200": 1.04}, MISS),
        ("area_before", {"charged_200": 0.96}, MISS),
        ("area_before", {"charged_200": [1.04, 0.96, 1.04, 1.04, 1, 1, 1, 1]}, PART),
        ("area_after", {"full_slip_0": 1.0, "full_slip_200": 0.96}, HIT),
        ("area_after", {"full_slip_0": 0.9, "full_slip_200": 0.9}, MISS),
        ("area_after", {"full_slip_0": 0.9, "full_slip_200": 1.0}, MISS),
        ("area_shear", {"full_slip_0": 0.96}, HIT),
        ("area_shear", {"full_slip_0": 0.98}, MISS),
        ("area_shear", {"full_slip_0": [0.9] * 4 + [1.1] * 4}, PART),
        ("apparent_sliding", {"full_slip_0": 0.96}, HIT),
        ("apparent_sliding", {"full_slip_0": 1.04}, MISS),
    ],
)
def test_apparent_areas_are_those_of_the_whole_finger(grid, key, changed, verdict):
    """They change from 3 % on: before slip they should not, in sliding they should fall."""
    assert rows.numbers(areas(grid, **changed), kept("measured").numbers["runs"])[key][1] == verdict


@pytest.mark.parametrize(
    ("power", "verdicts"),
    [(0.0, [HIT, MISS, MISS, MISS]), (-0.3, [MISS, HIT, HIT, PART]), (0.3, [MISS, MISS, HIT, PART])],
)
def test_friction_over_the_load(grid, power, verdicts):
    """Independent of the load, falling, a power of the load, and five times higher: by µ of the runs at 0 V."""
    f_t = np.array(grid.fine["full_slip_f_t"])
    f_t[:, 0] = 0.25 * np.array(FORCES) ** (1 + power)
    found = rows.numbers(grid._replace(fine=dict(grid.fine) | {"full_slip_f_t": f_t}), kept("measured").numbers["runs"])
    keys = ("friction_load", "friction_acrylic", "friction_power", "friction_occluded")
    assert [found[key][1] for key in keys] == verdicts


def test_squares_hold_in_both_ranges_of_the_voltage(grid):
    """An amplitude of 75 to 150 V is 53 to 106 V of effective voltage: U² in one of both ranges is not enough."""

    def verdict(rises):
        f_t = grid.fine["full_slip_f_t"][:, :1] + np.array([0.0, *rises, 16.0])
        found = rows.numbers(
            grid._replace(fine=dict(grid.fine) | {"full_slip_f_t": f_t}), kept("measured").numbers["runs"]
        )
        return found["friction_range"][1]

    assert verdict((1.0, 4.0, 9.0)) == HIT
    assert verdict((1.0, 4.0, 12.0)) == verdict((2.0, 4.0, 9.0)) == verdict((1.0, 4.0, 5.0)) == MISS


def test_whole_finger_is_that_of_the_page_of_newtons(grid):
    """Gross and ridge contact area at full slip as in docs/newtons.json, R_z 28 mm."""
    known = [row for row in kept("newtons").numbers["friction"] if row["radius"] == 28e-3 and row["voltage"] == 200]
    for name in ("gross_area", "contact_area"):
        sums = dict(zip(finger.NEWTONS, grid.full_finger[f"full_slip_200_{name}"], strict=True))
        for row in known:
            assert sums[round(row["f_ext"], 6)] == pytest.approx(row[name], rel=1e-9)


def test_every_row_has_a_verdict_and_a_source(judged):
    """At least ten rows; each with a link, what was read of it, and a reason where it is no plain hit."""
    assert len(judged) >= 10 and {row.kind for row in judged.values()} == {"shape", "ratio", "value", "simulated"}
    for row in judged.values():
        assert row.verdict in (HIT, PART, MISS, BUILT) and row.measured and row.ours and row.fitted
        assert row.source["link"].startswith("https://") and row.source["people"]
        assert row.source["read"] in ("abstract", "abstract of the data set", "quoted")
        assert row.why or row.verdict == HIT


def test_every_source_is_used():
    assert {row["source"] for row in page._read("rows")} == {source["key"] for source in page._read("sources")}


def test_shapes_come_first():
    text = (DOCS / "measured.md").read_text(encoding="utf-8")
    assert text.index("## Shapes") < text.index("## Ratios") < text.index("## Absolute")


def test_simulated_findings_do_not_count(judged):
    """A finding that the source computed has a table of its own, after those that count."""
    text = (DOCS / "measured.md").read_text(encoding="utf-8")
    assert [key for key, row in judged.items() if row.kind == "simulated"] == ["modulus"]
    assert f"Of {len(judged) - 1} measured findings" in text
    assert text.index("## Absolute") < text.index("## Simulated") < text.index(judged["modulus"].measured)


def test_words_of_the_page_are_those_of_its_rows(judged, grid):
    """What the prose says of hits and misses, of the exponents and of the picture."""
    left_out = {"frequency_wide", "real_sliding", "friction_acrylic", "friction_power", "time", "relaxation", "speed"}
    left_out |= {"gap_sliding", "friction_occluded", "adhesion"}
    mechanics = {"ridges", "area_shear", "apparent_sliding"}
    assert {key for key, row in judged.items() if row.verdict == MISS} == left_out | mechanics
    assert len(left_out) == 10 and len(mechanics) == 3
    assert [key for key, row in judged.items() if row.verdict == HIT and row.kind != "simulated"] == ["softer"]
    softer = judged["softer"].numbers
    assert softer["less"] - softer["less_error"] < STRIKING < softer["more"] - softer["error"]
    assert judged["ridges"].numbers["high"] < 0.67 / 3
    found = rows.exponents(grid.fine["full_slip_f_t"], VOLTAGES[1:])
    assert list(found - 2 <= 0.25) == [force >= 25 for force in FORCES] and (found > 2).all()
    assert judged["force_depth"].numbers["other_each"] < judged["force_depth"].numbers["each"] / 5
    assert judged["pressure_shape"].numbers["other"] < judged["pressure_shape"].numbers["misfit"]


def test_friction_follows_the_attraction(grid):
    """At full slip f_T = µ_0 (f_ext + attraction), so that both rise by the same power of the voltage."""
    coarse = grid.coarse
    forces = np.array(FORCES)[:, None]
    # The slide ends where f_T is steady to 1e-6 of itself.
    np.testing.assert_allclose(
        coarse["full_slip_f_t"], 0.25 * (forces + coarse["full_slip_f_electrostatic"]), rtol=1e-6
    )


def test_kept_rows_are_those_of_the_other_pages(judged):
    """Where docs/paper.json or docs/models.json are made anew, ``make measured`` has to be given again."""
    own = kept("measured").numbers
    again = command.numbers(own["runs"], DOCS)
    assert {key: row["verdict"] for key, row in again["rows"].items()} == {
        k: r["verdict"] for k, r in own["rows"].items()
    }
    for key, row in again["rows"].items():
        assert row["numbers"] == pytest.approx(own["rows"][key]["numbers"], rel=1e-6, abs=1e-9), key
    for name, values in again["curves"].items():
        assert values == pytest.approx(own["curves"][name], rel=1e-9)


def test_every_row_has_words():
    assert [row["key"] for row in page._read("rows")] == list(kept("measured").numbers["rows"])


def test_runs_of_the_page():
    """Two sizes of each of four fingers; the kept ones balance 75 N/m."""
    wanted = scenes.scenes()
    runs = kept("measured").numbers["runs"]
    assert set(runs) == set(wanted) and len({str(scene.parameters()) for scene in wanted.values()}) == 8
    for run in runs.values():
        total = sum(run["pressure"]) * wanted["dry 20"].geometry.ridge_wavelength
        assert total == pytest.approx(scenes.FORCE, rel=1e-6) and len(run["place"]) == run["ridges"]
