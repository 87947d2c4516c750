"""Keys of a scene that contradict each other although each is within its own bounds."""

from collections.abc import Iterator, Mapping, Sequence
from numbers import Real
from typing import TYPE_CHECKING, Any

import numpy as np

from fingerpad.scene.load_names import FINAL_STATES, first_clash
from fingerpad.scene.messages import SceneError, clip, show
from fingerpad.scene.waveform import MOST, Waveform
from variational.roughness.bam import BearingArea

if TYPE_CHECKING:
    from fingerpad.scene.parameters import Accuracy, Load, Output

DEFAULT_HISTORY = ("f_ext", "voltage", "slide_length")
"""Keys of the default loads, which a history replaces."""
_MAX_DIFFERENCE = 1e-6  # relative difference of thicknesses that are the same
LARGEST_GAP = 1.0  # m, with which the attraction is as good as none


def refuse_contradictions(
    accuracy: "Accuracy | None",
    output: "Output",
    friction: Any,
    roughness: Any,
    history: Sequence["Load"] | None,
    given: Mapping[str, Any],
    step_scale: float,
) -> None:
    """Refuse the first contradiction between keys.

    Args:
        accuracy: table of the scene; None where no accuracy is asked for.
        output: table of the scene.
        friction: coefficient or law of friction, a key of the scene.
        roughness: table or closure of the scene.
        history: loads of the scene; None for press, charge and slide.
        given: the values of :data:`DEFAULT_HISTORY` that are given.
        step_scale: key of the numerics.

    Raises:
        ValueError: the keys, their values and the remedy.
    """
    _refuse_accuracy(accuracy, output, friction)
    _refuse_endless_gap(roughness)
    if history is not None:
        _refuse_history(history, given)
        _refuse_names(history if accuracy else ())
        _refuse_times(history, step_scale)
        _refuse_floating(history)


def refuse_beside_force(
    force: float | None, given: Mapping[str, Any], history: Sequence["Load"] | None, file: str | None
) -> None:
    """Refuse a force on the whole finger beside another one, beside loads of one's own or a mesh of one's own.

    Args:
        force: key of the scene (N).
        given: the values of :data:`DEFAULT_HISTORY` that are given.
        history: key of the scene.
        file: of a mesh.

    Raises:
        ValueError: the keys, their values and the remedy.
    """
    if force is None:
        return
    if "f_ext" in given:
        raise ValueError(
            f"force is {show(force)} N and f_ext is {show(given['f_ext'])} N/m; give one of the two: newtons on the "
            "whole finger, or newtons per metre at its centre"
        )
    if history is not None or file is not None:
        what = "history is given" if history is not None else f"geometry.file is {show(file)}"
        raise ValueError(
            f"force is {show(force)} N and {what}; a force on the whole finger is that of press, charge and slide of "
            "the scene's own geometry, so leave one of the two out"
        )


def _refuse_accuracy(accuracy: "Accuracy | None", output: "Output", friction: Any) -> None:
    """Refuse an accuracy of receptor sites that are not there, and of friction that is zero."""
    if accuracy is None:
        return
    for name in ("mu_app", "f_t") if friction == 0 else ():
        if (asked := getattr(accuracy, name)) is not None:
            raise ValueError(
                f"accuracy.{name} is {show(asked)} and friction is 0, with which the quantity is zero and has no "
                "relative accuracy; leave out one of the two"
            )
    if accuracy.sed is not None and not output.receptors:
        raise ValueError(
            f"accuracy.sed is {show(accuracy.sed)} and output.receptors is false, without which there are no "
            "sites; leave out one of the two"
        )


def _refuse_endless_gap(roughness: Any) -> None:
    """Refuse a roughness that holds the air gap of an unloaded ridge at more than a metre."""
    if not isinstance(roughness, BearingArea):
        return
    with np.errstate(all="ignore"):  # infinite where the surfaces no longer see each other
        gap = float(roughness(roughness.p_floor).d_eq)
    if not gap < LARGEST_GAP:
        raise ValueError(
            f"roughness.p_floor is {show(roughness.p_floor)}, where the air gap would be held at {gap:.3g} m; "
            f"it must be below {LARGEST_GAP:g} m: take a larger p_floor, or a smaller gamma or h_rms"
        )


def _refuse_history(history: Sequence["Load"], given: Mapping[str, Any]) -> None:
    """Refuse a history beside keys of the default loads, without a first height, or with two loads of one name."""
    for name, value in given.items():
        raise ValueError(
            f"{name} is {show(value)} and history is given too; with a history each load states its own values"
        )
    first = history[0]
    if first.f_ext is None and first.bone_height is None:
        raise ValueError(
            f"history[0].name is {show(first.name)}, with neither f_ext nor bone_height; "
            "the first load must give one of them"
        )
    clash = first_clash([load.name for load in history])
    if clash is not None:
        one, other = (show(history[k].name) for k in clash)
        raise ValueError(
            f"history[{clash[1]}].name is {other} and history[{clash[0]}].name is {one}; each load must have a "
            "name of its own, also where spaces become _ and letters have no case, since files are named by it"
        )


