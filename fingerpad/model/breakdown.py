"""Breakdown of air between skin and screen: a caution by the field in the gap of each ridge in contact.

A ridge's gap is its equivalent air gap d_eq, and the voltage across it is that of the circuit at each instant. It
breaks down by :func:`variational.roughness.gaps.breakdown_voltage`, in which the total voltage does not count.
Loads over time are looked at in their states. Where a state has the mean attraction of a drive, a period of the drive
counts, in its steady state. *Assumption*: skin beside the contact, and ridges above the screen, are not looked at.
"""

from collections.abc import Iterable, Iterator, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from fingerpad.model import drive_loads
from fingerpad.scene.drive import Drive, drive_of
from variational.roughness.gaps import breakdown_voltage
from variational.state import ContactState

if TYPE_CHECKING:
    from fingerpad.scene import Scene
    from fingerpad.scene.waveform import Waveform


_LIGHT = 1e4  # Pa, of a ridge at the edge of a contact, whose gap is the widest


class Across(NamedTuple):
    """Voltage across a gap."""

    where: str
    """Ridge or state, and the instant, in words."""
    gap: float
    """Air gap (m)."""
    volts: float
    """Largest amount of the voltage across it (V)."""

    @property
    def beyond(self) -> float:
        """The voltage over that of breakdown."""
        return self.volts / float(breakdown_voltage(self.gap))


def of_gaps(scene: "Scene", points: Iterable[tuple[str, float, float]]) -> list[str]:
    """Return the caution on the gap in which air is the farthest beyond breakdown.

    Args:
        scene: with the drive, or a voltage without losses.
        points: name of a ridge or a state, air gap (m), and voltage (V) of Eq. 3 where the scene has no drive.
    """
    drive, h_0 = scene.drive, scene.h_0
    return _caution(
        Across(name, gap, abs(voltage) * gap / (gap + h_0)) if drive is None else _over_period(drive, name, gap)
        for name, gap, voltage in points
    )


def ahead(scene: "Scene") -> list[str]:
    """Return the caution on the loads of a scene before anything is solved, in the gap of a ridge under 10 kPa.

    Ridges at the edge of a contact bear as little. Their gaps are the widest, and have the largest part of the voltage.
    """
    gap, name = float(scene.closure()(_LIGHT).d_eq), f"a ridge under {_LIGHT * 1e-3:g} kPa"
    if scene.drive is not None:
        return _caution([_over_period(scene.drive, name, gap)])
    share = drive_loads.gap_factor(scene)
    part = gap / (gap + scene.h_0) * (1.0 if share is None else float(share(gap)))
    found = [Across(name, gap, abs(load.level) * part) for load in scene.loads() if load.level]
    waves = [load.wave for load in scene.loads() if load.wave is not None]
    drives = (drive_of(wave, scene.electric, scene.geometry.sc_thickness) for wave in waves)
    return _caution([*found, *(_over_period(drive, name, gap) for drive in drives)])


def of_states(scene: "Scene", states: Iterable[ContactState]) -> list[str]:
    """Return the caution on the ridge in contact in whose gap air is the farthest beyond breakdown, with the instant.

    Args:
        scene: that the full model follows.
        states: in any order; those without a voltage or values by ridge have none.
    """
    charged = [state for state in states if state.voltage and state.ridges is not None]
    return _caution([*_instants(scene, charged), *_periods(scene, charged)])


def _caution(points: Iterable[Across]) -> list[str]:
    worst = max(points, key=lambda each: each.beyond, default=None)
    if worst is None or not worst.beyond > 1:
        return []
    return [
        f"{worst.volts:.4g} V are across a gap of {1e6 * worst.gap:.3g} µm in {worst.where}, and from "
        f"{float(breakdown_voltage(worst.gap)):.4g} V on air breaks down there, which is not in this model"
    ]


def _over_period(drive: Drive, name: str, gap: float) -> Across:
    period = np.abs(drive.across(gap))
    when = int(period.argmax()) / len(period) / drive.frequency
    return Across(f"{name} {when:.3g} s after the start of a period", gap, float(period.max()))


def _instants(scene: "Scene", states: Sequence[ContactState]) -> Iterator[Across]:
    """Yield the farthest gap of each state at its voltage."""
    share, loads = drive_loads.gap_factor(scene), scene.loads()
    for state in states:
        touching, gaps = _touching(state)
        if not len(gaps):
            continue
        volts = abs(state.voltage) * (1.0 if share is None else share(gaps)) * gaps / (gaps + scene.h_0)
        k = int(np.argmax(volts / breakdown_voltage(gaps)))
        timed = 0 < state.load_number <= len(loads) and loads[state.load_number - 1].takes_time
        when = f" at {state.time:.4g} s" if timed else ""
        yield Across(f"ridge {touching[k]} in {state.load!r}, step {state.step}{when}", gaps[k], volts[k])


def _periods(scene: "Scene", states: Sequence[ContactState]) -> Iterator[Across]:
    """Yield the narrowest and the widest gap under each drive of which states have the mean attraction.

    One of the two is the farthest beyond breakdown: the voltage across a gap rises with it, and the field falls.
    """
    of_wave = dict["Waveform", list[tuple[float, str]]]()
    for state in states:
        wave = _averaged(scene, state)
        if wave is not None:
            places = (f"ridge {number} in {state.load!r}, step {state.step}," for number in _touching(state)[0])
            of_wave.setdefault(wave, []).extend(zip(map(float, _touching(state)[1]), places, strict=True))
    for wave, found in of_wave.items():
        drive = drive_of(wave, scene.electric, scene.geometry.sc_thickness)
        for gap, where in {min(found), max(found)} if found else ():
            yield _over_period(drive, where, gap)


def _averaged(scene: "Scene", state: ContactState) -> "Waveform | None":
    """Return the drive of which a state has a mean; None where its voltage is that of an instant."""
    if scene.drive is not None:
        return scene.drive.wave
    loads = scene.loads()
    wave = loads[state.load_number - 1].wave if 0 < state.load_number <= len(loads) else None
    return wave if wave is not None and (scene.electric.follows == "mean" or wave.carrier is not None) else None


def _touching(state: ContactState) -> tuple[np.ndarray, np.ndarray]:
    """Return number and air gap (m) of the ridges in contact."""
    assert state.ridges is not None
    inside = state.ridges.length > 0
    return state.ridges.number[inside], state.ridges.d_eq[inside]
