"""Loads of a scene: one, its name, and what several of them must not be.

A name may have spaces and letters of any alphabet. It is also that of files: it must not lead out of the folder of
results, nor be one that a file system cannot hold or that no one can read on a screen, and every load's file must be
its own.
"""

import math
import unicodedata
from collections.abc import Iterator, Mapping, Sequence
from functools import cache
from typing import Annotated, Any

from pydantic import AfterValidator, model_validator

from fingerpad.scene import controls
from fingerpad.scene.controls import CarriedWaveform, LoadKey, number_of
from fingerpad.scene.messages import is_formula, show
from fingerpad.scene.waveform import MOST, Waveform
from geometry.units import Switch, Table

_FINAL_STATES = ("uncharged normal contact", "charged normal contact", "full slip")
"""States that have files of their own where errors are estimated."""
_MAX_BYTES = 100  # of a name; a file system allows 255, of which the files take some
_FORBIDDEN = '/\\:*?"<>|'  # the first separates folders, the others are forbidden on memory sticks


def load_name(name: str) -> str:
    """Return a name if it can be a load's.

    Raises:
        ValueError: why not, to follow the name.
    """
    if not name.strip():
        raise ValueError("it must have a letter or a digit")
    if len(name.encode("utf-8", "surrogatepass")) > _MAX_BYTES:
        raise ValueError(f"it must be of {_MAX_BYTES} bytes at most, since files are named by it")
    unfit = next((c for c in name if c in _FORBIDDEN or not c.isprintable()), None)
    if unfit is not None:
        raise ValueError(f"it must be without {unfit!r}, since files are named by it")
    if name.startswith((".", "-", " ")):
        raise ValueError(f"it must not begin with {name[0]!r}, since files are named by it")
    if is_formula(name):
        raise ValueError(f"it must not begin with {name[0]!r}, which makes a formula of it when a table is opened")
    return name


def _first_clash(names: Sequence[str]) -> tuple[int, int] | None:
    """Return the places of the first two loads whose files would be one, also where letters have no case."""
    seen: dict[str, int] = {}
    for k, name in enumerate(names):
        key = unicodedata.normalize("NFKC", name.replace(" ", "_")).casefold()
        if key in seen:
            return seen[key], k
        seen[key] = k
    return None


def repeated(voltage: Any) -> Any:
    """Return a voltage, of a file as one period that repeats itself."""
    of_file = isinstance(voltage, dict) and isinstance(voltage.get("file"), str) and voltage.get("waveform") == "file"
    return voltage | {"repeat": True} if of_file else voltage


