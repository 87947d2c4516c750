"""environment/run and root.sh, with stand-ins for bubblewrap and mmdebstrap: neither works inside the root itself."""

import os
import pty
import select
import shutil
import subprocess
import sys
import time
from pathlib import Path

import pytest

from tests.test_packages import script

pytestmark = pytest.mark.slow
HERE = Path(__file__).resolve().parents[1] / "environment"
# Tells its arguments, then runs the command in a process of its own and names it, as bubblewrap does.
BWRAP = """#!/bin/bash
printf '%s\\n' "$@" >"$TOLD"
while [ "$1" != env ] && [ "$1" != test ]; do
    [ "$1" = --info-fd ] && info=$2
    [ "$1" = --new-session ] && session=setsid
    shift
done
[ -n "$REFUSAL" ] && { echo "bwrap: $REFUSAL" >&2; exit 1; }
[ "$1" = test ] && exec "$@"
$session "$@" <&0 &
printf '{\\n    "child-pid": %s\\n}\\n' $! >&"$info"
wait $!
"""
# Writes the signals it gets, ignores those it was started with, and ends after some time, or after the first signal.
COMMAND = """#!{python}
import signal, sys, time
got = []
for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP, signal.SIGUSR1, signal.SIGUSR2):
    if signal.getsignal(number) is not signal.SIG_IGN:
        signal.signal(number, lambda number, frame: got.append(signal.Signals(number).name))
print("ready", flush=True)
for _ in range({wait}):
    time.sleep(0.1)
    if got and {wait} > 10:
        break
time.sleep(0.5)  # for a second one
print("got", *got, flush=True)
sys.exit(42)
"""


@pytest.fixture
def checkout(tmp_path) -> Path:
    """A checkout whose root is a folder with nothing in it, and stand-ins in ``bin``."""
    folder = tmp_path / "checkout" / "environment"
    folder.mkdir(parents=True)
    for name in ("run", "packages.txt"):
        shutil.copy(HERE / name, folder)
    script(folder / "root.sh", f"#!/bin/sh\nmkdir -p {tmp_path}/cache/root\necho {tmp_path}/cache/root\n")
    script(tmp_path / "bin" / "bwrap", BWRAP)
    for name in ("command", "mpirun"):
        script(tmp_path / "bin" / name, COMMAND.format(python=sys.executable, wait=100))
    script(tmp_path / "bin" / "brief", COMMAND.format(python=sys.executable, wait=10))
    return folder.parent


def environment(checkout: Path, **variables: str) -> dict[str, str]:
    """Return variables under which a root is entered although there is a dolfinx."""
    path = f"{checkout.parent / 'bin'}:{os.environ['PATH']}"
    return {**os.environ, "SUITE": "trixie", "PATH": path, "TOLD": str(checkout.parent / "told"), **variables}


def enter(checkout: Path, *command: str, cwd: Path | None = None, **variables: str) -> subprocess.CompletedProcess[str]:
    line, where = [str(checkout / "environment" / "run"), *command], cwd or checkout
    variables = environment(checkout, PWD=str(where), **variables)
    return subprocess.run(line, cwd=where, env=variables, capture_output=True, text=True)


# -- where things are --------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("refusal", "words"),
    [
        ("Can't chdir to /usr/x: No such file or directory", "the current folder is"),
        ("Creating new namespace failed: Operation not permitted", "the kernel refuses user namespaces"),
        ("setting up uid map: Permission denied", "kernel.apparmor_restrict_unprivileged_userns"),
        ("Can't mount proc on /newroot/proc: Device busy", "cannot be entered (bwrap: Can't mount proc"),
    ],
)
def test_what_bubblewrap_refuses(checkout, refusal, words):
    done = enter(checkout, "true", REFUSAL=refusal)
    assert done.returncode == 1
    assert done.stderr.startswith("fingerpad: ") and words in done.stderr
    assert done.stderr.count("\n") == 1


