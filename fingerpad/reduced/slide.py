r"""How far a bone goes until its finger slips fully, by a rule of thumb, for the check of a scene before its run.

Friction grows about in proportion to the way, the faster the more ridges touch: by :data:`STIFFNESS` a ridge. With
friction and ridges of the cylinders (:mod:`fingerpad.reduced.cylinders`) the way is

.. math:: x = f_t / (k \, n)

In full runs of the default finger full slip begins at 1.3 to 1.4 mm (75 N/m, 200 V), 1.2 mm (75 N/m, 150 V) and
0.83 mm (10 N/m, 200 V); the rule is within 15 % of these. What stops the slide is kept as ``bone_x`` of the first step
with ``all_slip`` in ``steps.csv``.
"""

from collections.abc import Iterator

from fingerpad.reduced import cylinders
from fingerpad.scene import Scene, SceneError
from fingerpad.scene.loads import ways

STIFFNESS = 1.6e3
"""Friction of a ridge over the way (N/m²). *Assumption*: of a finger of the default shape and skin."""


def way(scene: Scene, f_ext: float, voltage: float) -> float:
    """Return about how far the bone must be from where it was unloaded for full slip (m).

    Args:
        scene: its laws and shape.
        f_ext: external force (N/m).
        voltage: of Eq. 3 (V).

    Raises:
        SceneError: the cylinders have no answer.
    """
    state = cylinders.solve(scene.replace(history=None, f_ext=f_ext, voltage=voltage)).full_slip
    if state is None:
        raise SceneError("the cylinders do not slip")
    return state.f_t / (STIFFNESS * state.ridges_in_contact)


def too_short(scene: Scene) -> Iterator[str]:
    """Yield a sentence for each waveform whose load may end before the finger slips fully; none where not known."""
    force, farthest = 0.0, 0.0
    place: float | None = 0.0
    for _, load, moved in ways(scene.loads()):
        force = load.f_ext if load.f_ext is not None else force
        place = None if place is None or moved is None or load.until_full_slip else place + moved
        if place is None or load.bone_height is not None:
            return
        farthest = max(farthest, abs(place))
        if load.wave is None or not moved or not force:
            continue
        try:
            needed = way(scene, force, load.wave.peak)
        except SceneError:
            return
        if needed > farthest:
            yield (
                f"{load.name}: the finger may never slip fully, since that needs some {1e3 * needed:.2g} mm from where "
                f"it was unloaded, by a rule of thumb, and the bone goes {1e3 * farthest:.2g} mm"
            )
