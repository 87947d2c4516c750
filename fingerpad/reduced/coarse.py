r"""A cheap coarse finger: which ridge is the last one that the screen reaches.

The finger of the model "smooth" (:mod:`fingerpad.reduced.smooth`) with plane junctions and linear elements of half a
ridge is pressed on springs. For a ridge's law they have one number, the mean pressure that flattens a wave of a
half-space over its amplitude (Westergaard 1939, doi 10.1115/1.4008919; :math:`E^* = 2 G_0 / (1 - \nu)` of the stratum
corneum):

.. math:: p_n = \frac{\pi E^*}{\lambda} \langle -y \rangle_+ .

Friction rolls the finger onto its leading side. At full slip the traction is the limit of friction whatever the way
there, so that one more solve has it, with all anchors far behind. A voltage draws ridges to the screen, which bears
both what presses and what attracts: the bone feels it as friction alone,

.. math:: \mu = \frac{t_{max}(p_c)}{p_c} (1 + f_{el} / f_{ext}),

with the mean pressure :math:`p_c` and the attraction :math:`f_{el}` of as many equal charged cylinders
(:mod:`variational.attraction.cylinder`) as ridges touch. The ridge law's tables would take ten times as long as all of
this.

A ridge counts where the smooth skin is in contact over more than half of its period. Ridges that barely touch are
missed, which the margin of :mod:`fingerpad.model.touching` is for.
"""

from dataclasses import dataclass, replace
from functools import partial

import numpy as np
from mpi4py import MPI

from fingerpad.reduced.answer import Stopwatch
from fingerpad.reduced.cylinders import tip_radius
from fingerpad.reduced.ridge_cell import flat_junction
from fingerpad.reduced.smooth import smoothed
from fingerpad.scene import Scene
from fingerpad.scene.laws import skin_modulus
from geometry import fingertip, tags
from geometry.mesh import TaggedMesh, load
from geometry.parameters import MeshSize
from variational.attraction.cylinder import Cylinder
from variational.body import Body
from variational.contact.formulation import History
from variational.contact.friction import Coulomb, Friction
from variational.contact.penalty import Penalty
from variational.problem import Interface
from variational.solvers.continuation import StepFailed, Target

_GROWTH, _COARSEST = 0.5, 1e-3  # m
_TOLERANCE = 1e-6
_STEPS = 8.0  # largest steps of the loads, over those with which ridges are followed
_BEHIND = 1.0  # m, farther than any finger slides


class NoCoarseSolution(RuntimeError):
    """The coarse finger says nothing of the scene; why, in a few words."""


@dataclass(frozen=True)
class Reach:
    """What the coarse finger says."""

    last: int
    """Largest number, on either side, of a ridge that the screen reaches."""
    unknowns: int
    factorisations: int
    seconds: float
    """Processor time of this rank, compiled forms and mesh included (s)."""


def solve(scene: Scene, comm: MPI.Comm) -> Reach:
    """Press the coarse finger with the largest load of a scene, and slide it if the bone moves; collective.

    Raises:
        NoCoarseSolution: no equilibrium was found, or it is beyond the ridges there are.
    """
    clock = Stopwatch()
    try:
        skin = flat_junction(smoothed(scene.geometry))
        half = skin.ridge_wavelength / 2
        size = MeshSize(
            contact=half / 2, receptor=half, interface=half, coarsest=_COARSEST, growth=_GROWTH,
            touching_half_arc=skin.ridge_count * half, touching_fraction=1.0,
        )  # fmt: skip
        body = load(comm, partial(fingertip.build, skin, size, False), tags.LAYERS.values())
        friction = scene.friction_law()
        pressed = _Finger(scene, body, friction)
        pressed.press()
        fingers, touched = [pressed], pressed.touched()
        if friction is not None and any(load.bone_x for load in scene.loads()):
            dragged = _Finger(scene, body, pressed.friction(friction, len(touched)))
            dragged.drag(pressed)
            fingers.append(dragged)
            touched |= dragged.touched()
    except (StepFailed, ValueError) as error:  # or a scene that is no finger of this kind
        raise NoCoarseSolution(str(error)) from error
    last = max(map(abs, touched))
    if last == (skin.ridge_count - 1) // 2:
        raise NoCoarseSolution(f"it reaches the last of the ridges, {last}")
    factorisations = sum(finger.solver.counts.factorisations for finger in fingers)
    return Reach(last, pressed.solver.layout.global_size, factorisations, clock.seconds())


class _Finger:
    """The coarse finger under a law of friction, or a friction coefficient."""

    def __init__(self, scene: Scene, body: TaggedMesh, friction: Friction | float | None) -> None:
        self.scene, self.loads = scene, scene.loads()
        self.force = max((load.f_ext for load in self.loads if load.f_ext), default=0.0)
        self.modulus = skin_modulus(scene)
        stiffness = np.pi * self.modulus / scene.geometry.ridge_wavelength
        interface = Interface(Penalty(stiffness, stiffness), friction, scene.h_0, attraction=None)
        made = Body(
            body, scene.solids(), interface, element="P1", force_scale=self.force or 1.0, tolerance=_TOLERANCE,
            step_scale=_STEPS,
        )  # fmt: skip
        self.surface, self.problem, self.solver, self.walk = made.surface, made.problem, made.solver, made.continuation

    def press(self) -> None:
        """Press with the largest force, and on to the lowest height of the bone."""
        if self.force:
            self.walk.run(Target("press", f_ext=self.force))
        depth = min((load.bone_height for load in self.loads if load.bone_height is not None), default=0.0)
        if depth < self.solver.bone[1] or not self.force:
            self.walk.run(Target("press", bone_height=depth))

    def drag(self, pressed: "_Finger") -> None:
        """Bring a pressed finger to full slip, in one step."""
        mine, other = self.solver, pressed.solver
        mine.x.array_w[:] = other.x.array_r
        mine.equations.to_fields(mine.x)
        mine.control, mine.reaction = replace(other.control), other.reaction.copy()
        h = pressed.problem.history
        self.problem.set_history(History(h.anchor - _BEHIND, h.pressure, h.x))
        self.walk.re_equilibrate("full slip")

    def touched(self) -> set[int]:
        """Return the numbers of the ridges that the screen reaches, the central one among them."""
        lengths = self.walk.observer.ridge_loads(self.walk.surface_state).length
        half = self.scene.geometry.ridge_wavelength / 2
        return {0} | {j for j, length in zip(self.surface.names, lengths, strict=True) if length > half}

    def friction(self, law: Friction, ridges: int) -> float:
        """Return the friction at full slip over what presses, at the largest voltage and the ridges' mean pressure."""
        voltage = max((load.voltage for load in self.loads if load.voltage), default=0.0)
        f_ext = float(self.solver.reaction[1])
        if isinstance(law, Coulomb) and not (voltage and f_ext > 0):
            return law.mu_f
        scene = self.scene
        ridge = Cylinder(tip_radius(scene.geometry), self.modulus, scene.h_0, scene.closure())
        found = ridge.under_load(f_ext / ridges, voltage)
        return law.coefficient(found.p_c) * (found.f_contact * ridges / f_ext)
