r"""What a run of a scene will take, by a rule from kept runs; within a factor of 2 where the scene is like theirs.

Processor time is factorisations times unknowns times a constant. Factorisations are those of a press, a charge and a
slide to full slip, fitted to the 40 full runs of ``docs/models.json`` (0.83 to 1.31 times theirs):

.. math:: n = 160 \, (f_{ext} / 75 N/m)^{0.33} \, e^{0.74 (U / 200 V)^2}

of which the three loads of the default run have 0.26, 0.10 and 0.64; time, shares and the factors of the formulations
are those of ``docs/chart.json``. ``tests/test_command_mesh.py`` derives all of them again.
"""

import math
from dataclasses import dataclass

from fingerpad.model.memory import estimate
from fingerpad.model.options import ModelOptions
from fingerpad.scene import Load, Scene

RUNS, FORCE, VOLTAGE = 160.0, 0.33, 0.74
SHARES = {"force": 0.26, "voltage": 0.10, "slide": 0.64}
FORMULATIONS = {"penalty": 1.0, "nitsche": 1.85, "augmented": 7.15}
SECONDS = 8.2e-6  # of the processor, for a factorisation and an unknown


@dataclass(frozen=True)
class Cost:
    """What a run will take, roughly."""

    factorisations: float
    seconds: float
    """Of the processor (s), the set-up included."""


def expected(scene: Scene, needed: ModelOptions) -> Cost:
    """Return what the path of a scene's loads will take on the mesh that it starts from."""
    f_ext, voltage, total = 0.0, 0.0, 0.0
    for load in scene.loads():
        f_ext = load.f_ext if load.f_ext is not None else f_ext
        voltage = load.voltage if load.voltage is not None else voltage
        force = max(f_ext, 1.0) / 75.0
        total += _share(load) * RUNS * force**FORCE * math.exp(VOLTAGE * (voltage / 200.0) ** 2)
    total *= FORMULATIONS[scene.contact.formulation] / scene.numerics.step_scale
    return Cost(total, SECONDS * total * estimate(scene, needed).unknowns)


def _share(load: Load) -> float:
    share = SHARES["slide"] if load.bone_x is not None else 0.0
    share += SHARES["voltage"] if load.voltage is not None else 0.0
    return share + (SHARES["force"] if load.f_ext is not None or load.bone_height is not None else 0.0)
