"""Figs. 4 and 5: the least air gap, and both readings of the stickiness threshold."""

from benchmarks.paper.statement import Statement, statement
from fingerpad.scene import Scene


def statements() -> list[Statement]:
    """Return the microscale's statements."""
    scene = Scene()
    bam = scene.roughness.bearing_area(scene.h_0)
    least, estimate, exact = float(bam.air_gap(0.0)), bam.threshold(approximate=True), bam.threshold()
    near = (abs(voltage / 155 - 1) < 0.01 for voltage in (exact, estimate))
    return [
        statement("limit", {"d_eq": least}, abs(least / 1.49e-6 - 1) < 0.005),
        statement("threshold", {"eq_15": estimate, "eq_9": exact}, *near),
    ]
