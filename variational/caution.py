"""A caution: a sentence on a limit of validity that a scene, a law, a state or a result has reached."""

import re
from dataclasses import dataclass


@dataclass(frozen=True)
class Caution:
    """Why numbers may be further off than their errors say."""

    code: str
    """Name of the limit, such as ``closure_range``."""
    text: str
    """One sentence without its full stop."""
    number: float | None = None
    """Quantity that is beyond the limit, in SI; None where it is no number."""

    def __str__(self) -> str:
        """Return the text."""
        return self.text

    @property
    def form(self) -> str:
        """The text without its numbers, which differ from state to state."""
        return re.sub(r"[-+]?\d[\d.]*(e[-+]?\d+)?(, (?=\d))?", "", self.text)
