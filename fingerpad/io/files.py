"""Files that are there as a whole or not at all, and tables of whole rows."""

import contextlib
import csv
import io
import json
import math
from collections.abc import Mapping
from pathlib import Path
from typing import Any
from uuid import uuid4


def replace(file: Path, text: str | bytes) -> None:
    """Write a file of text or bytes; what was there stays until all of it is written.

    Raises:
        OSError: it could not be written; with its name.
    """
    part = file.with_name(f"{file.name}.{uuid4().hex[:8]}.part")  # another process may write the same file
    try:
        part.write_bytes(text.encode("utf-8") if isinstance(text, str) else text)
        part.replace(file)
    except OSError as error:
        with contextlib.suppress(OSError):  # where the folder takes no file
            part.unlink()
        raise OSError(error.errno, error.strerror, str(file)) from error  # the system names no file of a full disk


def replace_json(file: Path, data: Any) -> None:
    """Write data as JSON, as :func:`replace` does; numbers that are not finite, which JSON does not have, are null."""
    replace(file, json.dumps(_finite(data), indent=1, ensure_ascii=False, allow_nan=False) + "\n")


def _finite(data: Any) -> Any:
    if isinstance(data, Mapping):
        return {key: _finite(value) for key, value in data.items()}
    if isinstance(data, list | tuple):
        return [_finite(value) for value in data]
    return None if isinstance(data, float) and not math.isfinite(data) else data


class Table:
    """Writes a CSV file row by row: each is on disk, whole, when :meth:`write` returns."""

    def __init__(self, file: Path, columns: Mapping[str, Any]) -> None:
        """Start the file with its header; an earlier one goes."""
        self._file = file.open("wb", buffering=0)
        self._columns = list(columns)
        self.write(dict(zip(self._columns, self._columns, strict=True)))

    def write(self, row: Mapping[str, Any]) -> None:
        """Append a row; where there is no room for all of it, none of it stays."""
        text = io.StringIO()
        csv.DictWriter(text, self._columns).writerow(row)
        data, start = text.getvalue().encode(), self._file.tell()
        try:
            while data:
                data = data[self._file.write(data) :]
        except OSError:
            self._file.truncate(start)
            raise

    def close(self) -> None:
        """Close the file."""
        self._file.close()
