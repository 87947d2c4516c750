"""The commands check and mesh: loads, laws and cost of a run, and its mesh."""

import pytest

from fingerpad.cli import main
from fingerpad.model import expected as cost
from fingerpad.model.memory import estimate
from fingerpad.model.options import plan
from fingerpad.scene import Scene, from_data
from tests.commands import COARSE, kept, refused


def test_check(tmp_path, capsys):
    """Loads in order, what is left out with its reason, and a picture."""
    argv = ["check", "--set", "voltage=0", "--out", str(tmp_path)]
    assert main([*argv, *(word for text in COARSE for word in ("--set", text))]) == 0
    text = capsys.readouterr().out
    assert text.index("1. press: force to 75 N/m") < text.index("3. slide: bone sideways to 5 mm, or until full slip")
    assert "attraction and the air gaps of the ridges: no load has a voltage" in text
    assert "friction: Coulomb(mu_f=0.25)" in text and "closure: none" in text
    assert (tmp_path / "mesh.png").stat().st_size > 10_000


@pytest.mark.parametrize(("formulation", "told"), [("augmented", 1), ("penalty", 0), ("nitsche", 0)])
def test_method_for_comparison_is_named_before_a_run(tmp_path, monkeypatch, capsys, formulation, told):
    """One line of the model, for the augmented Lagrangian alone."""
    monkeypatch.setattr("fingerpad.cli.check._picture", lambda *given: "")
    argv = ["check", "--set", f"contact.formulation={formulation}", "--out", str(tmp_path)]
    assert main([*argv, *(word for text in COARSE for word in ("--set", text))]) == 0
    assert capsys.readouterr().out.count("contact by a method for comparison") == told


def test_rule_of_the_cost_is_that_of_kept_runs():
    """Shares, factors and time are the default run's of docs/chart.json, times those of docs/performance.json."""
    points = {point["label"]: point for point in kept("chart.json")["points"]}
    work = points["default"]["work"]
    slip, charged, pressed = work["full_slip"], work["charged"], work["uncharged"]
    shares = {"force": pressed / slip, "voltage": (charged - pressed) / slip, "slide": (slip - charged) / slip}
    assert cost.SHARES == pytest.approx(shares, abs=0.01)
    at_10_um = points["10 µm"]["work"]["full_slip"]
    for name, label in (("nitsche", "Nitsche, γ_0 = 1"), ("augmented", "augmented Lagrangian")):
        assert cost.FORMULATIONS[name] == pytest.approx(points[label]["work"]["full_slip"] / at_10_um, rel=0.01)
    run, operations = (kept("performance.json")[name]["found"] for name in ("run", "operations"))
    path = sum(run["path"].values())
    unknowns = next(each["unknowns"] for each in operations if each["factor"] == 1.0)
    assert cost.SECONDS == pytest.approx(path / run["factorisations"] / unknowns, rel=0.02)
    beside = dict(run["beside"])
    assert cost.ERRORS == pytest.approx(beside.pop("errors") / path, rel=0.03)
    assert cost.BESIDE == pytest.approx(sum(beside.values()) / path, rel=0.03)
    assert cost.COMPILING == pytest.approx(kept("performance.json")["compile"]["found"]["cold"]["seconds"], rel=0.03)
    needed = plan(Scene())
    default = cost.expected(Scene(), needed, estimate(Scene(), needed).unknowns)
    assert default.factorisations == pytest.approx(run["factorisations"], rel=0.02)
    assert default.seconds == pytest.approx(run["processor"], rel=0.1)
    for name, found in kept("models.json")["scenes"].items():
        f_ext, voltage = (float(part.split()[0]) for part in name.split(","))
        scene = from_data({"f_ext": f_ext, "voltage": voltage})
        ratio = sum(cost.factorisations(scene)) / found["full"]["cost"]["factorisations"]
        assert 0.5 < ratio < 2, name


@pytest.mark.parametrize(
    ("values", "load"),
    [
        ({"voltage": 5000.0}, "the load charge has 75 N/m and 5000 V"),
        ({"f_ext": 1.0}, "the load press has 1 N/m and 0 V"),
        ({"history": [{"name": "dip", "bone_height": -1e-4}]}, "the load dip has no f_ext and 0 V"),
    ],
)
def test_work_outside_of_the_kept_runs_is_not_known(values, load):
    """Named with the first load there; inside, up to the ends, it is known."""
    assert cost.beyond_loads(from_data(values)).endswith(load)
    assert not any(
        cost.beyond_loads(from_data({"f_ext": f, "voltage": u})) for f in (5.0, 150.0) for u in (-200.0, 0.0)
    )


def test_cost_is_not_extrapolated(tmp_path, monkeypatch, capsys):
    """No number of factorisations, no hours, and no promise; on a coarse mesh the time alone is not known."""
    monkeypatch.setattr("fingerpad.cli.check._picture", lambda *given: "")
    argv = ["check", "--out", str(tmp_path), *(word for text in COARSE for word in ("--set", text))]
    assert main([*argv, "--set", "voltage=5000"]) == 0
    text = capsys.readouterr().out
    assert "the work is not known: it was measured at 5 to 150 N/m and up to 200 V, and the load charge" in text
    assert "factorisations" not in text and "hours" not in text and "can be run" not in text
    assert main(argv) == 0
    text = capsys.readouterr().out
    assert " factorisations\n" in text and "The scene can be run." in text
    assert "the time is not known: it was measured with 41 000 to 900 000 unknowns, and the mesh has some" in text


def test_mesher_that_fails_is_refused_in_a_sentence(monkeypatch, capsys):
    """With what gmsh says; an error of the program stays one."""
    pytest.importorskip("gmsh")

    def fail(*given):
        raise Exception("no closed loop")  # noqa: TRY002  # as gmsh's are

    monkeypatch.setattr("geometry.fingertip.build", fail)
    assert "gmsh cannot mesh the finger: no closed loop; try smaller" in refused(capsys, "mesh", "--out", "x.msh")
    monkeypatch.setattr("geometry.fingertip.build", lambda *given: 1 / 0)
    with pytest.raises(ZeroDivisionError):
        main(["mesh", "--out", "x.msh"])


def test_mesh_is_read_again_with_its_names(tmp_path, capsys):
    """Lengths in m, groups by name; a facet of 30 um takes 1 um off the tip of a ridge, of a radius of 0.12 mm."""
    import gmsh

    file = tmp_path / "finger.msh"
    assert main(["mesh", "--out", str(file), *(word for text in COARSE for word in ("--set", text))]) == 0
    assert "ridges that can touch" in capsys.readouterr().out
    gmsh.initialize(interruptible=False)
    try:
        gmsh.option.setNumber("General.Terminal", 0)
        gmsh.open(str(file))
        groups = {gmsh.model.getPhysicalName(*group) for group in gmsh.model.getPhysicalGroups()}
        y = gmsh.model.mesh.getNodes()[1].reshape(-1, 3)[:, 1]
    finally:
        gmsh.finalize()
    assert {"stratum corneum", "dermis", "bone rim", "outer skin", "ridge 0", "ridge -1"} <= groups
    assert y.min() == pytest.approx(0, abs=2e-6)
    assert y.max() == pytest.approx(Scene().geometry.height, rel=1e-3)  # chords of an ellipse
