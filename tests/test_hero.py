"""The picture that opens the README is drawn from the numbers in git."""

from matplotlib.image import imread

from benchmarks import hero
from benchmarks.harness import DOCS, kept


def test_hero_is_drawn_from_kept_numbers(tmp_path):
    (tmp_path / "hero.json").write_bytes((DOCS / "hero.json").read_bytes())
    image = imread(hero.draw(tmp_path))
    assert image.shape[1] >= 900 and image[:, :, :3].std() > 0.05


def test_friction_doubles():
    """As the picture's title says: from the friction coefficient at 0 V to more than twice as much at 200 V, 75 N/m."""
    voltages, mu = zip(*kept("hero").numbers["friction"]["75"], strict=True)
    assert voltages == (0, 50, 100, 150, 200)
    assert abs(mu[0] - 0.25) < 1e-6 and mu[-1] > 2 * mu[0]
