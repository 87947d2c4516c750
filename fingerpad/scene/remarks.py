"""A scene in words: its laws, and remarks on values that can be run and may not be meant.

A voltage attracts as over lossless insulators, Eq. 3 of the paper. Skin conducts, and so does the air gap: below about
1 kHz the attraction falls with the frequency, and that of a constant voltage leaks away (Persson and Guo 2019, arXiv
1908.01140; measured by Meyer et al. 2013, ``docs/measured.md``). A constant voltage of a scene can be the rms value of
an alternating one, so that it has a note alone. The mean of a waveform is a constant voltage, and has a caution.
"""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import fields
from typing import TYPE_CHECKING, Any

import numpy as np

from fingerpad.scene.drive import drive_of, leak_in_words, remains
from fingerpad.scene.fingers import FINGERS, PAPER
from fingerpad.scene.law_keys import UnresolvedLaw
from fingerpad.scene.materials import LAYERS, adheres
from fingerpad.scene.messages import clip, show
from fingerpad.scene.presets import named, value_at
from fingerpad.scene.viscosity import elastic, viscous_layers
from variational.attraction.circuit import GapCircuit
from variational.caution import Caution
from variational.contact.friction import Coulomb, Friction

if TYPE_CHECKING:
    from fingerpad.scene.scene import Scene

LEAKAGE = (
    "Attraction is that of Eq. 3, and U is the rms voltage of an alternating drive. Skin that conducts and charge that "
    "leaks are left out. In the circuit of a dry finger µ_app by Eq. 3 is 46 % high at 10 Hz, 14 % low at 1 kHz and "
    "5 % high at 10 kHz (200 V rms, 75 N/m: docs/drive.md). A constant voltage leaks away."
)
"""Note on every result with a constant voltage; its numbers are ``left_out`` of docs/drive.json."""
_UNDER_A_DRIVE = (
    "The finger's tissue and leak have no effect without a drive, and under a drive a moist finger can need more "
    "of it than a dry one: compare fingers under one drive, as "
    'voltage = {waveform = "sine", rms = 150, frequency = 100}.'
)
_MEAN = 0.01  # of the peak: mean of a waveform that is none
_OF_SCENE = {"h_0": "m"}  # units of what laws take from the rest of a scene
_LARGE = 1e6  # SI, from which on a number of a law has a power of ten
_LONGEST = 100e-6  # m, lambda_0 of the paper (Table 3), and the default


# -- laws ----------------------------------------------------------------------------------------------
def coefficient(scene: "Scene") -> float | None:
    """Return the friction coefficient of Coulomb's law; None where the scene has another one."""
    return None if isinstance(scene.friction, UnresolvedLaw | Friction) else scene.friction


# -- in words ------------------------------------------------------------------------------------------
def used(scene: "Scene") -> dict[str, str]:
    """Return every law of a scene in words: its numbers in SI units, which are named where the law names them.

    Keys are the layers, ``contact``, ``friction``, ``attraction`` and ``closure``, and ``adhesion`` and ``mesh`` where
    one was given.
    """
    found = {layer: _words(getattr(scene.materials, layer)) for layer in LAYERS}
    found["contact"] = _words(scene.contact.law)
    friction = Coulomb(scene.friction) if isinstance(scene.friction, float) else scene.friction
    found["friction"] = _words(friction) if scene.friction else "none"
    charged = any(load.voltage for load in scene.loads())
    circuit = scene.electric.circuit(scene.geometry.sc_thickness)
    found["attraction"] = _call("electrostatic", {"h_0": scene.h_0}, _OF_SCENE) if charged else "none"
    if adheres(law := scene.adhesion):
        found["adhesion"] = _words(law) + ("" if isinstance(law, UnresolvedLaw) else f", {law.work:.3g} J/m²")
    found |= {} if circuit.lossless else {"circuit": circuit_in_words(circuit)}
    found["closure"] = _words(scene.roughness) if charged else "none"
    return found | ({} if scene.geometry.file is None else {"mesh": scene.geometry.file})


def _call(name: str, numbers: Mapping[str, Any], units: Mapping[str, str] | None = None) -> str:
    """Return a law by its name, with its numbers in brackets, each with its unit where that is known."""
    given = (f"{key}={_shown(value)} {(units or {}).get(key, '')}".rstrip() for key, value in numbers.items())
    return f"{name}({', '.join(given)})"


