"""Limits of friction by other functions than arithmetic."""

from dataclasses import dataclass

import numpy as np
import pytest
import ufl

import fingerpad as fp
from fingerpad.scene import SceneError
from tests.small_finger import small
from variational.contact.friction import Friction

pytestmark = pytest.mark.slow


# -- limits ----------------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Cap(Friction):
    """A sharp limit, by the type of p as docs/laws.md has it."""

    mu_f: float = 0.5
    tau: float = 20e3

    def limit(self, p):
        least = ufl.min_value if isinstance(p, ufl.core.expr.Expr) else np.minimum
        return least(self.mu_f * p, self.tau)


@dataclass(frozen=True)
class Tanh(Friction):
    """Of NumPy alone."""

    def limit(self, p):
        return 1e3 * np.tanh(p / 1e3)


@pytest.mark.parametrize(("f_ext", "ratio"), [(200.0, 1.11), (2000.0, 1.02)])
def test_limit_with_other_functions_than_arithmetic(f_ext, ratio):
    """A cap that bears all along the contact: its strength is per reference area, which docs/laws.md compares."""
    scene = small(f_ext=f_ext, voltage=0.0, output={"receptors": False, "errors": False})
    slip = fp.run(scene.replace(friction=Cap(10.0, 1e3))).full_slip
    assert slip.f_t / (1e3 * slip.contact_length) == pytest.approx(ratio, abs=0.01)


def test_limit_that_the_weak_form_cannot_take_is_refused():
    scene = small(output={"receptors": False, "errors": False})
    with pytest.raises(SceneError, match="the limit of the law Tanh cannot be put into the weak form"):
        fp.run(scene.replace(friction=Tanh()))