# -- signals -----------------------------------------------------------------------------------------------


@pytest.mark.parametrize(("command", "gets"), [("command", "SIGINT"), ("mpirun", "SIGUSR1")])
def test_control_c_on_a_terminal(checkout, command, gets):
    """The command gets it once, although all processes of the terminal do, and gives its own exit code."""
    pid, terminal = pty.fork()
    if pid == 0:
        line = ["env", "--default-signal", str(checkout / "environment" / "run"), command]
        os.execvpe(line[0], line, environment(checkout))
    said, until, typed = b"", time.monotonic() + 60, False
    while time.monotonic() < until and b"\n" not in said.partition(b"got ")[2]:
        if select.select([terminal], [], [], 0.1)[0]:
            said += os.read(terminal, 1000)
        if b"ready" in said and not typed:
            typed = True
            os.write(terminal, b"\x03")
    _, status = os.waitpid(pid, 0)
    os.close(terminal)
    assert said.split(b"got ")[1].split() == [gets.encode()]
    assert os.waitstatus_to_exitcode(status) == 42


# -- the root ----------------------------------------------------------------------------------------------
@pytest.fixture
def maker(tmp_path) -> dict[str, str]:
    """Variables under which root.sh makes a root of one file with stand-ins, as the administrator."""
    script(tmp_path / "bin" / "dpkg-query", "#!/bin/sh\necho install ok installed\n")
    script(tmp_path / "bin" / "bwrap", '#!/bin/sh\n[ -z "$REFUSAL" ] || { echo "bwrap: $REFUSAL" >&2; exit 1; }\n')
    script(tmp_path / "bin" / "mmdebstrap", f"#!/bin/sh\ncat {tmp_path}/says >&2\ncat {tmp_path}/root.tar\n")
    lines = ["I: running apt-get update...", "Get:1 list", "0 upgraded, 8 newly installed, 0 to remove"]
    lines += [f"Get:{k} package" for k in range(8)]
    for k in range(8):
        lines += [f"Unpacking p{k} ...", f"Setting up p{k} (1) ..."]
    (tmp_path / "says").write_text("\n".join([*lines, "I: creating tarball...", ""]))
    (tmp_path / "tree" / "etc").mkdir(parents=True)
    subprocess.run(["tar", "-cf", tmp_path / "root.tar", "-C", tmp_path / "tree", "."], check=True)
    script(tmp_path / "bin" / "id", f'#!/bin/sh\n[ "$1" = -u ] && echo {os.getuid()} || echo somebody\n')
    (tmp_path / "cache").mkdir()
    return {**os.environ, "PATH": f"{tmp_path / 'bin'}:{os.environ['PATH']}", "XDG_CACHE_HOME": str(tmp_path / "cache")}


def root(variables: dict[str, str]) -> subprocess.CompletedProcess[str]:
    return subprocess.run([HERE / "root.sh"], env=variables, capture_output=True, text=True)


needs_subuid = pytest.mark.usefixtures("allowed_to_make_a_root")


@pytest.fixture
def allowed_to_make_a_root(tmp_path, maker):
    """For users without a line in /etc/subuid: the check finds one."""
    script(
        tmp_path / "bin" / "grep", '#!/bin/sh\ncase "$*" in */etc/subuid) exit 0 ;; *) exec /usr/bin/grep "$@" ;; esac'
    )


@needs_subuid
def test_no_root_is_built_that_could_not_be_entered(tmp_path, maker):
    """The refusal comes before minutes of building, with the other ways and why PyPI's is none here."""
    lacking = "no C compiler gcc is on the path"
    done = root(maker | {"REFUSAL": "Creating new namespace failed: Permission denied", "FINGERPAD_LACKING": lacking})
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (1, "", 1)
    assert "the kernel refuses user namespaces" in done.stderr
    assert f"dolfinx from PyPI (here {lacking}), conda or a container" in done.stderr
    assert not list((tmp_path / "cache" / "fingerpad").glob("build.*/"))
