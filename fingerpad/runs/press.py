"""One press of a finger without voltage, of which its closed form is made (:mod:`fingerpad.reduced.press`).

Half of the finger is pressed on coarse elements. Its states under :data:`fingerpad.reduced.press.FORCES` are solved for
again on a mesh that is fine where their contact ends, since the length in contact has its error there. Skin sticks as
in a run, with the default friction coefficient, whatever the scene's is.
"""

import sys
import time
from collections.abc import Mapping

import fingerpad.startup  # noqa: F401
from fingerpad import launcher
from fingerpad.accuracy.solves import StateRecorder, solve_again
from fingerpad.accuracy.states import State
from fingerpad.model.options import FingerModel, by_rule, plan
from fingerpad.model.simulation import Simulation
from fingerpad.reduced.model import check_supported
from fingerpad.reduced.press import FINE, FORCES, MESH, Press, file_of, keep, known
from fingerpad.scene import Scene, SceneError
from fingerpad.scene.messages import refuse_type
from fingerpad.startup import MPI
from geometry.parameters import MeshSize
from geometry.profiles import GeometryError
from variational.solvers.continuation import StepFailed

_LEAST = 4  # forces that are enough, where larger ones are not reached
_SHAPE = {"growth": 0.5, "touching_fraction": 0.7}  # of the mesh; flat tips touch with two thirds of a ridge's period


def press(scene: Scene | None = None) -> Press:
    """Return the press of a scene's finger: of the package or the cache, or made now and kept there.

    Args:
        scene: of its tables ``geometry``, ``materials`` and ``contact`` alone the press depends; by default the default
            finger's.

    Raises:
        SceneError: the finger has no closed form, cannot be meshed, or its press fails.
    """
    refuse_type("scene", scene, Scene | None, "a Scene, and a file is read by Scene.load(path)")
    scene = Scene() if scene is None else scene
    check_supported(scene, "cylinders")
    found = known(scene)
    if found is None:
        began = time.process_time()
        _say("one press of this finger is made for its closed form; it takes about half a minute, once")
        try:
            found = made(scene)
        except (GeometryError, StepFailed) as error:
            raise SceneError(
                f"the press of this finger, of which its closed form is made, failed: {error}; use the model 'full'"
            ) from error
        keep(scene, found)
        _say(f"the press took {time.process_time() - began:.0f} s and is kept in {file_of(scene)}")
    return found


def _say(text: str) -> None:
    if launcher.rank() == 0:
        print(f"fingerpad: {text}", file=sys.stderr, flush=True)


def made(scene: Scene) -> Press:
    """Return a press, solved for on this process alone; see :func:`press`.

    Raises:
        GeometryError: the finger cannot be meshed.
        StepFailed: fewer than four of the forces are reached.
    """
    wave, history = scene.geometry.ridge_wavelength, [{"name": f"press {f:g}", "f_ext": f} for f in FORCES]
    mesh = MeshSize(**_SHAPE, **{name: part * wave for name, part in MESH.items()})
    tables = {"geometry": scene.geometry, "materials": scene.materials, "contact": scene.contact, "mesh": mesh}
    bare = Scene(history=history, output={"errors": False, "receptors": False}).model_copy(update=tables)  # type: ignore[arg-type]
    model, states = _pressed(FingerModel(by_rule(bare), plan(bare)))
    fine = model.changed(mesh=model.mesh.model_copy(update={"contact": FINE * wave}))
    found = solve_again(fine, states, MPI.COMM_SELF).states.values()
    return Press.of_states(sorted((each.state for each in found), key=lambda state: state.f_ext))


def _pressed(model: FingerModel) -> tuple[FingerModel, Mapping[str, State]]:
    """Return the states at the forces on the mesh of the path, and the model with all ridges that they need."""
    simulation = Simulation(model, MPI.COMM_SELF, on_load=lambda: recorder.keep(simulation.states[-1].load))
    recorder = StateRecorder(simulation)
    try:
        restart = simulation.run()
    except StepFailed:
        if len(recorder.states) < _LEAST:
            raise
        restart = None
    simulation.finger.solver.iteration.free()
    return (model, recorder.states) if restart is None else _pressed(restart.model)
