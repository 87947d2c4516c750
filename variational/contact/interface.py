"""The laws by which skin touches the screen, as the weak form of :mod:`~variational.problem` takes them."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from variational.attraction import electroadhesion
from variational.attraction.adhesion import Adhesion
from variational.contact.formulation import Formulation
from variational.contact.friction import Friction, law_of


@dataclass(frozen=True)
class Interface:
    """Laws of the contact with the screen."""

    formulation: Formulation
    """How contact and friction enter the weak form."""
    friction: Friction | None
    """Law of friction; given as a number it is the friction coefficient of Coulomb's law. None or zero leaves friction
    out of the forms."""
    h_0: float
    """Effective insulator thickness (m)."""
    attraction: electroadhesion.Attraction | None = electroadhesion.ELECTROSTATIC
    """What draws the skin to the screen; None leaves it out of the forms."""
    share: Callable[[np.ndarray], np.ndarray] | None = None
    """Voltage that attracts across air gaps (m), over :attr:`.Problem.voltage`; None where it is the same for all."""
    adhesion: Adhesion | None = None
    """What draws the skin to the screen without a voltage, beside the attraction; None leaves it out of the forms."""

    def __init__(
        self,
        formulation: Formulation,
        friction: Friction | float | None,
        h_0: float,
        attraction: electroadhesion.Attraction | None = electroadhesion.ELECTROSTATIC,
        share: Callable[[np.ndarray], np.ndarray] | None = None,
        adhesion: Adhesion | None = None,
    ) -> None:
        """Take the laws as they are described above.

        Raises:
            ValueError: friction or adhesion is no law; in one sentence.
        """
        law = law_of(friction)
        if adhesion is not None:
            adhesion.check()
        laws = {"formulation": formulation, "friction": law, "h_0": h_0, "attraction": attraction, "share": share,
                "adhesion": adhesion}  # fmt: skip
        for name, value in laws.items():
            object.__setattr__(self, name, value)
