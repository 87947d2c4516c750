"""What is prescribed of the bone, a load to reach, the loads on the way to it, and how far a path has come."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

Array = NDArray[np.float64]
# How far one step may go: parts of sqrt(f_ext) and of U^2, and metres of the bone.
_FORCE, _VOLTAGE, _SINK, _SLIDE = 0.134, 0.5, 40e-6, 120e-6
_OF_REACH, _OF_DEPTH = 0.25, 0.2  # largest step of a bone that lifts adhering skin, over the reach and its depth
_CONTINUES = 1.5  # shortest times of the time since then that count where a load goes on to change
_AGES = 0.25  # longest step (s) over the time since the last change at once and the shortest time in which a law ages


@dataclass
class Control:
    """What is prescribed of the bone: its translation in x, and in y either a translation or a force."""

    x: float = 0.0
    """Translation (m)."""
    y: float | None = 0.0
    """Translation (m), or None under force control."""
    force: float = 0.0
    """External force per length pressing down (N/m), where y is None."""

    @property
    def translation(self) -> list[float]:
        """The translations (m) that are prescribed: in x, or in x and y."""
        return [self.x] if self.y is None else [self.x, self.y]


@dataclass(frozen=True)
class Target:
    """A load to reach from the present one; what is None stays as it is.

    At most one of ``f_ext`` (N/m) and ``bone_height`` (m, change from the unloaded position, negative when pressed)
    may be given: it also says which of the two is prescribed from then on.
    """

    name: str
    f_ext: float | None = None
    bone_height: float | None = None
    voltage: float | None = None
    bone_x: float | None = None
    until_full_slip: bool = False
    """Stop as soon as every point in contact slips one way."""
    along: Mapping[str, Callable[[float], float]] = field(default_factory=dict)
    """By the name of an attribute above its value at a part of the way before the end; by default the root of
    ``f_ext``, the square of the voltage, and places go evenly."""
    touches: bool = False
    """Lower the bone from the air to the screen, before a load by a force."""
    continues: bool = False
    """A short piece of a longer way: the bone moves on as before, and the voltage changes as little as the piece is
    short. It is reached in one step where that is possible."""
    slips: bool = False
    """From full slip to full slip: in one step where possible, with every anchor of friction far behind the skin, so
    that no point can stick and what was before does not count. Bone and skin stay where they are."""
    constants: Callable[[float], None] | None = None
    """Sets what else changes, constants of the laws, at a part of the way; called again with less after a failure."""
    duration: float = 0.0
    """How long the load takes (s), of which each step has its part as ``Problem.dt``; 0 where it changes at once."""
    since: float = 0.0
    """Time (s) since the last change at once when a short piece of a longer way begins; 0 where it begins with one."""


@dataclass
class Progress:
    """From where a path is on its way to a target, and how far it has come; so that another process can go on."""

    control: Control
    """Of the state that the path set out from, as all above ``part``."""
    voltage: float
    height: float
    """Of the bone (m, change from unloaded)."""
    reaction: Array
    """On the bone (N/m), shape (2,)."""
    time: float
    """(s)"""
    steps: int
    """Accepted steps so far."""
    part: float = 0.0
    """Of the way that is done."""
    step: float = 0.0
    """Part that the next step tries."""
    uncut: int = 0
    """Steps in a row that were not cut,"""
    cut: int = 0
    """and that were."""
    jumps: bool = False
    """Whether parts of the skin jumped on the way."""


class Way:
    """The loads between an accepted state and a target."""

    def __init__(self, start: Progress, target: Target) -> None:
        """Take the progress, of which its begin counts, and the target."""
        self.start, self.target = start, target
        self.length = 0.0 if target.bone_x is None else target.bone_x - start.control.x

    def at(self, part: float) -> tuple[Control, float]:
        """Return control and voltage where a part of the target is reached."""
        a, target = self.start, self.target
        u1 = a.voltage if target.voltage is None else target.voltage
        c = Control(a.control.x + part * self.length, a.control.y, a.control.force)
        if target.bone_height is not None:
            c.y = a.height + part * (target.bone_height - a.height)
        elif target.f_ext is not None:
            # equal steps of the root: nearly equal steps of the indentation
            f0 = max(a.control.force, 0.0)
            c.y, c.force = None, (np.sqrt(f0) + part * (np.sqrt(target.f_ext) - np.sqrt(f0))) ** 2
        # equal steps of U^2, which the attraction follows; a sign that changes does so at once, which changes no force
        amount = np.sqrt(a.voltage**2 + part * (u1**2 - a.voltage**2))
        voltage = float(np.copysign(amount, u1 or a.voltage)) + 0.0
        if target.along and part < 1:
            now = {name: value(part) for name, value in target.along.items()}
            c.x, c.y, c.force = now.get("bone_x", c.x), now.get("bone_height", c.y), now.get("f_ext", c.force)
            voltage = now.get("voltage", voltage)
        return c, voltage

    def largest_step(self, scale: float) -> float:
        """Return the largest part of the target that one step may cover; ``scale`` multiplies the usual one."""
        a, target = self.start, self.target
        if target.slips:
            return 1.0
        steps: list[tuple[float, float]] = []  # how far one step may go, and how far the target is
        if target.f_ext is not None:
            roots = np.sqrt(target.f_ext), np.sqrt(max(a.control.force, 0.0))
            steps.append((_FORCE * max(roots), abs(roots[0] - roots[1])))
        if target.voltage is not None and not target.continues:
            squares = target.voltage**2, a.voltage**2
            steps.append((_VOLTAGE * max(squares), abs(squares[0] - squares[1])))
        if target.bone_height is not None:
            steps.append((_SINK, abs(target.bone_height - a.height)))
        steps.append((_SLIDE, abs(self.length)))
        return float(min([1.0, *(scale * most / whole for most, whole in steps if whole > 0)]))

    def peels(self, height: float, reach: float) -> float:
        """Return the largest part of the target that one step may have where a bone lifts adhering skin.

        The force is most negative within the reach of the adhesion, which a usual step would go past.

        Args:
            height: of the bone (m, change from unloaded).
            reach: of the adhesion (m).
        """
        aim = self.target.bone_height
        if aim is None or aim <= height:
            return 1.0
        return max(_OF_REACH * reach, -_OF_DEPTH * height) / (aim - self.start.height)

    def longest(self, part: float, shortest_time: float) -> float:
        """Return the largest part of the target that time lets one step have, after a part of it.

        Relaxation is fastest after a change and slows down, so that steps grow with the time since. Where stress
        changes evenly over a step of x of a branch's time, the branch gets x^2 / 24 too little of it: 0.3 % in a step
        of a quarter. Where a load goes on to change, as a sine does, each short piece of it begins with a step of up to
        0.625 of the shortest time, where it is 1.6 %.

        Args:
            part: that is reached.
            shortest_time: of what ages (s), infinite where nothing does.
        """
        seconds = self.target.duration
        since = min(self.target.since, _CONTINUES * shortest_time) + part * seconds
        return _AGES * (shortest_time + since) / seconds if seconds > 0 else 1.0
