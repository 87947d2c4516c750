"""What was asked of speed and accuracy, beside what kept numbers have reached."""

import pytest

from benchmarks import targets
from benchmarks.errors import FORCE
from benchmarks.harness import DOCS, Made, keep
from benchmarks.limits import Limit

BY = Made("0.1.0", "abc1234", "2026-11-27")


def row(words, docs):
    return next(each for each in targets.rows(docs) if words in each.words)


def kept_errors(docs, f_contact):
    """Keep errors of a scene with two quantities, and a force at a given indentation whose limit is 100 N/m."""
    default = {"full_slip_mu_app": 0.5001, "charged_contact_length": 1.01e-3}
    ends = {"full_slip_mu_app": 0.5, "charged_contact_length": 1e-3}
    reference = {name: vars(Limit(value, 0.0, 2.0)) for name, value in ends.items()}
    levels = [{"values": {FORCE: 100 + 4.0**-k}} for k in range(3)]
    pressed = {"own": {"values": {FORCE: f_contact}}, "levels": levels}
    keep("errors", {"default": default, "reference": reference, "pressed": pressed, "saw": 0.004}, BY, docs)


@pytest.mark.parametrize(("f_contact", "met"), [(100.05, "yes"), (100.2, "no")])
def test_figures_of_kept_errors(tmp_path, f_contact, met):
    """Largest errors of a kind in per cent, by known limits."""
    kept_errors(tmp_path, f_contact)
    friction, lengths = row("µ_app", tmp_path), row("contact lengths", tmp_path)
    assert (friction.asked, friction.reached, friction.met) == ("≤ 0.05 %", "0.02 %", "yes")
    assert (lengths.reached, lengths.met) == ("1 %", "no")
    assert (row("saw", tmp_path).reached, row("force at", tmp_path).met) == ("0.4 %", met)


def test_figure_that_no_command_has_computed_is_a_dash(tmp_path):
    """Here all of them; in the repository's own numbers no figure is lost by the name of a number that changed."""
    assert {(each.reached, each.met) for each in targets.rows(tmp_path)} == {("–", "–")}
    assert row("one ridge beside", DOCS).met == "yes"
    assert row("printed errors", DOCS).reached != "–"
    assert row("whole run", DOCS).reached != "–"


def test_figures_of_states_without_paths(tmp_path):
    """Forty loads in 240 s, two at a time; all but the first from a neighbour, by four factorisations."""
    one = {"processor_seconds": 6.0, "factorisations": 4}
    rows = [one | {"reached": "path" if k == 0 else "neighbour"} for k in range(40)]
    one = {"f_ext": 5.0, "voltage": 0.0, "f_t": 2.0, "ridges": 7, "states": [2.0], "touching": 7, "reached": "path"}
    listed = [one, one | {"states": [2.1]}, one | {"states": [2.1], "touching": 8}]
    seconds = {"seconds_of_sweep": 240.0, "seconds_of_paths": [18.0] * 40}
    keep("paper_states", {"default": rows, "beside": listed} | seconds, BY, tmp_path)
    older = Made("0.1.0", "abc1234", "2026-11-25")
    keep("performance", {"run": {"found": {"processor": 60.0}}}, older, tmp_path)
    assert (row("40 states", tmp_path).reached, row("40 states", tmp_path).met) == ("2", "yes")
    assert (row("twice as large", tmp_path).reached, row("twice as large", tmp_path).met) == ("6", "no")
    assert row("factorisations", tmp_path).reached == "4"
    assert (row("further state over", tmp_path).reached, row("further state over", tmp_path).met) == ("0.1", "no")
    assert row("states equal", tmp_path).reached == "2"
    assert (row("states equal", tmp_path).of, row("further state over", tmp_path).of) == (BY.date, older.date)
