"""How many ridges a mesh needs: decided before the finger is meshed, where the scene does not say.

A coarse finger (:mod:`fingerpad.reduced.coarse`) says which ridge the screen reaches last, and the mesh has
:data:`MARGIN` ridges more on either side. Against the full runs the coarse finger is at most one ridge short
(``docs/reach.md``), and the last ridge that is meshed must stay clear of the screen for the run to go on
(:mod:`fingerpad.model.contact_zone`): two, then. Where the coarse finger finds no equilibrium there is a rule of thumb,
from full runs of the default finger.
"""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from fingerpad.model.options import ModelOptions
from fingerpad.scene import Scene
from geometry.sizing import touching_ridges

if TYPE_CHECKING:
    from mpi4py import MPI

MARGIN = 2
# What the rule of thumb knows: 5 mm are enough for this force (N/m) and friction. Ridges in contact grow as the force
# to the 0.27 (15 at 46 N/m, 17 at 73 N/m); friction rolls the finger onto its leading side (ridge 10 touches at 1).
_HALF_ARC = 5e-3
_FORCE, _WIDENS = 75.0, 0.27
_FRICTION, _ROLLS = 0.25, 0.3
_PRESSURE = 30e3  # Pa, mean contact pressure of ridges, at which a friction law that is not Coulomb's counts


@dataclass(frozen=True)
class Decision:
    """What was decided of a scene's mesh, the same on every rank."""

    scene: Scene
    """With a ``mesh.touching_half_arc``, unless its mesh is of a file."""
    reason: str
    """Why so many ridges; empty where the scene gave the number."""
    cost: dict[str, Any]
    """Of the coarse solve, ready for JSON; empty where there was none."""

    def plan(self, needed: ModelOptions, scene: Scene) -> ModelOptions:
        """Return a plan that says which ridges are left out of the decision's scene, or of a wider one."""
        if not self.reason:
            return needed
        last = touching_ridges(scene.geometry, scene.mesh)[-1]
        if last == (scene.geometry.ridge_count - 1) // 2:
            return needed
        return needed.with_ridges(last, self.reason)


def decide(scene: Scene, comm: "MPI.Comm") -> Decision:
    """Decide how many ridges can touch; collective."""
    from fingerpad.reduced import coarse  # dolfinx: not for those who want the rule alone

    if scene.mesh.touching_half_arc is not None or scene.laws.mesh is not None:  # a file says which ridges there are
        return Decision(scene, "", {})
    try:
        found = coarse.solve(scene, comm)
    except coarse.NoCoarseSolution as failure:
        reason = f"a rule of thumb says so, since a coarse solve failed: {failure}"
        return Decision(by_rule(scene), reason, {"failure": str(failure)})
    half_arc = (found.last + MARGIN) * scene.geometry.ridge_wavelength
    reason = f"a coarse solve shows ridge {found.last} to be the last that the screen reaches"
    cost = {
        "last_ridge": found.last,
        "unknowns": found.unknowns,
        "factorisations": found.factorisations,
        "processor_seconds": found.seconds,
    }
    return Decision(_with(scene, half_arc), reason, cost)


def by_rule(scene: Scene) -> Scene:
    """Return the scene with so many ridges as the rule of thumb says, if it does not say itself.

    A series of runs over voltages shares a mesh so, whatever a coarse solve would say of each.
    """
    if scene.mesh.touching_half_arc is not None:
        return scene
    law = scene.friction_law()
    mu_f = 0.0 if law is None else law.coefficient(_PRESSURE)
    force = max((load.f_ext for load in scene.loads() if load.f_ext), default=0.0) / _FORCE
    wider = max(force, 1.0) ** _WIDENS * max(mu_f / _FRICTION, 1.0) ** _ROLLS
    return _with(scene, _HALF_ARC * wider)


def _with(scene: Scene, half_arc: float) -> Scene:
    return scene.model_copy(update={"mesh": scene.mesh.model_copy(update={"touching_half_arc": half_arc})})