def _words(law: Any) -> str:
    if isinstance(law, UnresolvedLaw):
        return _call(str(law.table.get("law")), {k: v for k, v in law.table.items() if k not in ("law", "sha256")})
    if elastic(law) is not law:
        return f"{_words(elastic(law))}, {_words(law.viscosity)}"
    units = _OF_SCENE | {f.name: f.metadata["range"][2] for f in fields(law) if "range" in f.metadata}
    return _call(type(law).__name__, {f.name: getattr(law, f.name) for f in fields(law)}, units)


def _shown(value: Any) -> str:
    """Return a value of a law; a number has at most four digits, and ``scene.json`` all of them."""
    if isinstance(value, float) and (abs(value) >= _LARGE or float(f"{value:.4g}") != value):
        return f"{value:.4g}"
    return show(value) if isinstance(value, int | float | str | None) else clip(str(value))


# -- notes -----------------------------------------------------------------------------------------------
def _drives(scene: "Scene") -> list[Caution]:
    """Return of each drive how large it is by every measure, the circuit, and the constant voltage it counts as."""
    found = []
    for name, wave in scene.drives().items():
        drive = drive_of(wave, scene.electric, scene.geometry.sc_thickness)
        losses = "without losses (Eq. 3)" if drive.circuit.lossless else circuit_in_words(drive.circuit)
        volts = f"as a constant {drive.reference:.4g} V does without losses"
        found.append(Caution("drive", f"Drive {name}: {wave}, {losses}. {drive.measures()}, {volts}.", drive.reference))
    return found


def _constant_voltage(scene: "Scene") -> list[Caution]:
    """Return that a constant voltage leaks away, or what a circuit that leaks leaves of it; none at 0 V.

    Without losses a caution on an offset stands in its place.
    """
    circuit = scene.electric.circuit(scene.geometry.sc_thickness)
    if (
        scene.drive is not None
        or not any(load.level for load in scene.loads())
        or (circuit.lossless and _offset(scene))
    ):
        return []
    return [Caution("leakage", LEAKAGE if circuit.lossless else _remains_in_words(scene, circuit))]


NOTES = (_drives, _constant_voltage)
"""Each takes a scene and returns the notes on its voltage."""


def drive_in_short(scenes: Iterable["Scene"]) -> str:
    """Return which drive a search or a table of scenes means, such as "a voltage without losses (Eq. 3)"."""
    found = dict[str, None]()
    for scene in scenes:
        lossless = scene.electric.circuit(scene.geometry.sc_thickness).lossless
        if scene.drive is not None:
            found["a drive without losses" if lossless else "a drive with the losses of each finger's circuit"] = None
        elif scene.volts:
            found["a voltage without losses (Eq. 3)"] = None
    return " or ".join(found) or "no voltage"


def other_under_a_drive(scenes: Iterable["Scene"]) -> list[str]:
    """Return a sentence where a constant voltage is put on a finger whose circuit would lose it; none elsewhere."""
    constant = (scene for scene in scenes if scene.drive is None and scene.volts)
    loses = any(not scene.electric.circuit(scene.geometry.sc_thickness).lossless for scene in constant)
    return [_UNDER_A_DRIVE] if loses else []


def circuit_in_words(circuit: GapCircuit) -> str:
    """Return tissue and leak, with the range of the leak."""
    tissue = circuit.tissue if isinstance(circuit.tissue, str) else "tabled"
    return f"{tissue} stratum corneum, {leak_in_words(circuit)}"


def _remains_in_words(scene: "Scene", circuit: GapCircuit) -> str:
    first = f"A constant voltage attracts by Eq. 3, without losses. The circuit is {circuit_in_words(circuit)}."
    try:
        left = remains(scene.electric, scene.geometry.sc_thickness)
    except ValueError:
        return f"{first} A constant voltage leaks away in it."
    if left.decay == np.inf:
        return f"{first} After 0.1 s its attraction is {left.share:.2f} times that of Eq. 3, since the skin conducts."
    return (
        f"{first} Charge leaks with a time constant of {1e3 * left.decay:.3g} ms: after 0.1 s its attraction is "
        f"{left.share:.2g} times that of Eq. 3."
    )


