"""The closed form of a finger as a function of force and voltage: for fits and bands, which need thousands of answers.

It has the numbers of the model "cylinders" (:mod:`fingerpad.reduced.cylinders`) at full slip, without results, cautions
and known errors. Friction, roughness and coating are those of the scene; shape and layers are in the press.
"""

from dataclasses import dataclass, field
from typing import NamedTuple

from fingerpad.reduced.cylinders import over_forces
from fingerpad.reduced.press import Press, of
from fingerpad.scene.scene import Scene
from fingerpad.slices import traces
from fingerpad.slices.total import at_force, profile
from fingerpad.slices.trace import Trace, columns, trace
from variational.state import ContactState

_SLIP = "full_slip"
_LARGEST = 400.0  # N/m, at the end of a trace


class Answer(NamedTuple):
    """Full slip of a section (N/m, m), or of a whole finger (N, m²)."""

    mu_app: float
    f_t: float
    """Friction force."""
    f_electrostatic: float
    """Attraction."""
    contact: float
    """Length, or area, of the ridges in contact."""
    gross: float
    """Gross width, or area."""
    indentation: float
    """How far the bone is lowered (m), without voltage."""
    d_eq: float
    """Mean equivalent air gap over the ridges in contact (m)."""

    @property
    def share(self) -> float:
        """Part of the gross area in which ridges touch."""
        return self.contact / self.gross


@dataclass(frozen=True, eq=False)
class ClosedForm:
    """The closed form of a scene's finger."""

    scene: Scene
    press: Press
    _traces: dict[float | None, Trace] = field(default_factory=dict)

    def section(self, f_ext: float, voltage: float | None = None) -> Answer:
        """Return full slip of the middle section.

        Args:
            f_ext: external force (N/m).
            voltage: (V); by default that of the scene, which may be a drive.

        Raises:
            SceneError: there is no equilibrium.
        """
        (state,) = self._states([f_ext], voltage)
        p_c = state.f_contact / state.contact_length
        values = columns([state], self.scene.geometry.ridge_wavelength)
        return Answer(
            state.mu_app, state.f_t, state.f_electrostatic, state.contact_length, float(values["gross_width"][0]),
            -state.bone_height, float(self.scene.closure()(p_c).d_eq),
        )  # fmt: skip

    def finger(self, force: float, voltage: float | None = None) -> Answer:
        """Return full slip of the whole finger.

        Args:
            force: external force (N).
            voltage: (V); by default that of the scene, which may be a drive.

        Raises:
            SceneError: there is no equilibrium, or the pad along the finger is too short for the force.
        """
        slices = self.scene.slices
        total = at_force(profile(slices), self._trace(voltage), force, slices.count)
        sums, weight = total.totals, total.thickness * total.columns["contact_length"]
        gaps = self.scene.closure()(total.pressure[weight > 0]).d_eq
        return Answer(
            total.mu_app, sums["f_t"], sums["f_electrostatic"], sums["contact_area"], sums["gross_area"], total.delta,
            float(weight[weight > 0] @ gaps / weight.sum()),
        )  # fmt: skip

    def _states(self, f_ext: list[float], voltage: float | None) -> list[ContactState]:
        scene = self.scene if voltage is None else self.scene.model_copy(update={"voltage": float(voltage)})
        return self.press.lowered(over_forces(scene, f_ext, _SLIP, self.press), _SLIP)

    def _trace(self, voltage: float | None) -> Trace:
        """Return the trace of the section at a voltage (V), which is kept for other forces."""
        if voltage not in self._traces:
            states = self._states(traces.grid(_LARGEST / 2, _LARGEST), voltage)
            self._traces[voltage] = trace(states, self.scene.geometry.ridge_wavelength)
        return self._traces[voltage]


def closed_form(scene: Scene | None = None, press: Press | None = None) -> ClosedForm:
    """Return the closed form of a scene's finger, for many forces and voltages.

    Args:
        scene: with friction, roughness, coating and the finger's shape along its axis; by default the default scene.
        press: of the finger, in place of its own, such as one interpolated between presses.

    Raises:
        SceneError: the finger has no press yet; ``fp.press(scene)`` makes it.
    """
    scene = Scene() if scene is None else scene
    return ClosedForm(scene, of(scene) if press is None else press)
