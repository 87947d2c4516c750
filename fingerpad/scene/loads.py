"""Loads of a scene: one, its name, and what several of them must not be.

A name may have spaces and letters of any alphabet. It is also that of files: it must not lead out of the folder of
results, nor be one that a file system cannot hold or that no one can read on a screen, and every load's file must be
its own.
"""

import math
import unicodedata
from collections.abc import Iterator, Mapping, Sequence
from typing import Annotated, Any

from pydantic import AfterValidator, Discriminator, Tag, model_validator

from fingerpad.scene.messages import NUMBER, WAVE, is_formula, show
from fingerpad.scene.wavefile import Volts
from fingerpad.scene.waveform import MOST, Waveform
from geometry.units import Finite, Switch, Table, within

_FINAL_STATES = ("uncharged normal contact", "charged normal contact", "full slip")
"""States that have files of their own where errors are estimated."""
_MAX_BYTES = 100  # of a name; a file system allows 255, of which the files take some
_EITHER = (
    ("f_ext", "bone_height", "at most one of the two can be prescribed"),
    ("bone_x", "bone_x_by", "give the place or the move"),
    ("speed", "duration", "one follows from the other, so give one"),
)  # keys of which a load has one at most
_HELD = ("f_ext", "bone_height", "voltage")  # controls that a slide to full slip may not have reached
_CONTROLS = (*_HELD, "bone_x", "bone_x_by")
"""Keys of what a load controls: force, height, voltage and place or move of the bone."""
_FORBIDDEN = '/\\:*?"<>|'  # the first separates folders, the others are forbidden on memory sticks
Way = Annotated[Finite, within(1e-9, 0.1, "m", zero=True, sides=2)]


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


def _kind(voltage: Any) -> str:
    return WAVE if isinstance(voltage, dict | Waveform) else NUMBER


Voltage = Annotated[Annotated[Volts, Tag(NUMBER)] | Annotated[Waveform, Tag(WAVE)], Discriminator(_kind)]


def repeated(voltage: Any) -> Any:
    """Return a voltage, of a file as one period that repeats itself."""
    of_file = isinstance(voltage, dict) and isinstance(voltage.get("file"), str) and voltage.get("waveform") == "file"
    return voltage | {"repeat": True} if of_file else voltage


