r"""What a run of a scene will take, by a rule from kept runs: within a factor of 2 in their range, not known outside.

Processor time of the path is factorisations times unknowns times a constant. Factorisations are those of a press, a
charge and a slide to full slip. How they grow with the loads is fitted to the 40 full runs of ``docs/models.json``, and
their number is that of the default run of ``docs/performance.json`` (0.58 to 1.23 times those of the 40 runs):

.. math:: n = 67.9 \, (f_{ext} / 75 N/m)^{0.37} \, e^{0.64 (U / 200 V)^2}

of which the three loads of the default run have 0.39, 0.07 and 0.54; these shares and the factors of the formulations
are those of ``docs/chart.json``. The time, the shares of the error estimate and of set-up and output, and the time to
compile the forms are those of ``docs/performance.json``. ``tests/test_command_mesh.py`` derives all of them again.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass

from fingerpad.io.left import about
from fingerpad.model.options import ModelOptions
from fingerpad.reduced.known import KNOWN_FORCES, KNOWN_VOLTAGES
from fingerpad.scene import Load, Scene
from fingerpad.scene.contradictions import ways

RUNS, FORCE, VOLTAGE = 67.9, 0.37, 0.64
SHARES = {"force": 0.39, "voltage": 0.07, "slide": 0.54}
SLIDE = 120e-6  # m, largest step
SAMPLE = 0.04  # of a waveform: as of a charge, which has 2 to 3 steps
FORMULATIONS = {"penalty": 1.0, "nitsche": 3.96, "augmented": 7.56}
SECONDS = 2.84e-6  # of the processor, for a factorisation and an unknown
UNKNOWNS = (40_706, 897_618)  # of the meshes that it was measured on, docs/performance.json
ERRORS, BESIDE = 0.481, 0.212  # of the path's time: the error estimate; start, set-up and output
COMPILING = 24.6  # s of the processor, once for each version and machine
FACTOR = 2.0  # of the true cost and the expected one, either way, where the scene is like those of the kept runs


@dataclass(frozen=True)
class Cost:
    """What a run will take, roughly; times are of the processor (s)."""

    factorisations: float
    path: float
    """Time of the loads."""
    errors: float
    """Time of the error estimate; zero without one."""
    beside: float
    """Time of start, set-up and output, without compiling."""

    @property
    def seconds(self) -> float:
        """Time of the whole run (s)."""
        return self.path + self.errors + self.beside


def expected(scene: Scene, needed: ModelOptions, unknowns: float) -> Cost:
    """Return what the path of a scene's loads will take on the mesh that it starts from.

    Args:
        scene: what is run.
        needed: the parts of the model.
        unknowns: of the mesh.
    """
    loads = factorisations(scene)
    path = sum(by_load(scene, unknowns))
    return Cost(sum(loads), path, ERRORS * path if needed.errors else 0.0, BESIDE * path)


def by_load(scene: Scene, unknowns: float) -> list[float]:
    """Return the processor time (s) of each load on a mesh of so many unknowns.

    Outside of the kept runs, see :func:`beyond_loads`, these times are good for their ratios at most.
    """
    return [SECONDS * number * unknowns for number in factorisations(scene)]


def factorisations(scene: Scene) -> list[float]:
    """Return the number of factorisations of each load, at most that of the largest force and voltage of kept runs."""
    found = []
    for _, f_ext, voltage, share in _conditions(scene):
        (least, most), (_, highest) = KNOWN_FORCES, KNOWN_VOLTAGES
        force, voltage = min(max(f_ext, least), most) / 75.0, min(abs(voltage), highest)
        found.append(share * RUNS * force**FORCE * math.exp(VOLTAGE * (voltage / 200.0) ** 2))
    factor = FORMULATIONS[scene.contact.formulation] / scene.numerics.step_scale
    return [number * factor for number in found]


def beyond_loads(scene: Scene) -> str:
    """Return why the work of a scene is not known: a load outside of the kept runs; empty where it is known."""
    (least, most), (_, highest) = KNOWN_FORCES, KNOWN_VOLTAGES
    for name, f_ext, voltage, _ in _conditions(scene):
        if not (least <= f_ext <= most and abs(voltage) <= highest):
            kept = f"{least:g} to {most:g} N/m and up to {highest:g} V"
            force = f"{f_ext:g} N/m" if f_ext else "no f_ext"
            return f"it was measured at {kept}, and the load {name} has {force} and {voltage:g} V"
    return ""


def beyond_mesh(unknowns: float) -> str:
    """Return why the time of a factorisation is not known, empty where it is."""
    least, most = UNKNOWNS
    if least <= unknowns <= most:
        return ""
    return f"it was measured with {about(least)} to {about(most)} unknowns, and the mesh has some {about(unknowns)}"


def _conditions(scene: Scene) -> Iterator[tuple[str, float, float, float]]:
    """Yield name, force (N/m), voltage (V) and share of the default run's work of each load."""
    f_ext, voltage = 0.0, 0.0
    for _, load, way in ways(scene.loads()):
        f_ext = load.f_ext if load.f_ext is not None else f_ext
        wave, share = load.wave, _share(load)
        if wave is not None:
            # Its steps are as many as its samples, or as a slide takes; the factor below is that of smaller steps.
            share = SAMPLE * max(wave.count(load.seconds(way or 0.0), 1.0), abs(way or 0.0) / SLIDE)
        voltage = wave.peak if wave is not None else voltage if load.level is None else load.level
        yield load.name, f_ext, voltage, share


def _share(load: Load) -> float:
    share = SHARES["slide"] if load.bone_x is not None or load.bone_x_by is not None else 0.0
    share += SHARES["voltage"] if load.voltage is not None else 0.0
    return share + (SHARES["force"] if load.f_ext is not None or load.bone_height is not None else 0.0)
