"""The structure of the product that CONTRIBUTING promises: no import circle, no long module, few levels."""

import pytest

from benchmarks import structure

FILES = {name: path for folder in structure.PRODUCT for name, path in structure.modules(folder).items()}


def test_no_import_circle():
    """Counting the imports inside functions and for type checkers, too."""
    assert [group for group in structure.circles(structure.imports(FILES)) if len(group) > 1] == []


def test_no_module_is_long():
    """A module is one idea; past 350 lines it is two."""
    assert [name for name, path in FILES.items() if structure.lines(path) > structure.LONGEST] == []


def test_few_levels():
    """Eleven levels of modules that are imported when the program runs."""
    assert max(structure.levels(structure.imports(FILES, ())).values()) <= 11


@pytest.mark.parametrize(
    ("graph", "circles", "height"),
    [({"a": set(), "b": {"a"}, "c": {"b"}}, [], 3), ({"a": {"b"}, "b": {"a"}, "c": {"b"}}, [["a", "b"]], 2)],
)
def test_levels_and_circles_of_a_graph(graph, circles, height):
    """The modules of a circle have one level."""
    assert [group for group in structure.circles(graph) if len(group) > 1] == circles
    assert max(structure.levels(graph).values()) == height
