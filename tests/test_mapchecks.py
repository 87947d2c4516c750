"""Height maps with values that are no heights: numbers, marks, stitched parts and lines that are off."""

import itertools
from pathlib import Path

import numpy as np
import pytest

from tests.test_heightfile import PLAIN, smooth
from tests.test_topography import grid
from variational.roughness.heightfile import scan
from variational.roughness.mapchecks import mark, refuse_uneven
from variational.roughness.spectrum import SelfAffine


@pytest.mark.parametrize("save", [np.savetxt, np.save])
def test_numbers_of_lines_and_columns_are_refused(save, tmp_path):
    """As pandas writes index and header, and instruments coordinates; whether or not the corner has a number."""
    h = SelfAffine().surface((40, 36), (100e-6, 90e-6), 3).heights * 1e6
    across, along = 2.5 * np.arange(36), np.arange(40)
    both = np.block([[np.full((1, 1), np.nan), np.arange(36)[None]], [along[:, None], h]])
    name = tmp_path / ("map.npy" if save is np.save else "map.txt")
    for heights, words in (
        (np.vstack([across, h]), "first line, from 2.5 to 87.5"),
        (np.column_stack([along, h]), "first column, from 1 to 39"),
        (both, "first line, from 0 to 35"),
        (np.column_stack([np.append(np.nan, 1e3 + along), np.vstack([-across, h])]), "first line, from -0 to -87.5"),
    ):
        save(name, heights)
        with pytest.raises(ValueError, match=f"at equal steps in its {words}, which number or place the others"):
            scan(name, **PLAIN)
    x, y = grid((40, 36), (100, 90))
    save(name, 0.2 * x - 0.1 * y)  # a plane has equal steps everywhere
    assert scan(name, **PLAIN).missing == 0
    save(name, h)
    assert np.ptp(scan(name, **PLAIN).map.heights) == pytest.approx(1e-6 * np.ptp(h))


def sizes(h: np.ndarray) -> np.ndarray:
    return np.vstack([np.append([40, 36, 2.5, 2.5], np.zeros(h.shape[1] - 4)), h])


def numbered_last(h: np.ndarray) -> np.ndarray:
    return np.column_stack([h, np.arange(len(h))])


def off(h: np.ndarray) -> np.ndarray:
    return h + 3 * np.random.default_rng(0).normal(size=(len(h), 1))


def stitched(h: np.ndarray) -> np.ndarray:
    return h + np.where(np.arange(len(h)) < 21, 0, 20.0)[:, None]


@pytest.mark.parametrize("turn", [False, True])
@pytest.mark.parametrize(
    ("wrong", "words", "turned"),
    [
        (sizes, "from line 1 to 2, .* the first line seems to hold no heights", "from column 1 to 2, .* the first col"),
        (numbered_last, "equal steps in its last column, from 1 to 39", "equal steps in its last line, from 1 to 39"),
        (off, r"lines that are .* off from one to the next as a whole", "columns that are .* off from one to the next"),
        (stitched, "step of 2e-05 m .* from line 21 to 22, .* stitched", "step of 2e-05 m .* from column 21 to 22, .*"),
    ],
)
def test_lines_that_are_no_part_of_the_surface_are_refused(tmp_path, wrong, words, turned, turn):
    """Of 2.6 µm each makes an rms height of 3 to 10 µm."""
    h = wrong(smooth())
    np.save(tmp_path / "map.npy", h.T if turn else h)
    with pytest.raises(ValueError, match=turned if turn else words):
        scan(tmp_path / "map.npy", **PLAIN)
    if wrong is not numbered_last:
        assert scan(tmp_path / "map.npy", **PLAIN, missing="nan").map.h_rms > 3e-6


@pytest.mark.parametrize("hurst", [0.3, 0.95])
def test_surfaces_of_nature_have_no_such_lines(hurst):
    """Self-affine ones, with ridges along the lines or across, or a groove: 60 maps of each kind, none refused."""
    ridges = 50 * np.sin(np.arange(40) / 6)[:, None]
    groove = np.where(np.arange(40) == 20, -90.0, 0.0)[:, None]
    for seed, n in itertools.product(range(20), (16, 24, 40)):
        h = SelfAffine(hurst=hurst).surface((n, n), (2.5e-6 * n, 2.5e-6 * n), seed).heights * 1e6
        for each in (h, h + ridges[:n], h.T + groove[-n:], (h + ridges[:n]).T):
            refuse_uneven(Path("map"), each)


@pytest.mark.parametrize("width", [1, 3, 20])
def test_deep_grooves_are_no_marks(width):
    """Walls are steep and 1000 interquartile ranges deep, but the floor has heights of its own."""
    h = 0.1 * np.random.default_rng(1).normal(size=(64, 64))
    h[30 : 30 + width] -= 135.0
    assert mark(h) is None


def test_marks_among_extremes_and_coarse_steps():
    """Of two extreme values neither hides the other; heights in whole steps, most of them equal, are none."""
    h = np.random.default_rng(1).normal(size=(20, 20))
    h[0, :3], h[1, 1] = -9999, 32767
    assert mark(h) == 32767
    h[1, 1] = np.nan
    assert mark(h) == -9999
    h = np.zeros((20, 20))
    h[3, 3:8] = [1, 2, 3, 4, 5]
    assert mark(h) is None and mark(np.zeros((4, 4))) is None
    h[4, 4] = -9999
    assert mark(h) == -9999