class Load(Table):
    """A load to reach from the present one; omitted values stay as they are."""

    name: Annotated[str, AfterValidator(load_name)]
    """Name of the load, also of the load's pictures; see :mod:`fingerpad.scene.loads`."""
    f_ext: Annotated[float | Waveform | None, controls.FORCE] = None
    """External normal force on the bone (N/m), or a waveform. Zero is allowed only under voltage or with
    adhesion, which then hold the skin on the screen."""
    bone_height: Annotated[float | Waveform | None, controls.HEIGHT] = None
    """Change of the bone's height from the unloaded position (m), negative when pressed, or a waveform."""
    voltage: Annotated[float | CarriedWaveform | None, controls.VOLTAGE] = None
    """Instantaneous voltage U (V), or a waveform. The attraction goes with its square: the sign changes no force."""
    bone_x: Annotated[float | Waveform | None, controls.PLACE] = None
    """Horizontal position of the bone (m), zero when unloaded, or a waveform."""
    bone_x_by: Annotated[float | None, controls.MOVE] = None
    """The same as a move (m) from where the bone is when the load begins."""
    speed: Annotated[float | None, controls.SPEED] = None
    """Speed (m/s) of the bone on its way, which makes it a load over time. The model is quasi-static: the speed sets
    how long the way takes, by which viscous layers, friction in time and a drive act."""
    duration: Annotated[float | None, controls.DURATION] = None
    """Time (s) that the load takes, in place of a speed. The bone moves evenly in time; of a force its root changes
    evenly, and of a voltage its square, as the attraction does."""
    until_full_slip: Switch = False
    """Whether the load stops at full slip: where every point in contact slips one way, and forces stay the same over a
    further 0.2 mm, which may end beyond bone_x. Only with bone_x or bone_x_by."""

    @model_validator(mode="after")
    def _consistent(self) -> "Load":
        given, acting = self.given(), self.acting()
        for name, one in ((name, keys_of_load()[name].instead) for name in given):
            if one in given:
                values = f"{one} is {_shown(given[one])} and {name} is {_shown(given[name])}"
                raise ValueError(f"{values}; {keys_of_load()[name].remedy}")
        if not acting:
            *first, last = (name for name, key in keys_of_load().items() if not key.paces)
            raise ValueError(
                f"name is {show(self.name)} and nothing else is given; it must come with at least one of "
                f"{', '.join(first)} and {last}"
            )
        name, wave = self.over_time or ("", None)
        held = [each for each, key in acting.items() if key.held or each == name]
        for each in held if self.until_full_slip else ():
            raise ValueError(
                f"{each} is {_shown(given[each])} and until_full_slip is true, which may stop before that is reached; "
                f"{each} must come in a load of its own"
            )
        if self.speed is not None and number_of(self.bone_x) is None and self.bone_x_by is None:
            how = "; give bone_x or bone_x_by too" if self.bone_x is None else " by a number; give a duration"
            raise ValueError(f"speed is {show(self.speed)} and the bone does not move{how}")
        for each in held if wave is not None else ():
            if each != name:
                words = f"{each} is {_shown(given[each])} and {name} is a waveform"
                raise ValueError(f"{words}; {each} must come in a load of its own, before it")
        if wave is not None and wave.end == math.inf and given.keys() == acting.keys():
            raise ValueError(f"{name} is a {wave.waveform} and the load takes no time; give a speed or duration")
        return self

    def given(self) -> dict[str, Any]:
        """Return the numbers and waveforms that are given, by key."""
        return {name: value for name in keys_of_load() if (value := getattr(self, name)) is not None}

    def acting(self) -> dict[str, LoadKey]:
        """Return what is controlled, by key."""
        return {name: key for name, key in keys_of_load().items() if name in self.given() and not key.paces}

    def aims(self) -> Iterator[str]:
        """Yield in words what the load changes."""
        for name, value in self.given().items():
            until = ", or until full slip" if self.until_full_slip and name in self.acting() else ""
            yield keys_of_load()[name].in_words(value) + until

    @property
    def over_time(self) -> tuple[str, Waveform] | None:
        """The key that is a waveform, and the waveform; None without one."""
        return next((each for each in self.given().items() if isinstance(each[1], Waveform)), None)

    @property
    def wave(self) -> Waveform | None:
        """The waveform; None without one."""
        return None if self.over_time is None else self.over_time[1]

    @property
    def drive(self) -> CarriedWaveform | None:
        """The voltage over time; None where it is a number or stays."""
        return self.voltage if isinstance(self.voltage, CarriedWaveform) else None

    @property
    def level(self) -> float | None:
        """The voltage (V) to go to; None where it is over time or stays."""
        return number_of(self.voltage)

    @property
    def moves(self) -> bool:
        """Whether the load may take the bone away from where it was unloaded."""
        return bool(self.bone_x or self.bone_x_by)

    @property
    def takes_time(self) -> bool:
        """Whether it is a load over time."""
        return self.wave is not None or self.given().keys() != self.acting().keys()

    def place(self, x: float) -> float | None:
        """Return where the load takes the bone (m) from a place x (m); None where it stays."""
        if isinstance(self.bone_x, Waveform):
            return self.bone_x.samples(self.seconds(0.0), 1.0)[-1][1]
        return self.bone_x if self.bone_x_by is None else x + self.bone_x_by

    def seconds(self, way: float) -> float:
        """Return how long the load takes (s) for a way of the bone (m); 0 where it is none over time."""
        for name, value in self.given().items():
            if (paces := keys_of_load()[name].paces) is not None:
                return paces(value, way)
        return 0.0 if self.wave is None else self.wave.end


@cache
def keys_of_load() -> dict[str, LoadKey]:
    """Return the keys of a load that have numbers, by name: the registry of controls and of what sets their time."""
    fields = ((name, part) for name, field in Load.model_fields.items() for part in field.metadata)
    return {name: part for name, part in fields if isinstance(part, LoadKey)}


def _shown(value: float | Waveform) -> str:
    return "a waveform" if isinstance(value, Waveform) else show(value)


def drives(voltage: float | CarriedWaveform, history: Sequence[Load]) -> dict[str, CarriedWaveform]:
    """Return the drives in place of a scene's voltage and of its loads', by key."""
    given = {"voltage": voltage} | {f"history[{k}].voltage": load.drive for k, load in enumerate(history)}
    return {key: value for key, value in given.items() if isinstance(value, CarriedWaveform)}


