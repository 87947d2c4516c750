"""Files that are there as a whole or not at all."""

import json
from pathlib import Path
from typing import Any


def replace(file: Path, text: str) -> None:
    """Write a text file; what was there stays until all of it is written."""
    part = file.with_name(f"{file.name}.part")
    part.write_text(text, encoding="utf-8")
    part.replace(file)


def replace_json(file: Path, data: Any) -> None:
    """Write data as JSON, as :func:`replace` does."""
    replace(file, json.dumps(data, indent=1, ensure_ascii=False) + "\n")
