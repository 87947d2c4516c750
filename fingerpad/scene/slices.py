"""The table of a scene that gives the finger's shape along its axis, for forces in newtons."""

from typing import Annotated

from pydantic import Field, model_validator

from fingerpad.scene.messages import show
from fingerpad.scene.table import Finite, Part
from geometry.units import within

MOST = 1000
# A finger of the default's width bears some 0.53 N where its centre bears 75 N/m; forces grow as F^0.77.
LINE, POINT, POWER, WIDTH = 75.0, 0.53, 0.77, 20e-3
Place = Annotated[Finite, within(1e-9, 0.1, "m", zero=True, sides=2)]
Height = Annotated[Finite, within(1e-9, 0.1, "m", zero=True)]
Scale = Annotated[Finite, within(0.1, 10)]
Many = Field(min_length=1, max_length=MOST)


class Slices(Part):
    """Shape of the finger along its axis z, cut in slices (:mod:`fingerpad.slices`); no part of the cross-section.

    Without a table of heights the finger's lower side is a parabola of radius ``radius``.
    """

    radius: Annotated[Finite, within(1e-3, 1, "m")] = 28e-3
    """Radius R_z of the lower side along the axis. *Assumption*: 28 mm is that of an ellipse with semi-axes of 14 mm
    along the finger and 7 mm in height; likely values are 15 to 40 mm. Range: the end of a finger to a straight one."""
    length: Annotated[Finite, within(1e-3, 0.2, "m")] = 28e-3
    """Length of the finger pad, centred on z = 0. *Assumption*: the last phalanx. A contact that is longer is
    refused."""
    tilt: Annotated[Finite, within(1e-6, 0.5, zero=True, sides=2)] = 0.0
    """Slope θ of the bone's axis to the screen (rad): a slice at z > 0 is indented by θ z less. Range: up to 29
    degrees, beyond which a finger touches with its tip."""
    z: Annotated[tuple[Place, ...], Many] | None = None
    """Places along the axis of the tables ``height`` and ``width``, growing. The finger ends at the first and the
    last."""
    height: Annotated[tuple[Height, ...], Many] | None = None
    """Height s of the lower side above its lowest point, at the places ``z``, in place of the parabola. Heights that
    are all 0 make a straight finger, which may touch up to its ends."""
    width: Annotated[tuple[Scale, ...], Many] | None = None
    """Width of the slices at the places ``z``, over that of the scene's cross-section: a slice is the cross-section
    on this scale. *Assumption*: 1 everywhere. Range: a tenth to ten times."""
    count: Annotated[int, Field(strict=True, ge=4, le=MOST)] = 48
    """Number of slices in each stretch of contact, the points of a Gauss rule. Half the default changes forces by less
    than 0.01 % and areas by less than 0.3 % on a smooth trace (``docs/newtons.md``), and by more where ridges jump."""

    @model_validator(mode="after")
    def _consistent(self) -> "Slices":
        tables = {name: values for name in ("height", "width") if (values := getattr(self, name)) is not None}
        if self.z is None:
            for name in tables:
                raise ValueError(f"{name} is given without z; give the places along the axis of its values")
            return self
        if not tables:
            raise ValueError("z is given without height or width; give one of the two, with a value for each place")
        if len(self.z) < 2:
            raise ValueError(f"z is {show(list(self.z))}; it must have two places at least, the ends of the finger")
        if any(after <= before for before, after in zip(self.z, self.z[1:], strict=False)):
            raise ValueError(f"z is {show(list(self.z))}; it must grow from each place to the next")
        for name, values in tables.items():
            if len(values) != len(self.z):
                raise ValueError(f"{name} has {len(values)} values and z has {len(self.z)}; each place needs one value")
        if self.height is not None:
            for name in {"radius", "length"} & self.model_fields_set:
                raise ValueError(
                    f"{name} is {show(getattr(self, name))} and height is given too; leave out one of them"
                )
        return self


def centre_force(force: float, width: float) -> float:
    """Return about the force at the centre of a finger (N/m): of one of the default's shape, on another scale.

    Args:
        force: on the whole finger (N).
        width: of the finger (m).
    """
    scale = width / WIDTH
    return LINE * scale * (force / (POINT * scale**2)) ** POWER
