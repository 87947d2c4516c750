"""The targets of a load: one, or those between the samples of a waveform; and the loads to normal contact."""

from dataclasses import replace
from functools import partial
from itertools import pairwise
from typing import Any

from fingerpad.scene import Load
from fingerpad.scene.controls import ends_of
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
    now = {"bone_x": x}
    name, wave = load.over_time or ("", None)
    aims: dict[str, Any] = {
        key.moves or each: getattr(load, each) + (now[key.moves] if key.moves else 0.0)
        for each, key in load.acting().items()
        if each != name
    }
    if wave is None:
        return [Target(load.name, until_full_slip=load.until_full_slip, duration=seconds, **aims)]
    samples = wave.samples(seconds, step_scale)
    first: dict[str, Any] = {name: samples[0][1]}
    found, jumped = [Target(load.name, **first)], 0.0
    for sample, after in pairwise(samples):
        (before, _), (time, value) = sample, after
        part = time / seconds if time < seconds else 1.0
        aim = {key: now[key] + part * (end - now[key]) if part < 1 else end for key, end in aims.items()}
        aim[name] = value
        begins = len(found) == 1 and abs(aim.get("bone_x", x) - x) > step_scale * _BEGIN
        continues = time > before and not begins  # what jumps, or begins with a long slide, is cut into steps
        along = {name: partial(_value, wave, sample, after)} if time > before else {}
        piece = Target(load.name, along=along, continues=continues, **aim)
        jumped = before if time == before else jumped
        found.append(replace(piece, duration=time - before, since=before - jumped))
    return found


def _value(wave: Waveform, before: Sample, after: Sample, part: float) -> float:
    """Return the value of a waveform at a part of the time between two samples."""
    return wave.between(before, after, before[0] + part * (after[0] - before[0]))


def loads_to_normal_contact(loads: tuple[Load, ...]) -> tuple[Load, ...]:
    """Return the loads before the bone first moves sideways with the finger pressed."""
    pressed, place = False, 0.0
    for k, load in enumerate(loads):
        to = load.place(place)
        x = place if to is None else to
        if load.f_ext is not None or load.bone_height is not None:
            pressed = ends_of(load.f_ext)[1] > 0 or ends_of(load.bone_height)[0] < 0
        if pressed and x != place:
            return loads[:k]
        place = x
    return loads
