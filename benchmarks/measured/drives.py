"""Findings on the frequency and the waveform of a drive, through the circuit of the gap with one constant.

The constant is the leak R_gap. It puts the peak of the attraction at :data:`PEAK`, a published finding, and all other
rows are computed with it and the layers of the finger, unless a moist finger has a leak of its own. Rows that depend on
the gap are computed at all :data:`GAPS`, each with its own leak from the same peak.
"""

from functools import cache
from typing import Any

import numpy as np

from benchmarks.measured import rules
from benchmarks.measured.findings import Finding
from benchmarks.measured.fingers import VOLTAGES, Case, Computation, Finger, Row
from benchmarks.measured.rules import SIMILAR, STRIKING, by_factor, by_share
from fingerpad.reduced.detection import of_wave
from fingerpad.scene import Scene
from fingerpad.scene.drive import REFERENCE
from variational.attraction.circuit import GapCircuit, fit_leak
from variational.attraction.dielectric import VACUUM_PERMITTIVITY

PEAK = 250.0
"""Frequency (Hz) of the peak that sets the leak."""
GAPS = (1.0e-6, REFERENCE, 2.5e-6)
"""Gaps (m)."""
AMPLITUDES = (75.0, 150.0)  # V, of the data set
RISE = (10.0, 30.0, 100.0, 300.0, 1e3, 3e3, 1e4)  # Hz
BELOW, ABOVE = (15.0, 30.0, 45.0), (120.0, 240.0, 480.0)  # Hz, either side of the crossover of waveforms
SHAPE = (15.0, 30.0, 60.0, 120.0, 240.0, 480.0, 960.0, 1920.0)  # Hz
Layers = tuple[float, float, float, float]


def layers(gap: float, scene: Scene | None = None) -> Layers:
    """Return gap (m), d_i (m), eps_i and d_sc (m) of a scene, by default of the default one."""
    scene = scene or Scene()
    return gap, scene.electric.d_i, scene.electric.eps_i, scene.geometry.sc_thickness


@cache
def circuit(at: Layers, tissue: str = "dry") -> GapCircuit:
    """Return the circuit with the leak of dry skin that has its peak at :data:`PEAK` across layers."""
    return GapCircuit(tissue, fit_leak(PEAK, "dry", *at))


def _share(f: float | tuple[float, ...], at: Layers) -> rules.Array:
    return np.asarray(circuit(at).share(f, *at), dtype=np.float64)


def _all(finger: Finger) -> list[Layers]:
    return [layers(gap, finger.scene) for gap in GAPS]


def _here(finger: Finger) -> Layers:
    return layers(REFERENCE, finger.scene)


def _frequency(case: Case) -> Row:
    """Judge the change of mean friction and contact length from 30 to 230 Hz, at each force and amplitude.

    A sine has the friction of the constant voltage that attracts as much, between those of the runs.
    """
    at, lossless = _here(case.finger), GapCircuit("lossless").share(230.0, *_here(case.finger))
    squares = [[amplitude**2 / 2 * float(_share(f, at) / lossless) for f in (30.0, 230.0)] for amplitude in AMPLITUDES]
    changes = []
    for key in ("f_t", "contact_length"):
        values = case.finger.slips(key)
        ends = np.array([[np.interp(two, np.square(VOLTAGES), one) for two in squares] for one in values])
        changes.append(ends[..., 1] / ends[..., 0] - 1)  # of forces and amplitudes
    holds = np.abs(changes).max(axis=(0, 2)) <= SIMILAR
    force, length = (float(each.max()) for each in changes)
    share = float(_share(230.0, at) / _share(30.0, at) - 1)
    numbers = {"force": force, "length": length, "share": share, "holds": holds.sum(), "loads": holds.size}
    return numbers, by_share(float(holds.mean()))


def _frequency_wide(case: Case) -> Row:
    """Judge in how many steps attraction rises from 10 Hz to 10 kHz, at every gap."""
    found = np.array([_share(RISE, at) for at in _all(case.finger)])
    rises, ratio = float((np.diff(found, axis=1) > 0).mean()), found[:, -1] / found[:, 0]
    return {"low": ratio.min(), "high": ratio.max(), "rises": rises}, by_share(rises)


def _cut_off(case: Case) -> Row:
    """Judge whether a first-order high-pass misses attraction over 10 to 500 Hz."""
    f: rules.Array = np.geomspace(10, 500, 40, dtype=np.float64)
    fit = rules.of_largest(rules.high_pass, f, _share(tuple(f), _here(case.finger)))
    return {"misfit": fit.misfit, "cut": fit.parameter * 500}, by_share(float(fit.misfit > rules.MISFIT))


def _peak(case: Case) -> Row:
    peak = circuit(_here(case.finger)).peak(*_here(case.finger))
    leaks = [circuit(at).resistance for at in _all(case.finger)]
    return {"peak": peak, "low": leaks[0], "high": leaks[-1]}, by_factor(peak, peak, PEAK, PEAK, rules.RATIO)


def _peak_high(case: Case) -> Row:
    high = _share(tuple(np.geomspace(1e4, 1e6, 200)), _here(case.finger))
    second = bool(np.any((high[1:-1] > high[:-2]) & (high[1:-1] > high[2:])))
    return {"first": float(high[0]), "last": float(high[-1])}, by_share(float(second))


