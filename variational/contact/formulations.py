"""The contact formulations by their names in a scene, key ``contact.formulation``."""

from variational.contact.augmented import AugmentedLagrangian
from variational.contact.formulation import Formulation
from variational.contact.nitsche import Nitsche
from variational.contact.penalty import Penalty

FORMULATIONS: dict[str, type[Formulation]] = {
    "penalty": Penalty,
    "nitsche": Nitsche,
    "augmented": AugmentedLagrangian,
}
