"""Laws in a scene: closure, materials, friction and mesh, as objects or as tables, refused or used throughout."""

import json
from dataclasses import dataclass, fields

import numpy as np
import pytest
import ufl

import fingerpad as fp
from fingerpad.reduced import cylinders
from fingerpad.scene import CONTACT, Scene, SceneError, law_keys, load
from fingerpad.scene.keys import docstrings, every
from fingerpad.scene.materials import CLOSURES, FRICTION_LAWS, MATERIALS
from fingerpad.scene.reading import flat
from fingerpad.scene.remarks import used
from variational.coefficients import parameter
from variational.contact.formulation import Springs
from variational.contact.friction import Coulomb, Derjaguin, Friction
from variational.contact.penalty import Penalty
from variational.materials.material import Material
from variational.materials.neo_hooke import NeoHooke
from variational.materials.ogden import Ogden
from variational.materials.saint_venant import SaintVenant
from variational.roughness.bam import BearingArea
from variational.roughness.closure import AirGap, Closure

DERJAGUIN = Derjaguin(0.3, tau_0=5e3)


@dataclass(frozen=True)
class Held(Closure):
    """A constant gap, the least that a closure of one's own is."""

    gap: float = 2e-6

    def __call__(self, p_c):
        return AirGap(self.gap + 0 * np.asarray(p_c, dtype=float))


@dataclass(frozen=True)
class Saturating(Friction):
    """A friction law of one's own: it levels off at a shear strength."""

    mu_f: float
    t_most: float

    def limit(self, p):
        return self.mu_f * p / (1 + self.mu_f * p / self.t_most)


@dataclass(frozen=True)
class Mine(Material):
    shear_modulus: float
    bulk: float

    def energy(self, F):
        return self.shear_modulus / 2 * (ufl.det(F) ** (-2 / 3) * ufl.inner(F, F) - 3)


OWN = {"roughness": Held(), "materials": {"dermis": Mine(2.5e3, 6e4)}, "friction": Saturating(0.4, 2e4)}


# -- in the scene ----------------------------------------------------------------------------------------------


TABLES = {
    "roughness": {"law": f"{__name__}:Held", "gap": 2e-6},
    "materials": {"dermis": {"law": f"{__name__}:Mine", "shear_modulus": 2.5e3, "bulk": 6e4}},
    "friction": {"law": f"{__name__}:Saturating", "mu_f": 0.4, "t_most": 2e4},
}


@pytest.mark.parametrize(
    ("table", "given"),
    [
        (TABLES, OWN),
        ({"friction": {"law": "Derjaguin", "mu_f": 0.3, "tau_0": "5 kPa"}}, {"friction": DERJAGUIN}),
        ({"friction": {"mu_f": 0.4}}, {"friction": Coulomb(0.4)}),
        ({"materials": {"nail": {"law": "NeoHooke", "shear_modulus": 1e7}}}, {"materials": {"nail": NeoHooke(1e7)}}),
        ({"materials": {"nail": {"poisson": 0.2}}}, {"materials": {"nail": SaintVenant(170e6, 0.2)}}),
        ({"roughness": {"h_rms": "2 um"}}, {"roughness": BearingArea(Scene().h_0, h_rms=2e-6)}),
    ],
    ids=lambda value: "-".join(value),
)
def test_table_and_object_are_one_value(table, given):
    """By the way of a file too: what is written of either gives the same scene again."""
    scene = Scene(**table)
    assert scene == Scene(**given)
    assert Scene(**json.loads(json.dumps(scene.parameters(), allow_nan=False))) == scene


def test_laws_are_kept_by_changes():
    """A law in place of another one is a change like any other; a table of some parameters keeps the rest."""
    scene = Scene(**OWN)
    changed = scene.replace(friction=0.1)
    assert (changed.friction_law(), changed.closure()) == (Coulomb(0.1), Held())
    changed = scene.replace(friction={"mu_f": 0.2}, materials={"nail": NeoHooke(1e7)})
    assert changed.friction == Saturating(0.2, 2e4)
    assert (changed.materials.dermis, changed.materials.nail) == (Mine(2.5e3, 6e4), NeoHooke(1e7))
    assert changed.replace(friction={"law": "Derjaguin", "mu_f": 0.3, "tau_0": 5e3}).friction == DERJAGUIN


@dataclass(frozen=True)
class OfArrays(Mine):
    """A material written with NumPy's functions."""

    def energy(self, F):
        return self.shear_modulus * np.tanh(F[0, 0])


class NoData(Closure):
    def __call__(self, p_c):
        return AirGap(2e-6 + 0 * np.asarray(p_c, dtype=float))


@pytest.mark.parametrize(
    ("given", "sentence"),
    [
        ({"materials": {"dermis": NeoHooke(-1.0)}}, "dermis.shear_modulus is -1 Pa; it must be from 1 to 1e+12 Pa"),
        ({"materials": {"dermis": OfArrays(2.5e3, 6e4)}}, "materials.dermis: the energy of OfArrays"),
        ({"roughness": NoData()}, "NoData'; a law must be a @dataclass(frozen=True)"),
        ({"roughness": BearingArea(2e-6)}, "roughness.h_0 is 2e-06 and the scene has 5.13986"),
        ({"roughness": Held(-1e-6)}, "roughness: closure Held returns an air gap of -1e-06 m at a pressure of 0 Pa"),
        ({"friction": Derjaguin(0.3, -5e3)}, "friction.tau_0 is -5000 Pa; it must be 0 or from 0.001 to 1e+09 Pa"),
        ({"friction": Derjaguin(0.3, 1e9, 1e-3)}, "friction: the limit of Derjaguin(mu_f=0.3, tau_0=1000000000.0"),
        ({"friction": {"law": "Derjagun"}}, "friction.law is 'Derjagun'; it must be 'Coulomb', 'Derjaguin', "),
        ({"friction": {"law": "Derjaguin", "mu_f": 0.3}}, "friction.tau_0 is missing; it must be given"),
        ({"friction": {"mu_f": 0.3, "tau_0": 5e3}}, "friction.tau_0 is not a key of friction with the law Coulomb"),
    ],
)  # fmt: skip
def test_what_is_no_law_is_refused(given, sentence):
    with pytest.raises(SceneError) as error:
        Scene(**given)
    assert sentence in str(error.value)
    assert "\n" not in str(error.value)


