"""Checkpoints of a list that grows: what was written is not written again, and each of the last two has all of it."""

from pathlib import Path

import numpy as np
import pytest

from fingerpad.results.folder import CheckpointError
from fingerpad.runs.checkpoint import Checkpoint

HEAD = {"source": "a"}


def checkpoint(folder: Path) -> Checkpoint:
    return Checkpoint(folder, {}, HEAD)


def items(first: int, count: int) -> list[np.ndarray]:
    return [np.arange(1000.0) + k for k in range(first, first + count)]


def read(folder: Path) -> tuple[int, list[int]]:
    """The number that was kept, and the items by their first values."""
    from_there = checkpoint(folder)
    found = from_there.read()
    return found["number"], [int(each[0]) for each in found["items"]]


def test_items_are_written_once(tmp_path):
    """The file of what is new has the size of what is new, however long the list is."""
    kept, grown = checkpoint(tmp_path), list[np.ndarray]()
    for number in range(1, 6):
        grown += items(2 * len(grown), 2)
        kept.write({"number": number}, grown)
    sizes = [file.stat().st_size for file in sorted((tmp_path / "checkpoint").glob("*.more.npz"))]
    assert len(sizes) == 5
    assert max(sizes) < 2.2 * 8000
    assert max(file.stat().st_size for file in (tmp_path / "checkpoint").glob("????.npz")) < 2000
    assert read(tmp_path) == (5, [int(each[0]) for each in grown])


def test_goes_on_from_the_one_before(tmp_path):
    """The last one is gone; what follows is written over what it had."""
    kept, grown = checkpoint(tmp_path), items(0, 2)
    for number in (1, 2, 3):
        kept.write({"number": number}, grown)
        grown = [*grown, *items(10 * number, 1)]
    (tmp_path / "checkpoint" / "0003.npz").unlink()
    again = checkpoint(tmp_path)
    found = again.read()
    assert [int(each[0]) for each in found["items"]] == [0, 1, 10]
    again.write({"number": 3}, [*found["items"], *items(70, 1)])
    assert read(tmp_path) == (3, [0, 1, 10, 70])


def test_damaged_items(tmp_path):
    """Of the last checkpoint, and of an earlier one."""
    kept, grown = checkpoint(tmp_path), items(0, 2)
    kept.write({"number": 1}, grown)
    kept.write({"number": 2}, [*grown, *items(5, 1)])
    more = tmp_path / "checkpoint" / "0002.more.npz"
    whole = more.read_bytes()
    more.write_bytes(whole[:100])
    with pytest.raises(CheckpointError, match=r"0002\.more\.npz cannot be read .*; delete the last checkpoint"):
        read(tmp_path)
    more.write_bytes(whole)
    (tmp_path / "checkpoint" / "0001.more.npz").unlink()
    with pytest.raises(CheckpointError, match=r"0001\.more\.npz cannot be read .* run again without --resume"):
        read(tmp_path)
