"""Laws of one's own in the reduced models, and in the rule of thumb."""

import pytest

from fingerpad.model import feasibility
from fingerpad.reduced import cylinders
from fingerpad.scene import Scene, SceneError, remarks
from tests.test_laws import DERJAGUIN, OWN, Held
from variational.contact.friction import Coulomb, Derjaguin
from variational.materials.neo_hooke import NeoHooke
from variational.materials.ogden import Ogden


def test_cylinders_take_any_friction_law():
    """f_T is the limit at each state's mean pressure over its length. Tolerance: roundoff."""
    for law in (DERJAGUIN, OWN["friction"], Coulomb(0.25)):
        slip = cylinders.solve(Scene(friction=law)).full_slip
        length = slip.contact_length
        assert slip.f_t == pytest.approx(law.limit(slip.f_contact / length) * length, rel=1e-14)
        assert slip.mu_app == pytest.approx(slip.f_t / 75.0, rel=1e-14)


def test_cylinders_take_any_closure():
    """Each ridge is Maugis's cylinder at the closure's own gap."""
    found = cylinders.solve(Scene(roughness=Held()))
    assert found.record["full_slip_d_eq"] == 2e-6
    assert found.full_slip.f_electrostatic != cylinders.solve(Scene()).full_slip.f_electrostatic


def test_cylinders_know_the_default_fingers_lengths_alone():
    scene = Scene(materials={"stratum_corneum": NeoHooke(1e5)})
    with pytest.raises(SceneError, match="materials is not that of the default finger, whose contact length is known"):
        cylinders.solve(scene)
    given = cylinders.given(1.5e-3, 15)
    own, default = (cylinders.solve(one, given).full_slip.f_electrostatic for one in (scene, Scene()))
    assert own != default


def test_modulus_of_the_skin_is_the_given_materials():
    """The same solid given as a key and as an object has the same modulus. Tolerance: roundoff."""
    own = Scene(materials={"stratum_corneum": Ogden(86.76e3, -14.53, 0.48)})
    assert remarks.skin_modulus(own) == pytest.approx(remarks.skin_modulus(Scene()), rel=1e-12)


def test_rule_of_thumb_takes_a_law():
    """More friction rolls the finger further, by the coefficient at a ridge's pressure."""
    plain, rough = (feasibility.by_rule(Scene(friction=law)) for law in (Coulomb(0.25), Derjaguin(0.25, 2e4)))
    assert rough.mesh.touching_half_arc > plain.mesh.touching_half_arc


def test_cylinders_take_no_mesh(tmp_path):
    (tmp_path / "mine.msh").touch()
    with pytest.raises(SceneError, match="geometry.file"):
        cylinders.solve(Scene(geometry={"file": tmp_path / "mine.msh"}))
