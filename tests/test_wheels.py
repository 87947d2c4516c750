"""environment/wheels, with a stand-in for the private root: what is got from PyPI, once, and what is said."""

import os
import re
import shutil
import subprocess
import sysconfig
from importlib.metadata import distributions

import pytest

from tests.test_lint import ROOT, script

VERSION = re.search(r"^version=(\S+)$", (ROOT / "environment/wheels").read_text(), re.MULTILINE)[1]
PLACE = "usr/local/lib/python3.13/dist-packages"
# Names the root's folder of packages, or installs SurfaceTopography as pip does, from nowhere.
ENTER = f"""#!/bin/bash
[ "$1" != python3 ] || {{ echo "$FOLDER"; exit; }}
[ -z "$OFFLINE" ] || {{ echo "no network"; exit 1; }}
[ ! -e "$FOLDER" ] || {{ echo "what is there is not got again"; exit 1; }}
while [ "$1" != --prefix ]; do shift; done
mkdir -p "$2/local/lib/python3.13/dist-packages/surfacetopography-{VERSION}.dist-info"
"""


@pytest.fixture
def wheels(tmp_path):
    """Return a function that runs the script in a checkout whose root is a folder with nothing in it."""
    checkout, root = tmp_path / "environment", tmp_path / "cache" / "root"
    checkout.mkdir()
    (root / PLACE).mkdir(parents=True)
    for name in ("wheels", "pip"):
        shutil.copy(ROOT / "environment" / name, checkout)
    script(checkout / "run", ENTER)

    def run(**more: str) -> tuple[list[str], set[str]]:
        """Return what is said and what is in the root's folder of packages then; nothing else is left in the cache."""
        variables = os.environ | {"FOLDER": str(root / PLACE)} | more
        done = subprocess.run([checkout / "wheels"], env=variables, capture_output=True, text=True, check=False)
        assert (done.returncode, done.stdout) == (0, "")
        assert {path.name for path in (tmp_path / "cache").iterdir()} <= {"root", "wheels.lock", "wheels.log"}
        return done.stderr.splitlines(), {path.name for path in root.glob(f"{PLACE}/*")}

    return run


def test_they_are_got_once(wheels):
    here = {f"surfacetopography-{VERSION}.dist-info"}
    said, there = wheels()
    assert len(said) == 1 and said[0].startswith(f"fingerpad: getting SurfaceTopography {VERSION} from PyPI")
    assert there == here
    assert wheels() == ([], here)


def test_another_version_is_replaced(wheels, tmp_path):
    """It goes first: pip leaves out what is there, which the old one may have brought."""
    old = tmp_path / "cache" / "root" / PLACE / "surfacetopography-1.0.0.dist-info"
    old.mkdir()
    assert wheels()[1] == {f"surfacetopography-{VERSION}.dist-info"}


@pytest.mark.skipif("FINGERPAD_ROOT" not in os.environ, reason="not in the private root")
def test_they_hide_nothing_of_debian():
    """No package is there twice, so that none of Debian's has another version with them than without."""
    folders = sysconfig.get_path("purelib"), "/usr/lib/python3/dist-packages"
    ours, debian = ({re.sub(r"[-_.]+", "-", d.name).lower() for d in distributions(path=[f])} for f in folders)
    assert debian and not ours & debian
