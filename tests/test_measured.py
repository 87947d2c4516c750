"""Measured findings beside ours: rules of the verdicts, fits with known answers, and what the page claims in words."""

import numpy as np
import pytest

from benchmarks.harness import DOCS, kept
from benchmarks.measured import __main__ as command
from benchmarks.measured import page, rows, scenes
from benchmarks.measured.verdict import BUILT, HIT, MISS, PART, by_factor, by_fit, by_share
from benchmarks.runs import FORCES, VOLTAGES


@pytest.fixture(scope="module")
def judged():
    return {row.key: row for row in page.judged(DOCS)}


def test_rules():
    """The same for all rows of a kind; a bound belongs to the better verdict."""
    assert [by_share(share) for share in (1.0, 0.99, 0.5, 0.49)] == [HIT, PART, PART, MISS]
    assert [by_fit(r2, 0.95, 0.8) for r2 in (0.95, 0.94, 0.8, 0.79)] == [HIT, PART, PART, MISS]
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


def test_fits_of_their_own_curves():
    """The exponential's rate and the paraboloid's height and half width come back."""
    depth = np.linspace(0.1e-3, 1e-3, 8)
    b, misfit = rows.exponential(depth, 3 * np.expm1(4e3 * depth))
    assert b == pytest.approx(4e3, rel=1e-4) and misfit < 1e-4
    b, misfit = rows.absolute(depth, 3 * np.expm1(4e3 * depth))
    assert b == pytest.approx(4e3, rel=1e-4) and misfit < 1e-4
    x = np.linspace(-3e-3, 3e-3, 13)
    assert rows.paraboloid(x, 2e4 * (1 - (x / 4e-3) ** 2)) == pytest.approx((2e4, 4e-3, 1.0), rel=1e-9)


def test_whole_finger_of_a_hertzian_section():
    """A section with f ∝ d^1.5 and width ∝ d^0.5 under a parabola: F ∝ d^2 and area ∝ d, so area ∝ F^0.5."""
    depth = 1e-3 * (np.array(FORCES) / FORCES[-1]) ** (2 / 3)
    ridges = np.ones(len(FORCES))
    a = {"normal_bone_height": -depth, "normal_ridges_in_contact": ridges, "normal_contact_length": np.sqrt(depth) / 10}
    found, force, area = rows.whole({name: values[:, None] for name, values in a.items()})
    for (exponent, misfit), known in ((rows.power(found, force), 2.0), (rows.power(force, area), 0.5)):
        assert exponent == pytest.approx(known, abs=1e-6) and misfit < 1e-6


def test_every_row_has_a_verdict_and_a_source(judged):
    """At least ten rows; each with a link, what was read of it, and a reason where it is no plain hit."""
    assert len(judged) >= 10 and {row.kind for row in judged.values()} == {"shape", "ratio", "value"}
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


def test_words_of_the_page_are_those_of_its_rows(judged):
    """What the prose says of the misses, of the exponents and of the picture."""
    left_out = {"frequency_wide", "real_sliding", "friction_acrylic", "time", "relaxation", "speed"}
    left_out |= {"gap_sliding", "friction_occluded", "adhesion"}
    assert {key for key, row in judged.items() if row.verdict == MISS} == left_out | {"ridges", "area_after"}
    assert judged["ridges"].numbers["high"] < 0.67 / 3
    grid = rows.grid(kept("paper").numbers, kept("models").numbers)
    found = rows.exponents(grid.fine["slip_f_t"], VOLTAGES[1:])
    assert list(found - 2 <= 0.25) == [force >= 25 for force in FORCES] and (found > 2).all()
    assert judged["force_depth"].numbers["power"] < judged["force_depth"].numbers["exponential"]


def test_friction_follows_the_attraction():
    """At full slip f_T = µ_0 (f_ext + attraction), so that both rise by the same power of the voltage."""
    coarse = rows.grid(kept("paper").numbers, kept("models").numbers).coarse
    forces = np.array(FORCES)[:, None]
    # The slide ends where f_T is steady to 1e-6 of itself.
    np.testing.assert_allclose(coarse["slip_f_t"], 0.25 * (forces + coarse["slip_f_electrostatic"]), rtol=1e-6)


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
    """Two sizes of each finger; the kept ones balance 75 N/m."""
    wanted = scenes.scenes()
    runs = kept("measured").numbers["runs"]
    assert set(runs) == set(wanted) and len({str(scene.parameters()) for scene in wanted.values()}) == 6
    for run in runs.values():
        total = sum(run["pressure"]) * wanted["dry 20"].geometry.ridge_wavelength
        assert total == pytest.approx(scenes.FORCE, rel=1e-6) and len(run["place"]) == run["ridges"]