def _ratio(f: float, at: Layers) -> float:
    """Return the threshold of a square over that of a sine."""
    square, sine = (of_wave(circuit(at), wave, f, at) for wave in ("square", "sine"))
    return square.relative_to(sine)


def _square_below(case: Case) -> Row:
    f = np.geomspace(BELOW[0], ABOVE[0], 61)
    crossings = [float(np.interp(1.0, [_ratio(x, at) for x in f], f)) for at in _all(case.finger)]
    below = [_ratio(x, at) for at in _all(case.finger) for x in BELOW]
    numbers = {"low": min(crossings), "high": max(crossings), "least": min(below), "most": max(below)}
    return numbers, rules.by_rule(case.row, numbers["low"], numbers["high"])


def _square_above(case: Case) -> Row:
    above = np.array([_ratio(x, at) for at in _all(case.finger) for x in ABOVE])
    return {"low": above.min(), "high": above.max()}, by_share(float(np.mean(np.abs(above - 1) <= SIMILAR)))


def _threshold_shape(case: Case) -> Row:
    """Judge whether thresholds over the frequency have a least one inside, for a sine and for a square."""
    at, holds, numbers = _here(case.finger), list[bool](), dict[str, float]()
    for wave in ("sine", "square"):
        levels = [of_wave(circuit(at), wave, f, at) for f in SHAPE]
        found = np.array([level.relative_to(levels[0]) for level in levels])
        least = int(found.argmin())
        ends = min(found[0], found[-1]) / found[least]
        numbers |= {
            wave: SHAPE[least],
            f"{wave}_first": found[0] / found[least],
            f"{wave}_last": found[-1] / found[least],
        }
        holds.append(0 < least < len(SHAPE) - 1 and ends >= 1 + STRIKING)
    return numbers, by_share(sum(holds) / 2)


def _moist(case: Case) -> Row:
    """Judge whether moist skin needs a higher voltage, with the one constant; with its own leak it stands beside."""
    at, dry = (*BELOW, 60.0, *ABOVE), _here(case.every["fitted"])

    def ratios(moist: GapCircuit) -> rules.Array:
        both = [[of_wave(c, "sine", f, dry) for f in at] for c in (moist, circuit(dry))]
        return np.array([wet.relative_to(other) for wet, other in zip(*both, strict=True)])

    same, own = ratios(circuit(dry, "moist")), ratios(case.finger.scene.electric.circuit(dry[3]))
    numbers = {"low": same.min(), "high": same.max(), "own_low": own.min(), "own_high": own.max()}
    return numbers, by_share(float((same > 1).mean()))


def sliding(row: Finding, held: Finger, rest: Any, slides: Finger, slip: Any) -> Row:
    """Judge by how much the impedance of screen, gap and skin rises from rest to full slip.

    Args:
        row: the finding.
        held: finger at rest.
        rest: its air gap (m) and length in contact (m) at each force.
        slides: finger that slides.
        slip: its air gap and length at full slip.
    """
    ends = []
    for finger, (gap, length) in ((held, rest), (slides, slip)):
        own, at = finger.scene.electric, _here(finger)
        through = circuit(at) if own.leak == Scene().electric.leak else own.circuit(at[3])
        f = np.array(RISE)[:, None]
        gain = through.gain(f, gap, *at[1:])
        across = 1 / (2j * np.pi * f * VACUUM_PERMITTIVITY / gap + 1 / through.resistance)  # of the gap alone
        ends.append(np.abs(across / gain) / length)
    count = min(each.shape[1] for each in ends)
    found = ends[1][:, :count] / ends[0][:, :count]
    low, high = float(found.min()), float(found.max())
    return {"low": low, "high": high}, rules.by_rule(row, low, high)


def _direct(case: Case) -> Row:
    """Judge whether an alternating voltage attracts where a constant one no longer does."""
    at = _here(case.finger)
    return {"ac": float(_share(PEAK, at))}, by_share(float(abs(circuit(at).gain(0.0, *at)) == 0))


def _skin(case: Case) -> Row:
    """Judge the impedance of the stratum corneum, over the frequency or by its phase at 1 kHz."""
    skin = circuit(_here(case.finger)).dielectric
    z = 1 / np.array([complex(skin.conductivity(f)) for f in (1.0, 1e3)])
    ratio, phase = float(abs(z[0]) / abs(z[1])), float(np.angle(z[1], deg=True))
    value = ratio if case.row.unit == "" else phase
    return {"value": value, "phase_1": float(np.angle(z[0], deg=True))}, rules.by_rule(case.row, value, value)


_PARTS: tuple[Computation, ...] = (
    *(_frequency, _frequency_wide, _cut_off, _peak, _peak_high),
    *(_square_below, _square_above, _threshold_shape, _direct, _moist),
)
ROWS = {part.__name__[1:]: part for part in _PARTS} | dict.fromkeys(("skin_impedance", "skin_phase"), _skin)
"""Computations of findings by name."""
WITHOUT_RUNS = ROWS.keys() - {"frequency"}
