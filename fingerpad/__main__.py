"""``python3 -m fingerpad``: the command ``fingerpad``."""

import sys

from fingerpad.cli import main

if __name__ == "__main__":
    sys.exit(main())
