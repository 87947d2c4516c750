"""Laws of one name and other code are told apart, and so are the folders and tables that are kept of them."""

import importlib.util
import json
import subprocess
import sys
from functools import partial

import numpy as np
import pytest

from fingerpad.scene import Scene
from fingerpad.scene.law_source import digest
from fingerpad.scene.laws import Laws, used
from variational.roughness.bam import BearingArea
from variational.roughness.closure import AirGap, Closure

MINE = """
import numpy as np
from variational.roughness.closure import AirGap, Closure
GAP = {constant}
def gap(p):
    return {inside} + 0 * np.asarray(p, dtype=float)
class Base(Closure):
    def __call__(self, p_c):
        return AirGap({base} * gap(p_c))
class ConstantGap(Base):
    def state(self, p_c, voltage):
        return {text!r}
"""
PLAIN = {"constant": 1.0, "inside": "2e-6 * GAP", "base": 1.0, "text": ""}


class Given(Closure):
    """A closure that holds whatever it is given."""

    def __init__(self, **values):
        self.__dict__.update(values)

    def __call__(self, p_c):
        return AirGap(2e-6 + 0 * np.asarray(p_c, dtype=float))

    def scaled(self, p_c):
        return 2 * p_c


def imported(folder, **changes):
    """Import the user's file anew, as a new process does after an edit."""
    folder.mkdir(parents=True)
    file = folder / "mine.py"
    file.write_text(MINE.format(**(PLAIN | changes)), encoding="utf-8")
    spec = importlib.util.spec_from_file_location("mine", file)
    module = importlib.util.module_from_spec(spec)
    sys.modules["mine"] = module
    spec.loader.exec_module(module)
    return module.ConstantGap


def described(closure):
    return json.dumps(Laws(closure=closure).parameters(), sort_keys=True, allow_nan=False)


@pytest.mark.parametrize("change", [{"constant": 1.5}, {"inside": "3e-6 * GAP"}, {"base": 1.5}, {"text": "edited"}])
def test_edited_closure_is_another(tmp_path, change):
    """In the class, in its base, in a function that it calls or a constant: each is told from the file before."""
    edits = (("old", {}), ("same", {}), ("new", change))
    old, same, new = (described(imported(tmp_path / name, **more)()) for name, more in edits)
    assert old == same != new


def test_file_edited_after_its_import_does_not_change_a_law(tmp_path):
    """The law is the code that runs, and not the code that the file has now."""
    law = imported(tmp_path / "old")()
    before = described(law)
    old = imported(tmp_path / "late")
    now = imported(tmp_path / "new", inside="3e-6 * GAP")
    assert described(law) == before
    assert described(old()) != described(now())


def test_words_of_a_law_have_no_hash(tmp_path):
    scene = Scene().with_laws(closure=imported(tmp_path / "one")())
    assert used(scene)["closure"] == "ConstantGap()"
    assert used(Scene().with_laws(closure=Given(f=digest)))["closure"].startswith("Given(f=")
    assert digest(Given) not in " ".join(used(Scene().with_laws(closure=Given(f=Given))).values())


def test_law_without_a_source_counts_in_its_process_alone():
    """Code of a session: the same key twice in one process, another one in the next."""
    code = (
        "from fingerpad.scene.laws import Laws\n"
        "from variational.roughness.closure import AirGap, Closure\n"
        "class Mine(Closure):\n"
        "    def __call__(self, p_c): return AirGap(2e-6 + 0 * p_c)\n"
        "one, two = Laws(closure=Mine()).parameters(), Laws(closure=Mine()).parameters()\n"
        "assert one == two\n"
        "print(one)\n"
    )
    found = {subprocess.run([sys.executable, "-c", code], capture_output=True, text=True).stdout for _ in range(2)}
    assert len(found) == 2
    assert all("source code" in text for text in found)


def test_laws_of_the_program_have_no_source():
    """So that what is kept of them stays when they are moved or their comments change."""
    assert digest(BearingArea) == ""
    assert "source code" not in Laws(closure=BearingArea(0.5e-6)).parameters()["closure"]


def test_functions_that_a_law_holds_are_told_apart():
    one, other = (lambda p: 2 * p), (lambda p: 3 * p)
    bound = [Given(mine=Given(gain=gain).scaled) for gain in (1.0, 2.0)]
    partials = [Given(mine=partial(max, value)) for value in (1.0, 2.0)]
    slotted = [Given(mine=value) for value in (1j, 2j)]
    found = [described(law) for law in (Given(mine=one), Given(mine=other), *bound, *partials, *slotted)]
    assert len(set(found)) == len(found)


def test_law_that_holds_itself_is_described():
    law = Given()
    law.mine = law
    assert "itself" in described(law)


def test_numbers_that_are_not_finite_are_text():
    """JSON has none; what is written stays readable by any program."""
    found = json.loads(described(Given(most=np.inf, least=-np.inf, none=np.array([np.nan, 1.0]))))
    assert {k: found["closure"][k] for k in ("most", "least", "none")} == {
        "most": "inf", "least": "-inf", "none": ["nan", 1.0],
    }  # fmt: skip


def test_scenes_whose_laws_hold_arrays_are_compared():
    scenes = [Scene().with_laws(closure=Given(gaps=np.array([1e-6, last]))) for last in (2e-6, 2e-6, 3e-6)]
    assert scenes[0] == scenes[1] != scenes[2]
