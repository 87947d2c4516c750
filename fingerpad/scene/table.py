"""What every table of a scene is: it refuses keys that it does not have, and cannot be changed."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

Finite = Annotated[float, Field(strict=True, allow_inf_nan=False)]
Switch = Annotated[bool, Field(strict=True)]


class Part(BaseModel):
    """A table that refuses keys it does not have, and cannot be changed."""

    model_config = ConfigDict(extra="forbid", frozen=True)
