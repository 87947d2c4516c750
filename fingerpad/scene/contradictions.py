"""Keys of a scene that contradict each other although each is within its own bounds."""

from collections.abc import Mapping, Sequence
from typing import Any

from fingerpad.scene.load_names import first_clash
from fingerpad.scene.materials import Roughness
from fingerpad.scene.messages import show
from fingerpad.scene.parameters import Accuracy, Load, Output

DEFAULT_HISTORY = ("f_ext", "voltage", "slide_length")
"""Keys of the default loads, which a history replaces."""
LARGEST_GAP = 1.0  # m, with which the attraction is as good as none


def refuse_contradictions(
    accuracy: Accuracy | None,
    output: Output,
    roughness: Roughness,
    h_0: float,
    history: Sequence[Load] | None,
    given: Mapping[str, Any],
) -> None:
    """Refuse the first contradiction between keys.

    Args:
        accuracy: table of the scene, likewise ``output``, ``roughness`` and ``history``.
        output: see there.
        roughness: see there.
        h_0: effective insulator thickness (m).
        history: see there.
        given: the values of :data:`DEFAULT_HISTORY` that are given.

    Raises:
        ValueError: the keys, their values and the remedy.
    """
    _refuse_accuracy(accuracy, output)
    _refuse_endless_gap(roughness, h_0)
    if history is not None:
        _refuse_history(history, given)
        _refuse_floating(history)


def _refuse_accuracy(accuracy: Accuracy | None, output: Output) -> None:
    """Refuse an accuracy of receptor sites that are not there."""
    if accuracy is not None and accuracy.sed is not None and not output.receptors:
        raise ValueError(
            f"accuracy.sed is {show(accuracy.sed)} and output.receptors is false, without which there are no "
            "sites; leave out one of the two"
        )


def _refuse_endless_gap(roughness: Roughness, h_0: float) -> None:
    """Refuse a roughness that holds the air gap of an unloaded ridge at more than a metre."""
    gap = roughness.largest_gap(h_0)
    if not gap < LARGEST_GAP:
        raise ValueError(
            f"roughness.p_floor is {show(roughness.p_floor)}, where the air gap would be held at {gap:.3g} m; "
            f"it must be below {LARGEST_GAP:g} m: take a larger p_floor, or a smaller gamma or h_rms"
        )


def _refuse_history(history: Sequence[Load], given: Mapping[str, Any]) -> None:
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


def _refuse_floating(history: Sequence[Load]) -> None:
    """Refuse loads that leave the bone neither held nor pressed nor attracted."""
    f_ext, voltage = None, 0.0
    for k, load in enumerate(history):
        if load.f_ext is not None or load.bone_height is not None:
            f_ext = load.f_ext
        voltage = voltage if load.voltage is None else load.voltage
        if f_ext == 0 and voltage == 0:
            raise ValueError(
                f"history[{k}].name is {show(load.name)}, which ends at f_ext 0 and voltage 0, where nothing holds "
                "the skin on the screen; one of the two must be greater than 0, or a bone_height be given"
            )
