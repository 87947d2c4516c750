"""What every table of a scene is: it refuses keys that it does not have, and cannot be changed."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Finite = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Switch = Annotated[bool, Field(strict=True)]
MOST_BYTES = 1_000_000
"""Largest size of a scene, or of a table of voltages; the longest scene that comes along has 1000 bytes."""


class Part(BaseModel):
    """A table that refuses keys it does not have, and cannot be changed."""

    model_config = ConfigDict(extra="forbid", frozen=True)