def finger_in_words(scene: "Scene") -> list[str]:
    """Return who a scene's finger is, keys of its name with other values, and its remark; none of the default one."""
    if scene.finger == PAPER:
        return []
    finger, other = FINGERS[scene.finger], _changed(scene)
    more = f"; otherwise: {', '.join(other)}" if other else ""
    count = len(finger.values) - len(other)
    words = f"finger {scene.finger}, {finger.words}: {count} keys by its name (docs/fingers.md){more}"
    rows = f"its values are fitted to {', '.join(finger.fitted_to)} of data/findings.toml"
    return [words, rows, finger.remark]


def _changed(scene: "Scene") -> list[str]:
    """Return the keys of the finger's name that have other values in the scene."""
    record = scene.parameters()
    return [key for key, usual in named(record).items() if value_at(record, key) != usual]


# -- cautions ------------------------------------------------------------------------------------------
def _offset(scene: "Scene") -> list[Caution]:
    """Return a caution on the waveform with the largest mean voltage; none where no mean reaches 1 % of its peak."""
    name, wave = max(scene.drives().items(), key=lambda each: abs(each[1].mean), default=("", None))
    if wave is None or abs(wave.mean) < _MEAN * wave.peak or scene.electric.leak != "none":
        return []
    text = (
        f"the drive {name} has a mean of {wave.mean:.4g} V, which leaks away in a real finger; here it "
        "attracts all the time, without leakage (Eq. 3), so that the attraction is too large"
    )
    return [Caution("offset", text, wave.mean)]


def _nothing_relaxes(scene: "Scene") -> Iterator[Caution]:
    """Yield a caution on viscous layers and on friction with a memory where no load takes time."""
    in_time = any(load.takes_time for load in scene.loads())
    for layer in () if in_time else viscous_layers(scene.materials)[:1]:
        text = (
            f"{layer}.viscosity is given and no load takes time, so that nothing will relax and viscous layers have "
            "their modulus at once; give loads of a history a duration or a speed"
        )
        yield Caution("nothing_relaxes", text)
    if isinstance(scene.friction, Friction):
        yield from scene.friction.cautions(in_time)


def _name_without_effect(scene: "Scene") -> list[Caution]:
    """Return a caution where all keys of a finger's name are given otherwise."""
    values = FINGERS[scene.finger].values
    if not values or len(_changed(scene)) < len(values):
        return []
    words = f"finger is {show(scene.finger)} and all of its keys are given with other values: the name has no effect"
    return [Caution("finger_name", words)]


def _roughness(scene: "Scene") -> list[Caution]:
    """Return the cautions on the waves of a roughness; none of a closure of one's own, or of a mesh of a file."""
    if scene.geometry.file is not None or not getattr(scene.roughness, "shared", ()):
        return []
    longest = scene.roughness.wavelength  # type: ignore[attr-defined]
    return on_waves(longest, longest, scene.geometry.ridge_wavelength)


CHECKS = (_offset, _nothing_relaxes, _name_without_effect, _roughness)
"""Each takes a scene and returns its cautions."""


def on_waves(wavelength: float, longest: float, ridge_wavelength: float) -> list[Caution]:
    """Return cautions on a roughness that ridges may be part of, and on one without the paper's largest waves.

    *Assumption*: the first holds above half of the ridges' distance, the second below half of 100 µm. h_rms of a
    self-affine surface is then 0.6 of the whole one's or less.

    Args:
        wavelength: the largest one (m) of the roughness.
        longest: wave (m) that a height map can hold, its shorter side, or again the largest one.
        ridge_wavelength: distance (m) of ridges.
    """
    found = []
    if wavelength > ridge_wavelength / 2:
        text = (
            f"roughness.wavelength is {wavelength:.3g} m, above half of geometry.ridge_wavelength, "
            f"{ridge_wavelength:.3g} m: ridges or the finger's form may count as roughness; remove both from the "
            "height map, or take a smaller map on one ridge"
        )
        found.append(Caution("long_waves", text, wavelength))
    if longest < _LONGEST / 2:
        text = (
            f"roughness ends at waves of {longest:.3g} m, and skin has waves up to {_LONGEST:.3g} m: waves longer than "
            "a height map are missing in its h_rms, which depends on the size of the map; take a larger map"
        )
        found.append(Caution("short_waves", text, longest))
    return found
