"""No file beside a scene runs code: laws are of installed packages or of a folder that the user names."""

import sys

import pytest

from fingerpad.cli import main
from fingerpad.scene import Scene, SceneError, law_code
from fingerpad.scene.law_code import LAWS, imported
from tests.commands import ROOT, python

MINE = """
from dataclasses import dataclass
import fingerpad as fp

@dataclass(frozen=True)
class Mine(fp.Friction):
    def limit(self, p):
        return 0.2 * p
"""
EVIL = "raise SystemError('evil has run')"
BELOW = "lies in the folder of a scene"


@pytest.fixture
def user(tmp_path, monkeypatch):
    """A folder that the user's PYTHONPATH names, which is on Python's path and holds the folder of a scene."""
    monkeypatch.setenv("PYTHONPATH", str(tmp_path))
    monkeypatch.setenv(LAWS, "")
    monkeypatch.setattr(law_code, "_SCENES", set())
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.chdir(ROOT)
    before = {*sys.modules}
    (tmp_path / "got").mkdir()
    yield tmp_path
    for name in {*sys.modules} - before:
        sys.modules.pop(name)


def scene(folder, law: str):
    """Write a scene whose friction is a law."""
    file = folder / "scene.toml"
    file.write_text(f"friction = {{law = '{law}'}}", encoding="utf-8")
    return file


def refusal(law: str) -> str:
    with pytest.raises(ValueError) as error:
        imported(*law.split(":"))
    return str(error.value)


# -- paths -----------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(
    ("file", "law", "sentence"),
    [
        ("results/foreign/evil.py", "results.foreign.evil:X", "results is a folder without __init__.py"),
        ("pack/__main__.py", "pack.__main__:X", "__main__ is a name of programs and tests"),
        ("pack/tests/evil.py", "pack.tests.evil:X", "tests is a name of programs and tests"),
        ("setup.py", "setup:X", "setup is a name of programs and tests"),
        ("pack/inner/evil.py", "pack.inner.evil:X", "pack.inner is a folder without __init__.py"),
    ],
)
def test_code_that_is_no_law_is_not_run(user, file, law, sentence):
    """Nor is the package around it, whose own code would run first."""
    (user / file).parent.mkdir(parents=True, exist_ok=True)
    (user / file).write_text(EVIL)
    if file.startswith("pack"):
        (user / "pack" / "__init__.py").write_text(EVIL)
    assert sentence in (text := refusal(law)) and "--laws FOLDER" in text


@pytest.mark.parametrize("path", ["benchmarks.demos:X", "demos.first_run:X", "tests.fuzz:X", "results.x:X"])
def test_clone_holds_no_laws(path):
    """In the checkout's folder, as environment/run starts Python there: with the checkout on its path."""
    done = python("-c", f"import fingerpad as fp; fp.Scene(friction={{'law': {path!r}}})", cwd=ROOT)
    assert "fingerpad.scene.messages.SceneError: friction.law is" in done.stderr and "--laws FOLDER" in done.stderr


# -- places ----------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("way", ["file", "link to the scene", "link to the law", "results", "around"])
def test_law_below_the_folder_of_a_scene_is_not_run(user, way):
    """Where PYTHONPATH names that folder or one above, as a shell may always do; links lead nowhere else."""
    got = user / "got"
    (got / "evil.py").write_text(EVIL)
    (got / "__init__.py").write_text(EVIL)
    file, law = scene(got, "got.evil:X"), "got.evil:X"
    if way == "link to the scene":
        (user / "other").mkdir()
        (user / "other" / "scene.toml").symlink_to(file)
        file = user / "other" / "scene.toml"
    elif way == "link to the law":
        (user / "fair.py").symlink_to(got / "evil.py")
        file, law = scene(got, "fair:X"), "fair:X"
    elif way == "results":
        file = got / "none.json"
    elif way == "around":
        (got / "scenes").mkdir()
        file = scene(got / "scenes", "got.evil:X")
    with pytest.raises(SceneError):
        Scene.load(file)
    assert BELOW in (text := refusal(law)) and "name the folder of the module by --laws FOLDER" in text


def test_folder_of_the_shell_or_script_is_not_named(user, monkeypatch):
    """Python puts it on its path by itself."""
    (user / "evil.py").write_text(EVIL)
    monkeypatch.setenv("PYTHONPATH", "")
    monkeypatch.chdir(user)
    assert "Python finds no module evil in installed" in refusal("evil:X")
    monkeypatch.chdir(ROOT)
    monkeypatch.setattr(sys.modules["__main__"], "__file__", str(user / "script.py"), raising=False)
    assert "Python finds no module evil in installed" in refusal("evil:X")


# -- what the user names ---------------------------------------------------------------------------------------
def test_option_names_a_folder_even_of_the_scene(user, capsys, monkeypatch):
    """It is of this call alone; PYTHONPATH may be of all."""
    got = user / "got"
    (got / "mylaws.py").write_text(MINE)
    words = ["estimate", str(scene(got, "mylaws:Mine"))]
    assert main(words) == 2 and "--laws FOLDER" in capsys.readouterr().err
    monkeypatch.setenv("PYTHONPATH", str(got))
    monkeypatch.syspath_prepend(got)
    assert main(words) == 2 and BELOW in capsys.readouterr().err
    assert main([*words, "--laws", str(got)]) == 0


def test_imported_module_and_installed_package_are_taken(user, monkeypatch):
    """The first was chosen by the program, the second lies in a folder of Python's, also one below the scene's."""
    place = user / "got" / "venv" / "site-packages" / "mypack"
    place.mkdir(parents=True)
    for file in (user / "got" / "chosen.py", place / "__init__.py"):
        file.write_text(MINE)
    monkeypatch.setattr("site.getsitepackages", lambda: [str(place.parent)])
    monkeypatch.syspath_prepend(place.parent)
    law_code.foreign(user / "got")
    assert imported("mypack", "Mine").__module__ == "mypack"
    monkeypatch.syspath_prepend(user / "got")
    import chosen

    assert imported("chosen", "Mine") is chosen.Mine


def test_empty_entries_of_the_path_are_dropped(tmp_path):
    """Python takes them for the current folder; environment/run starts Python, and a sweep its processes."""
    (tmp_path / "numpy.py").write_text(EVIL)
    words = ["-m", "fingerpad", "params", "force"]
    script = f"{ROOT / 'environment' / 'run'} {sys.executable}"
    code = "import os, subprocess, sys; sys.exit(subprocess.run(sys.argv[1].split() + sys.argv[2:]).returncode)"
    for path in ("/opt/x:", ":/opt/x", "/opt/x::/opt/y"):
        done = python("-c", code, script, *words, cwd=tmp_path, PYTHONPATH=path, PYTHONSAFEPATH="1")
        assert done.returncode == 0, done.stderr