class Load(Table):
    """A load to reach from the present one; omitted values stay as they are."""

    name: Annotated[str, AfterValidator(load_name)]
    """Name of the load, also of the load's pictures; see :mod:`fingerpad.scene.loads`."""
    f_ext: Annotated[Finite, within(1e-3, 5e3, "N/m", zero=True)] | None = None
    """External normal force on the bone (N/m). Zero is allowed only under voltage or with adhesion, which then hold the
    skin on the screen."""
    bone_height: Way | None = None
    """Change of the bone's height from the unloaded position (m), negative when pressed."""
    voltage: Voltage | None = None
    """Instantaneous voltage U (V), or a waveform. The attraction goes with its square: the sign changes no force."""
    bone_x: Way | None = None
    """Horizontal position of the bone (m), zero when unloaded."""
    bone_x_by: Way | None = None
    """The same as a move (m) from where the bone is when the load begins."""
    speed: Annotated[Finite, within(1e-6, 100.0, "m/s")] | None = None
    """Speed (m/s) of the bone on its way, which makes it a load over time. The model is quasi-static: the speed sets
    how long the way takes, by which viscous layers, friction in time and a drive act."""
    duration: Annotated[Finite, within(1e-6, 1e5, "s")] | None = None
    """Time (s) that the load takes, in place of a speed. The bone moves evenly in time; of a force its root changes
    evenly, and of a voltage its square, as the attraction does."""
    until_full_slip: Switch = False
    """Whether the load stops at full slip: where every point in contact slips one way, and forces stay the same over a
    further 0.2 mm, which may end beyond bone_x. Only with bone_x or bone_x_by."""

    @model_validator(mode="after")
    def _consistent(self) -> "Load":
        given = {name: getattr(self, name) for name in _CONTROLS if getattr(self, name) is not None}
        for one, other, remedy in _EITHER:
            values = getattr(self, one), getattr(self, other)
            if None not in values:
                raise ValueError(f"{one} is {show(values[0])} and {other} is {show(values[1])}; {remedy}")
        if not given:
            *first, last = _CONTROLS
            raise ValueError(
                f"name is {show(self.name)} and nothing else is given; it must come with at least one of "
                f"{', '.join(first)} and {last}"
            )
        for name in [name for name in _HELD if name in given and self.until_full_slip]:
            shown = "a waveform" if isinstance(given[name], Waveform) else show(given[name])
            raise ValueError(
                f"{name} is {shown} and until_full_slip is true, which may stop before that is reached; {name} must "
                "come in a load of its own"
            )
        if self.speed is not None and not {"bone_x", "bone_x_by"} & given.keys():
            raise ValueError(f"speed is {show(self.speed)} and the bone does not move; give bone_x or bone_x_by too")
        if self.wave is not None:
            for name in [name for name in _HELD if name in given and name != "voltage"]:
                raise ValueError(
                    f"{name} is {show(given[name])} and voltage is a waveform; {name} must come in a load of its own, "
                    "before it"
                )
            if self.speed is None and self.duration is None and self.wave.end == math.inf:
                raise ValueError(
                    f"voltage is a {self.wave.waveform} and the load takes no time; give a speed or duration"
                )
        return self

    def aims(self) -> Iterator[str]:
        """Yield in words what the load changes."""
        if self.f_ext is not None:
            yield f"force to {self.f_ext:g} N/m (per metre of finger)"
        if self.bone_height is not None:
            yield f"bone's height to {self.bone_height * 1e3:+g} mm of the unloaded one"
        if self.voltage is not None:
            yield f"voltage: {self.wave}" if self.level is None else f"voltage to {self.level:g} V"
        until = ", or until full slip" if self.until_full_slip else ""
        if self.bone_x is not None:
            yield f"bone sideways to {self.bone_x * 1e3:g} mm{until}"
        if self.bone_x_by is not None:
            yield f"bone sideways by {self.bone_x_by * 1e3:+g} mm{until}"
        if self.pace:
            yield self.pace

    @property
    def wave(self) -> Waveform | None:
        """The voltage over time; None where it is a number or stays."""
        return self.voltage if isinstance(self.voltage, Waveform) else None

    @property
    def level(self) -> float | None:
        """The voltage (V) to go to; None where it is over time or stays."""
        return None if isinstance(self.voltage, Waveform) else self.voltage

    @property
    def moves(self) -> bool:
        """Whether the load may take the bone away from where it was unloaded."""
        return bool(self.bone_x or self.bone_x_by)

    @property
    def pace(self) -> str:
        """Speed or duration in words; empty without."""
        if self.speed is not None:
            return f"at {1e3 * self.speed:g} mm/s"
        return "" if self.duration is None else f"in {self.duration:g} s"

    @property
    def takes_time(self) -> bool:
        """Whether it is a load over time."""
        return self.speed is not None or self.duration is not None or self.wave is not None

    def place(self, x: float) -> float | None:
        """Return where the load takes the bone (m) from a place x (m); None where it stays."""
        return self.bone_x if self.bone_x_by is None else x + self.bone_x_by

    def seconds(self, way: float) -> float:
        """Return how long the load takes (s) for a way of the bone (m); 0 where it is none over time."""
        if self.speed is not None:
            return abs(way) / self.speed
        if self.duration is None:
            return 0.0 if self.wave is None else self.wave.end
        return self.duration


def drives(voltage: float | Waveform, history: Sequence[Load]) -> dict[str, Waveform]:
    """Return the drives in place of a scene's voltage and of its loads', by key."""
    given = {"voltage": voltage} | {f"history[{k}].voltage": load.wave for k, load in enumerate(history)}
    return {key: value for key, value in given.items() if isinstance(value, Waveform)}


# -- several ---------------------------------------------------------------------------------------------
def refuse_contradictions(
    history: Sequence[Load], given: Mapping[str, Any], errors: bool, step_scale: float, adheres: bool
) -> None:
    """Refuse the first contradiction between loads, or of them with other keys.

    Args:
        history: the loads of a scene.
        given: the values of :data:`fingerpad.scene.fingers.DEFAULT_HISTORY` that are given.
        errors: whether errors are estimated.
        step_scale: key of the numerics.
        adheres: whether skin adheres without a voltage.

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
    _refuse_times(history, step_scale)
    if not adheres:
        _refuse_floating(history)


def _refuse_floating(history: Sequence[Load]) -> None:
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


def ways(history: Sequence[Load]) -> Iterator[tuple[str, Load, float | None]]:
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


def _refuse_times(history: Sequence[Load], step_scale: float) -> None:
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
