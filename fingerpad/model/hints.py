"""What to try when a run stops, in the words of a scene's keys."""

from typing import TYPE_CHECKING

from fingerpad.io.interrupt import Interrupted
from variational.solvers.failure import NotConverged

if TYPE_CHECKING:
    from variational.solvers.continuation import StepFailed

_HINTS = {
    "NOT_A_NUMBER": "report it with the scene; until then try parameters nearer to the defaults",
    "MUMPS_OUT_OF_MEMORY": "try a larger mesh.contact, fewer ranks, or a machine with more memory",
    "MUMPS_OUT_OF_WORKSPACE": "try -fingerpad_mat_mumps_icntl_14 100, which sets twice the workspace aside",
    "MUMPS_SINGULAR": "try pressing with a bone_height before an f_ext, or a smaller voltage",
    "MUMPS_FAILED": "look the code up in the users' guide of MUMPS, section 8",
    "COUPLING_CAP": "try a larger numerics.coupling_cap, or another voltage: the ridge may be at its fold",
    "DIVERGED_MAX_IT": "try a larger -fingerpad_snes_max_it, or a smaller mesh.contact",
}
_INVERTED = (
    "try a smaller f_ext or voltage, or a smaller mesh.contact and mesh.interface, where elements turn inside out"
)
_OTHERWISE = "try a smaller mesh.contact, which lets the edge of the contact move, or another voltage or f_ext"


def hint(error: "StepFailed") -> str:
    """Return what to try against a load that could not be reached, empty if the error names it itself."""
    cause = error.__cause__
    if not isinstance(cause, NotConverged):
        return ""
    if cause.inverted:
        return _INVERTED
    return next((words for name, words in _HINTS.items() if cause.reason.startswith(name)), _OTHERWISE)


def finer_mesh_may_help(error: "StepFailed", coarse_start: bool) -> bool:
    """Return whether a load that could not be reached may be with a smaller ``mesh.contact``.

    Args:
        error: of the load.
        coarse_start: the mesh was chosen as one to start from, and not by a person.
    """
    if coarse_start:
        return not isinstance(error, Interrupted)
    return "smaller mesh.contact" in hint(error)
