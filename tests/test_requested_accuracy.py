"""Requested accuracies against limits: the scenes drawn, the cases of a run, and the verdict on the page."""

import pytest

from benchmarks import accuracy
from benchmarks.accuracy import WHOLE, Case
from benchmarks.limits import Limit
from fingerpad.scene import Scene, start


def test_request_starts_from_the_sizes_of_any_scene():
    """Nothing of the mesh is chosen for the scene."""
    plain = next(iter(accuracy.drawn().values()))
    for request in ({"mu_app": 0.01}, {"sed": 0.05}):
        scene = accuracy.with_accuracy(plain, **request)
        sizes = start(request)
        assert {name: getattr(scene.mesh, name) for name in sizes} == sizes
        assert scene.accuracy is not None


def summary(**quantities):
    """Made-up ends: value, estimate and request, by name."""
    rows = {n: {"value": v, "estimate": e, "allowed": a} for n, (v, e, a) in quantities.items()}
    solve = {"unknowns": 100, "factorisations": 7, "processor_seconds": 1.0}
    a = {"mesh": Scene().mesh.model_dump(), "quantities": rows, "solves": [solve], "unknowns_times_factorisations": 700}
    return {"accuracy": a | {"processor_seconds": 6.0}}


ENDS = {
    "full_slip_mu_app": Limit(0.5, 0.001, 1.0),
    "full_slip_f_t": Limit(37.5, 0.1, 1.0),
    "full_slip_sed_0": Limit(10.0, 0.1, 1.0),
    "full_slip_sed_1": Limit(100.0, 0.1, 1.0),
}


def test_errors_are_those_against_the_limit():
    """0.51 ± 0.02 against 0.5: an error of 2 %, an estimate of 4 %, an effectivity of 2."""
    (found,) = accuracy.judged("", summary(full_slip_mu_app=(0.51, 0.02, 0.005)), ENDS)
    assert (found.error, found.estimate, found.allowed, found.bar) == pytest.approx((2, 4, 1, 0.2), rel=1e-12)
    assert (found.kind, found.effectivity) == ("friction", pytest.approx(2, rel=1e-12))


def test_energy_density_counts_over_the_largest_site():
    """The worst site of a state, and none where an accuracy is requested of another quantity; f_T is friction again.

    An estimate without a request is judged, too.
    """
    found = accuracy.judged(
        "",
        summary(full_slip_sed_0=(11.0, 2.0, 5.0), full_slip_sed_1=(100.5, 1.0, 5.0), full_slip_f_t=(37.0, 1.0, None)),
        ENDS,
    )
    other = accuracy.judged("", summary(full_slip_sed_0=(11.0, 2.0, None), full_slip_mu_app=(0.5, 0.1, 0.1)), ENDS)
    alone = accuracy.judged("", summary(full_slip_sed_0=(11.0, 2.0, None)), ENDS)
    assert [case.quantity for case in other] == ["µ_app, full slip"]
    assert [case.quantity for case in alone] == ["SED at ridge 0, full slip"]
    assert [(c.quantity, c.error) for c in found] == [("SED at ridge 0, full slip", pytest.approx(1, rel=1e-12))]


def test_cost_has_the_starts_that_failed():
    """700 factorisations times unknowns, and those of a coarser start, 20 of 10; over a default run of 1800."""
    lost = {"restarts": [{"unknowns": 10, "factorisations": 20, "processor_seconds": 1.5}]}
    row = accuracy.row(summary(full_slip_mu_app=(0.5, 0.1, None)) | lost, 1800)
    assert row["cost"] == 0.5


@pytest.mark.parametrize(
    ("error", "more", "words"),
    [
        (0.4, {}, "µ_app 1 % in 1 of 1 scenes"),
        (1.6, {}, "µ_app 1 % in 0 of 1 scenes"),
        (0.4, {"2: b; µ_app 1 %": {"failure": "no equilibrium"}}, "µ_app 1 % in 1 of 2 scenes"),
        (0.4, {"2: b; µ_app 1 %": {"unknown": "no limit"}}, "µ_app 1 % in 1 of 1 scenes"),
    ],
)
def test_scene_that_failed_has_not_met_its_request(error, more, words):
    """A scene whose limit is not known is not counted, nor is a quantity without a request."""
    name = "1: a; µ_app 1 %"
    cases = [Case(WHOLE, name, "µ_app, full slip", True, 1.0, error, 0.1, 1.0)]
    cases += [Case(WHOLE, name, "contact length, full slip", True, 1.0, 9.0, 0.1)]
    runs = {"default scene; µ_app 1 %": {}, name: {}} | more
    assert accuracy._verdicts(runs, cases) == [words]


def test_study_of_one_parameter_leaves_out_its_finest_run():
    """Contact lengths of two ridges, 1 % and 0.5 % off 2: the estimate of the second is the last change, 0.5 %."""
    lengths = [1.02, 1.01, 1.005, 1.0]
    rows = [
        {"value": h, "quantities": {"full_slip_contact_length": 2 * x}, "lengths": {"full_slip_contact_length": [x, x]}}
        for h, x in zip((40e-6, 20e-6, 10e-6, 5e-6), lengths, strict=True)
    ]
    found = list(accuracy.of_parameter("receptor", rows))
    assert [(c.scene, c.once) for c in found] == [("sites (µm): 20", True), ("sites (µm): 10", False)]
    assert [c.error for c in found] == pytest.approx([1.0, 0.5], rel=1e-9)
    assert [c.estimate for c in found] == pytest.approx([1.0, 0.5], rel=1e-9)
