"""The program ``fingerpad``, also as ``python3 -m fingerpad``."""

import sys

from fingerpad.ctrl_c import ends_at_once


def main() -> int:
    """Run the command in the process's arguments; return the exit code."""
    ends_at_once()
    from fingerpad.cli import main as command

    return command()


if __name__ == "__main__":
    sys.exit(main())