@pytest.mark.parametrize("law", [NeoHooke, BearingArea, Coulomb, Penalty, Saturating, fp.Persson])
def test_unknown_parameter_is_refused_with_the_known_ones(law):
    """In one sentence, of laws of the package and of one's own."""
    names = ", ".join(field.name for field in fields(law))
    with pytest.raises(ValueError, match=f"^{law.__name__} has no parameter 'yong'; its parameters are {names}$"):
        law(yong=1e5)


@pytest.mark.parametrize("solid", [NeoHooke, Ogden, SaintVenant], ids=repr)
def test_incompressible_solid_is_refused(solid):
    values = {"shear_modulus": 2e3, "alpha": -14.0, "young": 1e6, "poisson": 0.5}
    law = solid(**{name: values[name] for name in law_keys.keys_of(solid)})
    with pytest.raises(SceneError, match="materials.dermis.poisson is 0.5; it must be from -0.9 to 0.4999"):
        Scene(materials={"dermis": law})
    with pytest.raises(ValueError, match="moduli that are divided by zero; poisson must be above -1 and below 0.5"):
        law.check()  # of a body


# -- recipes of CONTRIBUTING -----------------------------------------------------------------------------------
@dataclass(frozen=True)
class Softer(Mine):
    shear_modulus: float = parameter(1.0, 1e6, "Pa", default=2.5e3)
    """Shear modulus (Pa)."""
    bulk: float = parameter(1.0, 1e9, "Pa", default=6e4)
    """Bulk modulus (Pa)."""


@dataclass(frozen=True)
class Stuck(Saturating):
    mu_f: float = parameter(0.1, 1.0)
    """Coefficient."""
    t_most: float = parameter(1.0, 1e6, "Pa", default=2e4)
    """Strength (Pa)."""


@dataclass(frozen=True)
class Wide(Held):
    gap: float = parameter(1e-9, 1e-3, "m", default=2e-6)
    """Gap (m)."""


@dataclass(frozen=True)
class OneSpring(fp.Formulation):
    eps: float = parameter(1e7, 1e17, "Pa/m", default=1.5e12)
    """Stiffness (Pa/m)."""

    def springs(self, skin):
        return Springs(0.0, 0.0, skin.constant(self.eps), skin.constant(self.eps))


@pytest.mark.parametrize(
    ("kind", "law", "table", "key"),
    [
        (MATERIALS, Softer, {"materials": {"dermis": {"law": "Softer", "bulk": "60 kPa"}}}, "materials.dermis.bulk"),
        (FRICTION_LAWS, Stuck, {"friction": {"law": "Stuck", "mu_f": 0.4, "t_most": "20 kPa"}}, "friction.t_most"),
        (CLOSURES, Wide, {"roughness": {"law": "Wide", "gap": "2 um"}}, "roughness.gap"),
        (CONTACT.kind, OneSpring, {"contact": {"formulation": "OneSpring", "eps": "1.5e12 Pa/m"}}, "contact.eps"),
    ],
    ids=["material", "friction", "closure", "formulation"],
)  # fmt: skip
def test_law_of_the_package_is_one_line_of_a_registry(kind, law, table, key, monkeypatch):
    """Its name, units, ranges and words are those of scene files, refusals, the reference and fingerpad's names."""
    monkeypatch.setitem(kind.laws, law.__name__, law)
    scene = Scene(**table)
    assert law.__name__ in " ".join(used(scene).values()) and law in map(type, scene.laws().values())
    assert Scene(**json.loads(json.dumps(scene.parameters()))) == scene
    assert getattr(fp, law.__name__) is law
    assert any(law.__name__ in each.choices for each in every(Scene))
    assert docstrings(law).keys() >= law_keys.keys_of(law).keys()
    with pytest.raises(SceneError, match=f"{key} is '1 s'; its unit is not a unit of"):
        load(None, flat(table) | {key: "1 s"})
    if kind in (FRICTION_LAWS, CLOSURES):  # with others the contact length is another
        cylinders.solve(scene)


# -- scenes apart ----------------------------------------------------------------------------------------------
def test_parameters_tell_laws_apart(tmp_path):
    """Equal laws give equal text, other numbers or another class another; the mesh counts by what is in it."""
    file = tmp_path / "mine.msh"
    file.write_text("one", encoding="utf-8")
    given = [
        *({name: law} for name, law in OWN.items()),
        {"friction": Saturating(0.4, 3e4)},
        {"friction": Coulomb(0.4)},
        {"geometry": {"file": file}},
    ]
    scenes = [Scene(), *(Scene(**one) for one in given)]
    texts = [json.dumps(scene.parameters(), sort_keys=True, allow_nan=False) for scene in scenes]
    assert len(set(texts)) == len(texts)
    again = Scene(friction=Saturating(0.4, 20000))
    assert json.dumps(again.parameters(), sort_keys=True) == texts[3]
    file.write_text("other", encoding="utf-8")
    assert json.dumps(Scene(geometry={"file": file}).parameters(), sort_keys=True) != texts[-1]