def _refuse_names(history: Sequence["Load"]) -> None:
    """Refuse a load whose files would be those of a state on the final mesh."""
    for k, load in enumerate(history):
        if first_clash([*FINAL_STATES, load.name]) is not None:
            raise ValueError(
                f"history[{k}].name is {show(load.name)} and accuracy is given, with which the state of that name has "
                "files of its own; take another name"
            )


def _refuse_floating(history: Sequence["Load"]) -> None:
    """Refuse loads that leave the bone neither held nor pressed nor attracted."""
    f_ext: float | None = None
    voltage = 0.0
    for key, load, way in ways(history):
        if load.f_ext is not None or load.bone_height is not None:
            f_ext = load.f_ext
        voltage = voltage if load.level is None else load.level
        if load.wave is not None:
            along = [value for _, value in load.wave.samples(load.seconds(way or 0.0), 1.0)]
            if f_ext == 0 and 0 in along:
                raise ValueError(
                    f"{key}.voltage goes through 0 while f_ext is 0, where nothing holds the skin on the screen; "
                    "it must have an offset above its amplitude, or an f_ext or bone_height be given before it"
                )
            voltage = along[-1]
        if f_ext == 0 and voltage == 0:
            raise ValueError(
                f"{key}.name is {show(load.name)}, which ends at f_ext 0 and voltage 0, where nothing holds "
                "the skin on the screen; one of the two must be greater than 0, or a bone_height be given"
            )


def ways(history: Sequence["Load"]) -> Iterator[tuple[str, "Load", float | None]]:
    """Yield the key of each load, the load, and how far the bone goes (m); None where the run decides that."""
    place: float | None = 0.0  # of the bone; None where a load before may have stopped early
    for k, load in enumerate(history):
        aim = place if place is None and load.bone_x is None else load.place(place or 0.0)
        still = load.bone_x is None and load.bone_x_by is None
        way = 0.0 if still else load.bone_x_by if load.bone_x_by is not None else None
        if way is None and aim is not None and place is not None:
            way = aim - place
        yield f"history[{k}]", load, way
        if not still:
            place = None if load.until_full_slip else aim


def _refuse_times(history: Sequence["Load"], step_scale: float) -> None:
    """Refuse waveforms whose length is not known before the run, or whose samples are too many or end too early."""
    for key, load, way in ways(history):
        if load.wave is None:
            continue
        if load.speed is not None and way is None:
            raise ValueError(
                f"{key}.bone_x is {show(load.bone_x)} after a load that may stop at full slip, so that the time of "
                "the waveform is not known; give bone_x_by, or a duration in place of speed"
            )
        if load.speed is not None and way == 0:
            raise ValueError(f"{key}.speed is {show(load.speed)} and the bone is there already; give a duration")
        _refuse_samples(key, load.wave, load.seconds(way or 0.0), step_scale)


def _refuse_samples(key: str, wave: Waveform, seconds: float, step_scale: float) -> None:
    """Refuse a waveform with too many samples, or a table that ends before its load."""
    if seconds > wave.end * (1 + 1e-9):
        raise ValueError(
            f"{key}.voltage has values up to {wave.end:g} s and the load takes {seconds:g} s; its times must go on to "
            "the end of the load"
        )
    samples = wave.count(seconds, step_scale)
    if samples > MOST:
        has, less = f"{seconds / wave.period:.4g} periods in {seconds:g} s", "a lower frequency, a shorter load"
        if wave.times is not None:
            has, less = f"{len(wave.times)} points", "fewer points, smaller changes between them"
        raise ValueError(
            f"{key}.voltage has {has}, some {samples:.4g} steps; there must be at most {MOST} of them: take {less} or "
            "a larger numerics.step_scale"
        )


def refuse_thickness(closure: Any, h_0: float) -> None:
    """Refuse a closure of another insulator than the one whose voltage attracts.

    Args:
        closure: a closure; one without a number ``h_0`` has no insulator of its own.
        h_0: effective insulator thickness of the attraction (m).

    Raises:
        ValueError: the two differ by more than roundoff.
    """
    own = getattr(closure, "h_0", h_0)
    if isinstance(own, Real) and abs(float(own) - h_0) > _MAX_DIFFERENCE * h_0:
        raise ValueError(
            f"the closure {type(closure).__name__} has h_0 = {float(own):.7g} m, and the attraction has an effective "
            f"insulator thickness h_0 of {h_0:.7g} m; the two must be the same"
        )


def refuse_beside_mesh(data: Mapping[str, Any]) -> None:
    """Refuse keys of a scene beside ``geometry.file`` that a run on that mesh does not read.

    Args:
        data: nested tables, as they were given.

    Raises:
        SceneError: the first of them.
    """
    shape = data.get("geometry")
    if not isinstance(shape, Mapping) or shape.get("file") is None:
        return
    sizes = data.get("mesh")
    given = [f"geometry.{key}" for key in shape if key not in ("file", "file_sha256", "sc_thickness")]
    given += [f"mesh.{key}" for key in sizes] if isinstance(sizes, Mapping) else []
    given += ["accuracy"] if data.get("accuracy") is not None else []
    if given:
        raise SceneError(
            f"{clip(given[0])} is given and geometry.file too, whose mesh has its own shape and sizes and cannot be "
            "refined; leave one of the two out"
        )
