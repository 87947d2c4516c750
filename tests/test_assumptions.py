"""The page of assumptions: its rows are the commands that it prints, its sentences hold of its numbers."""

import argparse
import shlex

import pytest

from benchmarks import assumptions
from benchmarks.assumptions import LEAST_GAP, NEAR, PAPER
from benchmarks.harness import ROOT, kept
from fingerpad.cli.arguments import scene_of


@pytest.fixture(scope="module")
def found():
    return kept("assumptions").numbers


@pytest.mark.slow
def test_printed_options_give_the_scene(monkeypatch):
    """As the command line reads them; whether errors are estimated is left to it."""
    monkeypatch.chdir(ROOT)
    parser = argparse.ArgumentParser()
    parser.add_argument("scene", nargs="?", type=assumptions.Path)
    parser.add_argument("--set", action="append", default=[])
    for name, case in (assumptions.cases() | assumptions.profiles()).items():
        printed = assumptions._command(case).strip("`").replace("none", "")
        scene = scene_of(parser.parse_args([*shlex.split(printed), "--set", "output.errors=false"]))
        assert scene.parameters() == case._replace(errors=False).scene().parameters(), name


def test_sentences_hold_of_the_numbers(found):
    """What the prose says without a number of its own."""
    full, shaped, words = found["full"], found["profiles"], assumptions.Comparison(found)
    mechanical = [name for name in full if "voltage" not in name and "friction" not in name and name != "flat 0"]
    changes = {name: abs(full[name]["mu_app"] / full["reference"]["mu_app"] - 1) for name in mechanical}
    profiles = {name for name in assumptions.PARAMETERS if "ridge_profile" in name}
    assert changes["flat 200"] > max(changes[name] for name in mechanical if name != "flat 200")
    assert max(changes[name] for name in assumptions.LITTLE) < min(changes[name] for name in profiles)
    flat, inside = full["flat"], words.counts("flat")
    assert inside[0] == inside[2] and abs(flat["mu_app"] / PAPER - 1) <= NEAR  # both statements at 170 V
    assert max(flat["gaps"]["full_slip"]) in (flat["gaps"]["full_slip"][0], flat["gaps"]["full_slip"][-1])
    at_200 = [row for name, row in shaped.items() if name.endswith("] at 200 V")]
    assert len(at_200) == 7 and not any(
        row["d_eq"] >= LEAST_GAP and abs(row["mu_app"] / PAPER - 1) <= NEAR for row in at_200
    )
    low = shaped["[1, -0.25] at 150 V"]
    assert low["d_eq"] > LEAST_GAP and low["mu_app"] < PAPER * (1 - NEAR)
    assert min(words.met) < 170 < max(words.met)
    assert min(words.change(*pair, "charged") for pair in (assumptions.LIGHT, ("flat 200", "flat 0"))) > 0


def test_default_is_that_of_other_pages(found):
    """The same scene at 10 µm, run for the models' page; the other counts the ridges that can touch by a rule."""
    models = kept("models").numbers["scenes"]["75 N/m, 200 V"]["full"]["summary"]
    reference = found["full"]["reference"]
    assert reference["mu_app"] == pytest.approx(models["full_slip_mu_app"], rel=1e-5)
    assert reference["charged"] == pytest.approx(models["charged_contact_length"], rel=1e-3)
