"""Fingers by name: sets of keys that ``finger`` gives, each with its source.

::

    finger = "fitted"
    friction = 0.3         # a key that is given wins over that of the name

``"paper"`` is the default finger, that of Forsbach et al. 2023, and gives no key. ``"fitted"``, ``"moist"`` and
``"held"`` are one finger in three states: dry, moist, and after 10 s or more on glass. Their geometry, moduli,
roughness and shear stress are fitted to rows of ``data/findings.toml`` that only fit (:attr:`NamedFinger.fitted_to`).
The other names change the fitted finger by what was measured of such people. A value is from a source that is cited,
or it is marked as an *assumption*; of most sources the abstract alone was read, and the text says so.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType
from typing import Any, Literal

from geometry.parameters import Fingertip

PAPER = "paper"
FingerName = Literal["paper", "fitted", "moist", "held", "woman", "child", "old", "callused", "dry"]
_LAYERS = ("sc_thickness", "ve_thickness", "dermis_thickness", "merkel_offset", "meissner_offset")
_OF_RIDGES = (*_LAYERS, "ridge_amplitude", "intermediate_ridge_height", "limiting_ridge_height")
_OF_SIZE = (
    *("width", "height", "bone_width", "bone_height", "bone_centre"),
    *("nail_thickness", "nail_half_width", "nail_bed_half_width"),
)
_SC = 300e-6  # m, stratum corneum of the fitted finger
_PAD = 28e-3  # m, radius and length of the default pad along the finger
SOFT = {"subcutis": 2.5e3, "dermis": 6.7e3, "viable_epidermis": 0.5e6, "stratum_corneum": 0.5e6}
"""Shear moduli (Pa) of the fitted finger's soft layers."""
_SHEAR = 14e3  # Pa, of wet ridges
AIR_GAP = {
    "BearingArea": 2.69e-6,
    "BoundaryElements": 8.09e-6,
    "Persson": 6.81e-6,
    "BoundaryElements, no field in contact": 3.86e-6,
    "Persson, no field in contact": 4.29e-6,
}
"""Rms heights (m) by closure with which a fitted ridge has an air gap of 2 µm under a mean contact pressure of 18 kPa,
that of 1 N, on 300 µm of stratum corneum."""


def on_roughness(law: str, field_in_contact: bool = True) -> str:
    """Return the key of a closure in :data:`AIR_GAP`."""
    return law if field_in_contact else f"{law}, no field in contact"


_RIDGES = (
    "Prints of Králík and Novotný 2003 (Variability and Evolution 11, 5 to 30), whose data were read in the repository "
    "andburch/bayesianfingerprintr"
)
_STIFFNESS = '"Age and gender effect on human tactile perception, in vivo", abstract, with doi 10.1098/rsos.170321'
_MOISTURE = "Yuan and Verma 2006, Colloids and Surfaces B 48, 6 to 12, abstract"
_FRICTION = "Buchholz, Frederick and Armstrong 1988, Ergonomics 31, 317 to 325, as tabled on a page of the authors"
NOT_MEASURED = (
    "No one finger was measured for these values: they are from several sources, fitted, or assumed (docs/fingers.md)."
)
MOISTURE = (
    f"{NOT_MEASURED} Moisture raises the attraction of a constant voltage here, without losses; people with moist "
    "fingers needed a higher voltage to feel it (arXiv 2409.16936)."
)


@dataclass(frozen=True)
class Trait:
    """Some keys of a finger that have one source."""

    values: Mapping[str, Any]
    """Values by dotted key, in SI units."""
    source: str
    """Where they are from; begins with "Assumption" where no source gives them."""
    rows: tuple[str, ...] = ()
    """Rows of ``data/findings.toml`` to which the values are fitted."""


@dataclass(frozen=True)
class NamedFinger:
    """A finger with a name."""

    words: str
    """Who it is."""
    traits: tuple[Trait, ...] = ()
    """Its keys; of two traits with one key the later holds."""
    remark: str = NOT_MEASURED
    """What a reader must know of its numbers, a sentence; empty for none."""

    @property
    def values(self) -> dict[str, Any]:
        """All of its values by dotted key."""
        return {key: value for trait in self.traits for key, value in trait.values.items()}

    def values_with(self, closure: str) -> dict[str, Any]:
        """Return the values with the rms height of a closure, a key of :data:`AIR_GAP`."""
        values = self.values
        return values | ({_H_RMS: AIR_GAP.get(closure, values[_H_RMS])} if _H_RMS in values else {})

    @property
    def fitted_to(self) -> tuple[str, ...]:
        """Rows of ``data/findings.toml`` to which values of the finger are fitted."""
        return tuple(dict.fromkeys(row for trait in self.traits for row in trait.rows))


_H_RMS = "roughness.h_rms"


def _round(value: float) -> float:
    return float(f"{value:.3g}")


def _shape(ridges: float, size: float) -> dict[str, float]:
    """Return the fitted finger's lengths but the ridges' distance, in parts of its own."""
    default = Fingertip(sc_thickness=_SC)
    lengths = {name: ridges * getattr(default, name) for name in _OF_RIDGES}
    lengths |= {name: size * getattr(default, name) for name in _OF_SIZE}
    pad = {f"slices.{name}": size * _PAD for name in ("radius", "length")}
    return {key: _round(value) for key, value in ({f"geometry.{k}": v for k, v in lengths.items()} | pad).items()}


def _moduli(factor: float = 1.0) -> dict[str, float]:
    """Return the shear moduli of the soft layers, in parts of the fitted ones."""
    return {f"materials.{layer}.shear_modulus": _round(factor * value) for layer, value in SOFT.items()}


