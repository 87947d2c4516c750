"""Findings on the frequency and the waveform of a drive, through the circuit of the gap with one constant.

The constant is the leak R_gap. It puts the peak of the attraction at :data:`PEAK`, a published finding, and all other
rows are computed with it, dry skin and the default screen. Rows that depend on the gap are computed at all
:data:`GAPS`, each with its own leak from the same peak.
"""

from functools import cache

import numpy as np

from benchmarks.measured import rules
from benchmarks.measured.rules import SIMILAR, by_factor, by_share
from benchmarks.runs import FORCES
from fingerpad.reduced import cylinders
from fingerpad.runs.drive import of_wave
from fingerpad.scene import Scene
from fingerpad.scene.drive import REFERENCE
from variational.attraction.circuit import LEAKS, GapCircuit, fit_leak
from variational.attraction.dielectric import VACUUM_PERMITTIVITY

PEAK = 250.0
"""Frequency (Hz) of the peak that sets the leak."""
GAPS = (1.0e-6, REFERENCE, 2.5e-6)
"""Gaps (m)."""
AMPLITUDES = (75.0, 150.0)  # V, of the data set
RISE = (10.0, 30.0, 100.0, 300.0, 1e3, 3e3, 1e4)  # Hz
BELOW, ABOVE = (15.0, 30.0, 45.0), (120.0, 240.0, 480.0)  # Hz, either side of the crossover of waveforms
_CROSSOVER = 60.0  # Hz
_SCENE = Scene()
Row = tuple[dict[str, float], str]


def layers(gap: float) -> tuple[float, float, float, float]:
    """Return gap (m), d_i (m), eps_i and d_sc (m) of the default screen and finger."""
    electric = _SCENE.electric
    return gap, electric.d_i, electric.eps_i, _SCENE.geometry.sc_thickness


@cache
def circuit(gap: float = REFERENCE, tissue: str = "dry") -> GapCircuit:
    """Return the circuit with the leak of dry skin that has its peak at :data:`PEAK` across a gap (m)."""
    return GapCircuit(tissue, fit_leak(PEAK, "dry", *layers(gap)))


def _share(f: float | tuple[float, ...], gap: float = REFERENCE) -> rules.Array:
    return np.asarray(circuit(gap).share(f, *layers(gap)), dtype=np.float64)


def _small() -> Row:
    """Judge the change of mean friction and contact length from 30 to 230 Hz, at each load and amplitude."""
    electric = {"tissue": "dry", "leak": circuit().resistance}
    changes = []
    for force in FORCES:
        for amplitude in AMPLITUDES:
            slow, fast = (_slip(force, amplitude, f, electric) for f in (30.0, 230.0))
            changes.append([fast[k] / slow[k] - 1 for k in (0, 1)])
    found = np.array(changes).reshape(len(FORCES), -1)
    holds = np.abs(found).max(axis=1) <= SIMILAR
    force, length = (np.array(changes)[:, k].max() for k in (0, 1))
    share = float(_share(230.0) / _share(30.0) - 1)
    return {"force": force, "length": length, "share": share, "holds": holds.sum(), "loads": len(FORCES)}, by_share(
        float(holds.mean())
    )


def _slip(force: float, amplitude: float, frequency: float, electric: dict[str, object]) -> tuple[float, float]:
    drive = {"waveform": "sine", "amplitude": amplitude, "frequency": frequency}
    state = cylinders.solve(Scene(f_ext=force, voltage=drive, electric=electric)).full_slip
    assert state is not None
    return state.f_t, state.contact_length


def _wide() -> Row:
    """Judge in how many steps attraction rises from 10 Hz to 10 kHz, at every gap."""
    found = np.array([_share(RISE, gap) for gap in GAPS])
    rises = (np.diff(found, axis=1) > 0).mean()
    numbers = {"low": (found[:, -1] / found[:, 0]).min(), "high": (found[:, -1] / found[:, 0]).max()}
    return numbers | {"rises": float(rises)}, by_share(float(rises))


def _cut_off() -> Row:
    """Judge whether a first-order high-pass misses attraction over 10 to 500 Hz."""
    f: rules.Array = np.geomspace(10, 500, 40, dtype=np.float64)
    fit = rules.of_largest(rules.high_pass, f, _share(tuple(f)))
    return {"misfit": fit.misfit, "cut": fit.parameter * 500}, by_share(float(fit.misfit > rules.MISFIT))


