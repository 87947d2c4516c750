"""Materials of layers as a weak form has them: one kernel a law, whose numbers are fields with one value a cell."""

from collections.abc import Mapping
from typing import TYPE_CHECKING

import dolfinx
from dolfinx import fem

if TYPE_CHECKING:
    from variational.materials.material import Material


def grouped(
    solids: Mapping[int, "Material"], cellwise: fem.FunctionSpace, cell_tags: dolfinx.mesh.MeshTags
) -> dict[tuple[int, ...], "Material"]:
    """Return the law of each group of layers, with fields in the place of its numbers.

    Args:
        solids: material of each layer's tag.
        cellwise: space of one number a cell.
        cell_tags: tags of layers.

    Raises:
        ValueError: a material that is none; in one sentence.
    """
    groups: list[list[int]] = []
    for tag, solid in solids.items():
        solid.check()
        mine = next((g for g in groups if solids[g[0]].kind() == solid.kind()), None)
        groups.append([tag]) if mine is None else mine.append(tag)

    def field(values: Mapping[int, float]) -> fem.Function:
        f = fem.Function(cellwise)
        for tag, value in values.items():
            f.x.array[cell_tags.find(tag)] = value
        f.x.scatter_forward()
        return f

    found: dict[tuple[int, ...], Material] = {}
    for group in groups:
        first = solids[group[0]]
        fields = {name: field({tag: solids[tag].number(name) for tag in group}) for name in first.names()}
        found[tuple(group)] = first.with_values(fields)
    return found