# -- several ---------------------------------------------------------------------------------------------
def refuse_contradictions(
    history: Sequence[Load], given: Mapping[str, Any], errors: bool, step_scale: float, follows: str
) -> None:
    """Refuse the first contradiction between loads, or of them with other keys.

    Args:
        history: the loads of a scene.
        given: the values of :data:`fingerpad.scene.presets.DEFAULT_HISTORY` that are given.
        errors: whether errors are estimated.
        step_scale: key of the numerics.
        follows: key of the electric part: under the mean of a drive it has no samples.

    Raises:
        ValueError: the keys, their values and the remedy.
    """
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
    if clash := _first_clash([load.name for load in history]):
        one, other = (show(history[k].name) for k in clash)
        raise ValueError(
            f"history[{clash[1]}].name is {other} and history[{clash[0]}].name is {one}; each load must have a "
            "name of its own, also where spaces become _ and letters have no case, since files are named by it"
        )
    for k, load in enumerate(history) if errors else ():
        if _first_clash([*_FINAL_STATES, load.name]):
            raise ValueError(
                f"history[{k}].name is {show(load.name)}, and the state of that name has files of its own; take "
                "another name"
            )
    _refuse_times(history, step_scale, follows)


def refuse_floating(history: Sequence[Load]) -> None:
    """Refuse loads that leave the bone neither held nor pressed nor attracted."""
    acts: dict[str, float | None] = {"f_ext": None, "voltage": 0.0}  # None of a force: the height is prescribed
    for key, load, way in ways(history):
        if load.bone_height is not None:
            acts["f_ext"] = None
        for name in acts.keys() & load.acting().keys():
            acts[name] = number_of(getattr(load, name))
        name, wave = load.over_time or ("", None)
        if wave is not None and name in acts:
            along = [value for _, value in wave.samples(load.seconds(way or 0.0), 1.0)]
            (other,) = acts.keys() - {name}
            if acts[other] == 0 and 0 in along:
                raise ValueError(
                    f"{key}.{name} goes through 0 while {other} is 0, where nothing holds the skin on the screen; "
                    f"it must have an offset above its amplitude, or {other} or bone_height be given before it"
                )
            acts[name] = along[-1]
        if acts["f_ext"] == 0 and acts["voltage"] == 0:
            raise ValueError(
                f"{key}.name is {show(load.name)}, which ends at f_ext 0 and voltage 0, where nothing holds "
                "the skin on the screen; one of the two must be greater than 0, or a bone_height be given"
            )


def ways(history: Sequence[Load]) -> Iterator[tuple[str, Load, float | None]]:
    """Yield the key of each load, the load, and how far the bone goes (m); None where the run decides that."""
    place: float | None = 0.0  # of the bone; None where a load before may have stopped early
    for k, load in enumerate(history):
        aim = place if place is None and load.bone_x is None else load.place(place or 0.0)
        still = load.bone_x is None and load.bone_x_by is None
        way = 0.0 if still else load.bone_x_by
        if way is None and aim is not None and place is not None:
            way = aim - place
        yield f"history[{k}]", load, way
        if not still:
            place = None if load.until_full_slip else aim


def _refuse_times(history: Sequence[Load], step_scale: float, follows: str) -> None:
    """Refuse waveforms whose length is not known before the run, or whose samples are too many or end too early."""
    for key, load, way in ways(history):
        if load.over_time is None:
            continue
        name, wave = load.over_time
        if load.speed is not None and way is None:
            raise ValueError(
                f"{key}.bone_x is {show(load.bone_x)} after a load that may stop at full slip, so that the time of "
                "the waveform is not known; give bone_x_by, or a duration in place of speed"
            )
        if load.speed is not None and way == 0:
            raise ValueError(f"{key}.speed is {show(load.speed)} and the bone is there already; give a duration")
        averaged = follows == "mean" and load.drive is not None
        _refuse_samples(f"{key}.{name}", wave, load.seconds(way or 0.0), math.inf if averaged else step_scale)


def _refuse_samples(key: str, wave: Waveform, seconds: float, step_scale: float) -> None:
    """Refuse a waveform with too many samples, or a table that ends before its load."""
    if seconds > wave.end * (1 + 1e-9):
        raise ValueError(
            f"{key} has values up to {wave.end:g} s and the load takes {seconds:g} s; its times must go on to "
            "the end of the load"
        )
    samples = wave.count(seconds, step_scale)
    if samples > MOST:
        has, less = f"{seconds / wave.period:.4g} periods in {seconds:g} s", "a lower frequency, a shorter load"
        if wave.times is not None:
            has, less = f"{len(wave.times)} points", "fewer points, smaller changes between them"
        raise ValueError(
            f"{key} has {has}, some {samples:.4g} steps; there must be at most {MOST} of them: take {less} or "
            "a larger numerics.step_scale"
        )
