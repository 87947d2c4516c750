"""The models by name, the cheapest first: where a reduced model of one's own is registered."""

from typing import TYPE_CHECKING

from fingerpad.model.options import check
from fingerpad.reduced.cylinders import Cylinders
from fingerpad.reduced.model import Model
from fingerpad.results.data import FULL_WORDS
from fingerpad.scene import Scene
from fingerpad.scene.messages import SceneError, show
from fingerpad.scene.reading import DEFAULT_MODEL

if TYPE_CHECKING:
    from fingerpad.results.result import Result
    from fingerpad.runs.context import RunContext


class Full(Model):
    """The whole cross-section with every ridge, along the path of its loads (:mod:`fingerpad.runs.full`)."""

    name, words = DEFAULT_MODEL, FULL_WORDS
    traces = "traces of the full model"
    meshes = path = resumes = True

    def check(self, scene: Scene) -> None:
        """Refuse a scene whose finger cannot be built or meshed, see :func:`fingerpad.model.options.check`."""
        check(scene)

    def solve(self, scene: Scene, context: "RunContext") -> "Result":
        """Reach every load, see :func:`fingerpad.runs.full.run`; collective."""
        from fingerpad.runs import full  # finite elements

        return full.run(scene, context)


MODELS: dict[str, Model] = {
    "cylinders": Cylinders(),
    "full": Full(),
}
"""The models by name."""


def find(name: str) -> Model:
    """Return a model by its name.

    Raises:
        SceneError: there is none.
    """
    if not (isinstance(name, str) and name in MODELS):
        raise SceneError(f"model is {show(name)}; it must be {' or '.join(map(repr, MODELS))}")
    return MODELS[name]
