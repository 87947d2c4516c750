"""Laws of one's own beyond a run: limits of friction by other functions, and scenes that are read from files."""

from dataclasses import dataclass

import numpy as np
import pytest
import ufl

import fingerpad as fp
from fingerpad.io.result import Result
from fingerpad.scene import Scene, SceneError
from tests.small_finger import small
from tests.test_laws import OWN, Mine
from variational.contact.friction import Coulomb, Friction
from variational.materials.neo_hooke import NeoHooke


# -- limits ----------------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Cap(Friction):
    """A sharp limit, by the type of p as docs/laws.md has it."""

    mu_f: float = 0.5
    tau: float = 20e3

    def limit(self, p):
        least = ufl.min_value if isinstance(p, ufl.core.expr.Expr) else np.minimum
        return least(self.mu_f * p, self.tau)


@dataclass(frozen=True)
class Tanh(Friction):
    """Of NumPy alone."""

    def limit(self, p):
        return 1e3 * np.tanh(p / 1e3)


@pytest.mark.parametrize(("f_ext", "ratio"), [(200.0, 1.11), (2000.0, 1.02)])
def test_limit_with_other_functions_than_arithmetic(f_ext, ratio):
    """A cap that bears all along the contact: its strength is per reference area, which docs/laws.md compares."""
    scene = small(f_ext=f_ext, voltage=0.0, output={"receptors": False, "errors": False})
    slip = fp.run(scene, friction=Cap(10.0, 1e3)).full_slip
    assert slip.f_t / (1e3 * slip.contact_length) == pytest.approx(ratio, abs=0.01)


def test_limit_that_the_weak_form_cannot_take_is_refused():
    scene = small(output={"receptors": False, "errors": False})
    with pytest.raises(SceneError, match="the limit of the law Tanh cannot be put into the weak form"):
        fp.run(scene, friction=Tanh())


# -- read from files -------------------------------------------------------------------------------------------
def test_laws_of_a_read_scene_are_given_again_before_it_is_run(tmp_path):
    """It was run with the laws of its keys, without a word. What is given takes the place of a name; the rest stays."""
    kept = Scene().with_laws(**OWN).parameters()
    scene = Result.from_dict({"parameters": kept, "f_ext": 75.0, "voltage": 200.0}).scene
    assert scene.parameters() == kept and scene.replace(f_ext=10.0).parameters()["laws"] == kept["laws"]
    words = r"laws of its own \(closure, friction, materials.dermis\), of which its files have the names"
    for run in (
        lambda s: fp.run(s, model="cylinders"),
        lambda s: fp.sweep(s, tmp_path, model="cylinders", voltage=[1]),
    ):
        with pytest.raises(SceneError, match=words):
            run(scene)
    for law in (scene.closure, scene.friction_law, scene.solids):  # they answered by the keys
        with pytest.raises(SceneError, match=words):
            law()
    assert scene.with_laws(friction=0.3).friction_law() == Coulomb(0.3)
    two = OWN | {"materials": {"dermis": Mine(2.5e3, 6e4), "nail": NeoHooke(1e7)}}
    both = Result.from_dict({"parameters": Scene().with_laws(**two).parameters(), "f_ext": 75.0, "voltage": 0.0}).scene
    one = both.with_laws(materials={"dermis": Mine(2.5e3, 6e4)})
    assert one.parameters() == both.parameters() and set(one.laws.kept["materials"]) == {"nail"}
    part = scene.with_laws(friction=0.3, closure=OWN["closure"])
    assert part.friction == 0.3 and set(part.laws.kept) == {"materials"}
    assert scene.with_laws(**OWN).parameters() == kept and not scene.with_laws(**OWN).laws.kept