def _peaks() -> dict[str, Row]:
    f = np.geomspace(1e4, 1e6, 200)
    high = _share(tuple(f))
    inside = high[1:-1]
    second = bool(np.any((inside > high[:-2]) & (inside > high[2:])))
    at = circuit().peak(*layers(REFERENCE))
    leaks = [circuit(gap).resistance for gap in GAPS]
    return {
        "peak": ({"peak": at, "low": leaks[0], "high": leaks[-1]}, by_factor(at, at, PEAK, PEAK, rules.RATIO)),
        "peak_high": ({"first": float(high[0]), "last": float(high[-1])}, by_share(float(second))),
    }


def _ratio(f: float, gap: float) -> float:
    """Return the threshold of a square over that of a sine."""
    square, sine = (of_wave(circuit(gap), wave, f, layers(gap)) for wave in ("square", "sine"))
    return square.relative_to(sine)


def _waveform() -> dict[str, Row]:
    f = np.geomspace(BELOW[0], ABOVE[0], 61)
    crossings, below, above = [], [], []
    for gap in GAPS:
        ratio = np.array([_ratio(x, gap) for x in f])
        crossings.append(float(np.interp(1.0, ratio, f)))
        below += [_ratio(x, gap) for x in BELOW]
        above += [_ratio(x, gap) for x in ABOVE]
    low, high = min(crossings), max(crossings)
    similar = float(np.mean(np.abs(np.array(above) - 1) <= SIMILAR))
    return {
        "square_below": (
            {"low": low, "high": high, "least": min(below), "most": max(below)},
            by_factor(low, high, _CROSSOVER, _CROSSOVER, rules.RATIO),
        ),
        "square_above": ({"low": min(above), "high": max(above)}, by_share(similar)),
    }


def _moist() -> Row:
    """Judge whether moist skin needs a higher voltage, with the one constant; the preset stands beside."""
    at = (*BELOW, _CROSSOVER, *ABOVE)

    def ratios(moist: GapCircuit) -> rules.Array:
        both = [[of_wave(c, "sine", f, layers(REFERENCE)) for f in at] for c in (moist, circuit())]
        return np.array([wet.relative_to(dry) for wet, dry in zip(*both, strict=True)])

    same, preset = ratios(circuit(tissue="moist")), ratios(GapCircuit("moist", "moist"))
    numbers = {"low": same.min(), "high": same.max(), "preset_low": preset.min(), "preset_high": preset.max()}
    return numbers | {"leak": LEAKS["moist"].value}, by_share(float((same > 1).mean()))


def sliding(rest: tuple[rules.Array, rules.Array], slip: tuple[rules.Array, rules.Array]) -> Row:
    """Judge by how much the impedance of screen, gap and skin rises from rest to full slip.

    Args:
        rest: air gap (m) and length in contact (m) at each force and voltage.
        slip: the same at full slip.
    """
    ends = []
    for gap, length in (rest, slip):
        f, g = np.array(RISE)[:, None], gap.ravel()
        gain = circuit().gain(f, g, *layers(REFERENCE)[1:])
        across = 1 / (2j * np.pi * f * VACUUM_PERMITTIVITY / g + 1 / circuit().resistance)  # of the gap alone
        ends.append(np.abs(across / gain) / length.ravel())
    found = ends[1] / ends[0] - 1
    low, high = float(found.min()), float(found.max())
    numbers = {"low": low, "high": high, "leak": circuit().resistance}
    return numbers, by_factor(max(low, 1e-9), max(high, 1e-9), 1.0, 10.0, rules.RATIO)


def _constant() -> Row:
    """Judge whether an alternating voltage attracts where a constant one no longer does."""
    return {"ac": float(_share(PEAK))}, by_share(float(abs(circuit().gain(0.0, *layers(REFERENCE))) == 0))


def numbers() -> dict[str, Row]:
    """Return our numbers and the verdict of every row on drives, by its key."""
    found = {"frequency": _small(), "frequency_wide": _wide(), "cut_off": _cut_off(), "moist": _moist()}
    return {**found, **_peaks(), **_waveform(), "direct": _constant()}
