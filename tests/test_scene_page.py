"""The scene reference is what its generator writes, and every key in it has a meaning."""

from pathlib import Path

from fingerpad.cli.params import page
from fingerpad.scene import Scene
from fingerpad.scene.keys import every

PAGE = Path(__file__).parents[1] / "docs" / "scene.md"


def test_page_is_the_generated_one():
    """If not: fingerpad params --markdown > docs/scene.md."""
    assert PAGE.read_text(encoding="utf-8") == page(list(every(Scene))) + "\n"


def test_every_key_has_a_meaning():
    assert [key.name for key in every(Scene) if not key.meaning] == []
