"""The program ``fingerpad``, also as ``python3 -m fingerpad``."""

import os
import sys

from fingerpad.launcher import end_at_ctrl_c


def main() -> int:
    """Run the command in the process's arguments; return the exit code."""
    end_at_ctrl_c()
    os.environ["MPLBACKEND"] = "agg"  # of all pictures, whatever a user or a notebook has
    _open_streams()
    from fingerpad.cli import main as command

    return command()


def _open_streams() -> None:
    """Open the standard streams that the caller has closed, to nowhere; files of results would take their numbers."""
    while (number := os.open(os.devnull, os.O_RDWR)) <= 2:
        pass
    os.close(number)
    sys.stdout = sys.stdout or os.fdopen(1, "w")
    sys.stderr = sys.stderr or os.fdopen(2, "w")


if __name__ == "__main__":
    sys.exit(main())
