"""The targets of a load: one, or those between the samples of a voltage over time; and the loads to normal contact."""

from dataclasses import replace
from functools import partial
from itertools import pairwise

from fingerpad.scene import Load
from fingerpad.scene.wavefile import Sample
from fingerpad.scene.waveform import Waveform
from variational.solvers.target import Target

_BEGIN = 60e-6  # m, with which a slide begins


def targets(load: Load, x: float, step_scale: float) -> list[Target]:
    """Return what to reach for a load, one after the other.

    Args:
        load: the load.
        x: where the bone is (m).
        step_scale: see ``numerics.step_scale``.
    """
    place = load.place(x)
    seconds = load.seconds(0.0 if place is None else place - x)
    if load.wave is None:
        until = load.until_full_slip
        return [Target(load.name, load.f_ext, load.bone_height, load.level, place, until, duration=seconds)]
    samples = load.wave.samples(seconds, step_scale)
    found, jumped = [Target(load.name, voltage=samples[0][1])], 0.0
    for sample, after in pairwise(samples):
        (before, _), (time, voltage) = sample, after
        aim = place
        if place is not None and time < seconds:
            aim = x + time / seconds * (place - x)
        begins = len(found) == 1 and aim is not None and abs(aim - x) > step_scale * _BEGIN
        continues = time > before and not begins  # what jumps, or begins with a long slide, is cut into steps
        inside = partial(_voltage, load.wave, sample, after) if time > before else None
        piece = Target(load.name, voltage=voltage, bone_x=aim, voltage_at=inside, continues=continues)
        jumped = before if time == before else jumped
        found.append(replace(piece, duration=time - before, since=before - jumped))
    return found


def _voltage(wave: Waveform, before: Sample, after: Sample, part: float) -> float:
    """Return the voltage (V) at a part of the time between two samples."""
    return wave.between(before, after, before[0] + part * (after[0] - before[0]))


def loads_to_normal_contact(loads: tuple[Load, ...]) -> tuple[Load, ...]:
    """Return the loads before the bone first moves sideways with the finger pressed."""
    pressed, place = False, 0.0
    for k, load in enumerate(loads):
        to = load.place(place)
        x = place if to is None else to
        if load.f_ext is not None or load.bone_height is not None:
            pressed = (load.f_ext or 0.0) > 0 or (load.bone_height or 0.0) < 0
        if pressed and x != place:
            return loads[:k]
        place = x
    return loads
