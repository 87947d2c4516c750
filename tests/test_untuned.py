"""Accuracy asked for, judged: the scenes drawn, and what the page says of made-up answers."""

import json

import numpy as np
import pytest

from benchmarks import accuracy, hertz, limits, untuned
from benchmarks.convergence import Limit
from benchmarks.errors import DEFAULT
from fingerpad.runs.batch import key
from fingerpad.scene import Scene, start


def test_the_same_scenes_are_drawn_each_time():
    first, again = untuned.scenes(), untuned.scenes()
    assert first == again
    assert len({key(scene) for scene in first.values()}) == untuned.COUNT


def test_nothing_of_the_mesh_is_chosen_where_an_accuracy_is_asked():
    """It starts from the sizes any such scene starts from."""
    drawn = next(iter(untuned.scenes().values()))
    for asked in ({"mu_app": 0.01}, {"sed": 0.05}):
        scene = untuned.asked(drawn, **asked)
        sizes = start(asked)
        assert {name: getattr(scene.mesh, name) for name in sizes} == sizes
        assert scene.accuracy is not None


def summary(**quantities):
    """Made-up ends: value, error and what was allowed, by name."""
    rows = {n: {"value": v, "error": e, "allowed": a, "shares": {}} for n, (v, e, a) in quantities.items()}
    mesh = Scene().mesh.model_dump()
    solve = {"mesh": mesh, "unknowns": 100, "factorisations": 7, "processor_seconds": 1.0}
    found = {"reached": True, "mesh": mesh, "quantities": rows, "solves": [solve], "unknowns_times_factorisations": 700}
    return {"accuracy": found}


ENDS = {
    "slip_mu_app": Limit(0.5, 0.001, 1.0),
    "slip_f_t": Limit(37.5, 0.1, 1.0),
    "slip_sed_0": Limit(10.0, 0.1, 1.0),
    "slip_sed_1": Limit(100.0, 0.1, 1.0),
}


def test_errors_are_those_against_the_limit():
    """0.51 +- 0.02 against 0.5: an error of 2 %, an estimate of 4 %, an effectivity of 2."""
    (found,) = accuracy.judged(summary(slip_mu_app=(0.51, 0.02, 0.005)), ENDS)
    assert (found.error, found.estimate, found.allowed) == pytest.approx((0.02, 0.04, 0.01), rel=1e-12)
    assert found.effectivity == pytest.approx(2, rel=1e-12)


@pytest.mark.parametrize(
    ("value", "allowed", "met"),
    [(0.502, 0.005, "yes"), (0.5045, 0.005, "likely"), (0.506, 0.005, "no"), (0.5, None, "")],
)
def test_met_is_likely_where_the_limits_bar_leaves_it_open(value, allowed, met):
    """The limit is 0.5 +- 0.001."""
    (found,) = accuracy.judged(summary(slip_mu_app=(value, 0.003, allowed)), ENDS)
    assert found.met == met


def test_energy_density_counts_over_the_largest_site():
    """The worst of them, not where an accuracy is asked of something else; friction force is friction over a given one.

    An estimate alone is judged too.
    """
    found = accuracy.judged(
        summary(slip_sed_0=(11.0, 2.0, 5.0), slip_sed_1=(100.5, 1.0, 5.0), slip_f_t=(37.0, 1.0, None)), ENDS
    )
    other = accuracy.judged(summary(slip_sed_0=(11.0, 2.0, None), slip_mu_app=(0.5, 0.1, 0.1)), ENDS)
    assert [row.name for row in other] == ["slip_mu_app"]
    assert [row.name for row in accuracy.judged(summary(slip_sed_0=(11.0, 2.0, None)), ENDS)] == ["slip_sed_0"]
    assert [(row.name, row.error) for row in found] == [("slip_sed_0", pytest.approx(0.01, rel=1e-12))]


@pytest.mark.parametrize(
    ("value", "words", "tallies"),
    [
        (0.502, "in 1 of 1", ("1 of 2", "0 below, 1 above", "1 of 1", "0 below, 0 above")),
        (0.508, "in 0 of 1", ("0 of 2", "1 below, 1 above", "0 of 1", "1 below, 0 above")),
    ],
)
def test_page_counts_the_scenes_that_met_it(tmp_path, value, words, tallies):
    """One of the scenes drawn was run, and is off by 0.4 or by 1.6 % of 1 %; the other quantity was not asked for."""
    out = tmp_path / "traces"
    name, (scene, plain) = next((n, found) for n, found in accuracy.loops().items() if found[1] != DEFAULT)
    folder = out / key(scene)
    folder.mkdir(parents=True)
    said = summary(slip_mu_app=(value, 0.003, 0.005), slip_contact_length=(0.51, 0.1, None))
    (folder / "summary.json").write_text(json.dumps(said), encoding="utf-8")
    assert words not in accuracy.loop_tables(out), "its limit is not there yet"
    (tmp_path / "limits").mkdir()
    values = [dict.fromkeys(("slip_mu_app", "slip_contact_length"), 0.5 + d) for d in (0.004, 0.002, 0.001)]
    told = {"levels": [{"values": each} for each in values]}
    file = tmp_path / "limits" / f"{key(plain)}-{accuracy.LEVELS}.json"
    file.write_text(json.dumps(told), encoding="utf-8")
    assert limits.limits(told)["slip_mu_app"].value == pytest.approx(0.5, rel=1e-12)
    page = accuracy.loop_tables(out)
    assert words in page
    assert f"| {name} | µ_app, full slip | 1 | 0.6 |" in page
    words = (
        "{} effectivities are between 0.5 and 3, {}. Of what was asked for: {} effectivities are between 0.5 and 3, {}."
    )
    assert words.format(*tallies) in page
    assert f"so that the limit is of those before: {name}." in page
    file.write_text(json.dumps({"levels": [told["levels"][0], *told["levels"]]}), encoding="utf-8")
    assert "the limit is of those before" not in accuracy.loop_tables(out)


def test_drawn_scene_that_fails_has_not_met_it(tmp_path):
    out = tmp_path / "traces"
    name, (scene, plain) = next((n, found) for n, found in accuracy.loops().items() if found[1] != DEFAULT)
    (tmp_path / "limits").mkdir()
    known = {"levels": [{"values": {"slip_mu_app": 0.5}}] * 3}
    (tmp_path / "limits" / f"{key(plain)}-{accuracy.LEVELS}.json").write_text(json.dumps(known), encoding="utf-8")
    (out / key(scene)).mkdir(parents=True)
    (out / key(scene) / "summary.json").write_text(json.dumps({"failure": "no equilibrium"}), encoding="utf-8")
    page = accuracy.loop_tables(out)
    assert "in 0 of 1" in page
    assert f"| {name} | no equilibrium |" in page


def test_edges_are_spread_over_a_facet_and_judged_in_its_length(monkeypatch):
    """Contact that is cut off at the end of the facet before: an edge is short by where in its facet it should be."""
    size = hertz.HALF_WIDTH / 10

    def cut_off(a, facets):
        assert facets == 10
        return 2 * size * np.floor(a / size + 1e-9)

    monkeypatch.setattr(hertz, "contact_length", cut_off)
    errors = [hertz.edge_error(a, 10) for a in hertz.places(10)]
    np.testing.assert_allclose(np.sort(errors), np.arange(-11, 1) / 12, atol=1e-9)
