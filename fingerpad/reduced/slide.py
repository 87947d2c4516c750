r"""How far a bone goes until its finger slips fully, by a rule of thumb, for the check of a scene before its run.

Friction grows about in proportion to the way, the faster the more ridges touch; neighbours move each other's skin, so
that n ridges are not n times as stiff. With friction and ridges of the cylinders (:mod:`fingerpad.reduced.cylinders`)
the way is

.. math:: x = f_t / (k \sqrt{n})

The root and k (:data:`STIFFNESS`) are a fit to four full runs of the default finger on facets of 20 µm, each as
``fingerpad run --set mesh.contact="20 um" --set output.errors=false --set f_ext=10``. Full slip begins at ``bone_x`` of
the first step with ``all_slip`` in their ``steps.csv``. The rule is within 10 % of these ways:

=====  ===  ======  ====
N/m    V    ridges  mm
=====  ===  ======  ====
10     200  9       0.50
30     100  12      0.44
75     150  16      1.05
75     200  16      1.33
=====  ===  ======  ====

No command of the repository makes this table; ``tests/test_too_short.py`` runs two of its loads on larger facets.
"""

from collections.abc import Iterator

from fingerpad.reduced import cylinders
from fingerpad.scene import Scene, SceneError
from fingerpad.scene.loads import ways
from fingerpad.scene.viscosity import elastic, viscous_layers

STIFFNESS = 7.0e3
"""Friction over the way and the root of the number of ridges (N/m²). *Assumption*: of the default shape and skin."""


def way(scene: Scene, f_ext: float, voltage: float) -> float:
    """Return about how far the bone must be from where it was unloaded for full slip (m).

    Args:
        scene: its laws and shape; of viscous layers their lasting elastic law, with which the way is longest.
        f_ext: external force (N/m).
        voltage: of Eq. 3 (V).

    Raises:
        SceneError: the cylinders have no answer.
    """
    layers = {name: elastic(law) for name, law in scene.materials}
    lasting = scene.model_copy(update={"materials": scene.materials.model_copy(update=layers)})
    state = cylinders.solve(lasting.replace(history=None, f_ext=f_ext, voltage=voltage)).full_slip
    if state is None:
        raise SceneError("the cylinders do not slip")
    return float(state.f_t / (STIFFNESS * state.ridges_in_contact**0.5))


def too_short(scene: Scene) -> Iterator[str]:
    """Yield a sentence for each slide that may end without full slip: one until full slip, or under a waveform.

    None where the way is not known.
    """
    force, voltage, farthest = 0.0, 0.0, 0.0
    place: float | None = 0.0
    for _, load, moved in ways(scene.loads()):
        force = load.f_ext if load.f_ext is not None else force
        voltage = load.wave.peak if load.wave is not None else voltage if load.level is None else load.level
        place = None if place is None or moved is None else place + moved
        if place is None or load.bone_height is not None:
            return
        farthest = max(farthest, abs(place))
        if load.until_full_slip:
            place = None
        elif load.wave is None:
            continue
        if not moved or not force:
            continue
        try:
            needed = way(scene, force, voltage)
        except SceneError:
            return
        less = ", less of viscous skin" if viscous_layers(scene.materials) else ""
        if needed > farthest:
            yield (
                f"{load.name}: the finger may never slip fully, since that needs some {1e3 * needed:.2g} mm from where "
                f"it was unloaded, by a rule of thumb{less}, and the bone goes {1e3 * farthest:.2g} mm"
            )
