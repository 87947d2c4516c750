"""What can be refused of a scene before its finger is meshed: a geometry that cannot be, and too many elements."""

import re

from fingerpad.model.memory import refuse_sizes
from fingerpad.model.options import plan
from fingerpad.model.touching import by_rule
from fingerpad.scene.messages import SceneError, qualify
from fingerpad.scene.scene import Scene
from geometry import sizing
from geometry.parameters import Fingertip
from geometry.profiles import GeometryError


def check(scene: Scene) -> None:
    """Refuse a scene whose finger cannot be built or meshed.

    Raises:
        SceneError: layers touch or cross, ridges do not fit, the bone touches the skin, elements are too large, or so
            many that they need more memory than the scene allows.
    """
    if scene.geometry.file is not None:  # checked when it is read
        return
    try:
        sizing.check(scene.geometry, scene.mesh)
        refuse_sizes(scene.geometry, by_rule(scene).mesh, scene.numerics, plan(scene))
    except GeometryError as error:
        message = re.sub(r"\bcontact size (\S+) m is", r"mesh.contact is \1 m,", str(error))
        raise SceneError(qualify(message, "geometry.", Fingertip.model_fields)) from None