def _surface(young: float, tissue: str, leak: str) -> dict[str, Any]:
    """Return what moisture changes of a ridge's surface and of its circuit."""
    return {"roughness.young": young, "electric.tissue": tissue, "electric.leak": leak}


_OF_SURFACE = (
    f"Dry stratum corneum is ten times as stiff as moist one ({_MOISTURE}). Assumption: the fitted finger is halfway "
    "between the two, and the layer as a whole is unchanged. For drives: published constants of skin, and a leak that "
    "is a guess (docs/drive.md)"
)
_GEOMETRY = (
    Trait(
        {"geometry.ridge_profile": (1.0, -0.625, 0.27778, -0.08333, 0.01515, -0.00126)},
        "Tips −sin(t/2)^12, flat over half a ridge: in two sets of public prints ridges touch over 0.47 ± 0.10 and "
        "0.38 ± 0.07 of the gross area",
        ("share_db1", "share_db2"),
    ),
    Trait({"geometry.sc_thickness": _SC}, "Some 300 µm on a fingertip (doi 10.1098/rsif.2012.0467, a caption)"),
    Trait(
        _moduli(),
        "Young's moduli of stratum corneum and epidermis, across, are 1 to 2 MPa each, without a difference (Geerligs "
        "et al. 2011, abstract). Dermis over subcutis are as 40 over 15 kPa, measured on a forearm (Feng et al. 2022, "
        "abstract); both are 0.5 of that, fitted to depth and gross area under 1 N",
        ("gross_1n", "depth_1n"),
    ),
    Trait({_H_RMS: AIR_GAP["BearingArea"]}, "An air gap of 2 µm where ridges bear 18 kPa, for each closure", ("gap",)),
)
_DRY = (
    Trait({"friction": 0.25}, "Dry touchscreens, short contact", ("friction_input",)),
    Trait(_surface(1e6, "dry", "sliding dry"), _OF_SURFACE),
)
_WET = (
    Trait(
        {"friction": {"law": "Derjaguin", "mu_f": 0.0, "tau_0": _SHEAR, "p_reg": 1e3}},
        "One shear stress on all ridges in contact, by the friction of wet glass under 1 N",
        ("friction_wet",),
    ),
    Trait(_surface(0.32e6, "moist", "moist"), _OF_SURFACE),
)


def _differs(words: str, *traits: Trait, remark: str = NOT_MEASURED) -> NamedFinger:
    """Return a finger that differs from the fitted one."""
    return NamedFinger(words, (*_GEOMETRY, *_DRY, *traits), remark)


FINGERS = MappingProxyType(
    {
        PAPER: NamedFinger("the default finger, with the geometry and the materials of the paper", remark=""),
        "fitted": NamedFinger("a dry finger, fitted to measurements", (*_GEOMETRY, *_DRY)),
        "moist": NamedFinger("the fitted finger, sweating or wetted", (*_GEOMETRY, *_WET), MOISTURE),
        "held": NamedFinger("the fitted finger after 10 s or more on glass", (*_GEOMETRY, *_WET), MOISTURE),
        "woman": _differs(
            "a woman, 18 years or older",
            Trait({"geometry.ridge_wavelength": 441e-6}, f"Mean of 33 women; 23 men have 492 µm. {_RIDGES}"),
            Trait(
                _shape(0.913, 0.913),
                "Assumption: all lengths go with the distance of ridges, 0.913 of the fitted finger's",
            ),
            Trait(
                _moduli(1.17),
                f"Young's modulus is 17 % higher for women ({_STIFFNESS}). Assumption: in all soft layers alike, "
                "and the fitted finger is a man's",
            ),
        ),
        "child": _differs(
            "a child of 3 to 10 years",
            Trait({"geometry.ridge_wavelength": 354e-6}, f"Mean of 21 children of 4 to 10 years. {_RIDGES}"),
            Trait(
                _shape(0.733, 0.876) | {"geometry.ridge_count": 65},
                "Index fingers of 160 children of 3 to 10 years have a mean diameter, by girth, of 15 mm (doi "
                "10.1016/j.aanat.2010.03.002, abstract); the fitted finger has 17.1 mm. Assumption: outline, bone, "
                "nail and pad have this scale, 0.876, and layers that of the ridges, 0.733; as many ridges as "
                "cover the palmar half; stiffness, friction and roughness are the fitted finger's",
            ),
        ),
        "old": _differs(
            "a person of some 60 years or older",
            Trait(
                _moduli(1.27),
                "Surface waves on a man's finger take 3.2 m/s at 26 years and 3.6 m/s at 58, so that the modulus "
                f"grows by 27 % ({_STIFFNESS}). Assumption: in all soft layers alike",
            ),
            Trait(
                {"friction": 0.2, "roughness.young": 3.2e6},
                "Moisture and friction are lower (doi 10.1038/s41598-018-23688-6, abstract). Assumption: as those "
                "of the dry finger",
            ),
            remark=MOISTURE,
        ),
        "callused": _differs(
            "a finger with calluses, of manual work or strings",
            Trait(
                {"geometry.sc_thickness": 2 * _SC},
                "Assumption: twice the fitted finger's. No measured callus was read",
            ),
        ),
        "dry": _differs(
            "a finger drier than the fitted one",
            Trait(
                {"friction": 0.2},
                "Moist skin has 1.6 times the friction of dry skin: palms on paper, suede and tape have 1.56, 1.69 "
                f"and 1.61 ({_FRICTION}). Assumption: so on glass, with the fitted finger halfway between",
            ),
            Trait({"roughness.young": 3.2e6}, _OF_SURFACE),
            remark=MOISTURE,
        ),
    }
)
"""Fingers by name."""
assert tuple(FINGERS) == FingerName.__args__  # type: ignore[attr-defined]
