"""Values at full slip by a model without a path, one state alone: what a search over a key evaluates many times."""

from collections.abc import Sequence
from dataclasses import dataclass

from fingerpad.reduced.model import Model
from fingerpad.results.quantities import Output
from fingerpad.results.result import Result
from fingerpad.runs.context import RunContext
from fingerpad.scene import Scene
from fingerpad.scene.messages import SceneError
from fingerpad.slices import traces
from fingerpad.slices.total import Total, profile
from variational.coefficients import LawError

STATE = "full_slip"


@dataclass(frozen=True)
class ClosedForm:
    """A model without a path, by the state of full slip."""

    model: Model

    def value(self, scene: Scene, quantity: Output, whole: bool) -> float:
        """Return a quantity (SI): of the whole finger under ``force``, or of the section under ``f_ext``.

        Raises:
            SceneError: the model has no full slip here.
        """
        return self.values(scene, [quantity.name], whole)[0]

    def values(self, scene: Scene, names: Sequence[str], whole: bool) -> list[float]:
        """Return quantities (SI) by their names, as :meth:`value` does."""
        try:
            self.model.check(scene)
            if whole:
                found = self._total(scene).values
                return [found[name] for name in names]
            (state,) = self.model.over_forces(scene, [scene.f_ext], STATE, self.section)
        except LawError as error:
            raise SceneError(str(error)) from error
        return [float(getattr(state, name)) for name in names]

    def section(self, scene: Scene) -> Result:
        """Return the result of the section: the scene's own, or that at the centre of the finger under ``force``."""
        if scene.force is not None:
            centre = self._total(scene).centre / profile(scene.slices).centre_scale
            scene = scene.replace(f_ext=centre)
        return self.model.solve(scene, RunContext())

    def result(self, scene: Scene) -> Result:
        """Return the result of a scene without its bands over assumptions, of the whole finger under ``force``.

        Raises:
            SceneError: the scene has no result.
        """
        try:
            self.model.check(scene)
            if scene.force is not None:
                return traces.whole(scene, self.model, self.section)
            section = self.section(scene)
            return traces.with_sum(section, self.model, self.section) if self.model.sums else section
        except LawError as error:
            raise SceneError(str(error)) from error

    def newtons(self, scene: Scene) -> float:
        """Return the force (N) on the whole finger whose centre bears ``f_ext`` (N/m), as a run of the model has it.

        A voltage does not change it.

        Raises:
            SceneError: there is no such finger.
        """
        found = self.result(scene.replace(voltage=0.0))
        if found.finger is None:
            raise SceneError(found.notes[-1].partition(": ")[2])
        return found.finger.f_ext

    def _total(self, scene: Scene) -> Total:
        section = scene.model_copy(update={"force": None})

        def traced(name: str, top: float) -> traces.Traced:
            return traces.Traced(*traces.of_points(section, self.model, self.section, name, scene.centre_force, top))

        found = traces.Reach(scene, traced).follow(STATE).total
        assert found is not None
        return found
