"""The files of a run as it goes: tables and the log; every accepted step is on disk at once."""

import logging
import logging.handlers
import sys
from collections.abc import Mapping
from contextlib import suppress
from typing import TYPE_CHECKING, Any

from fingerpad.results.files import Table
from fingerpad.results.folder import Folder, Serial

if TYPE_CHECKING:
    from mpi4py import MPI

_LOG = "run.log"


class Writer:
    """Writes into a folder, or nothing where there is none.

    Attributes:
        comm: communicator of the run.
        log: takes what is to be logged; kept in memory until the folder is taken.
        folder: where files go; None where nothing is written.
        earlier_log: with which the log begins, of a run that this one goes on from.
    """

    def __init__(self, place: Folder | None, comm: "MPI.Comm | Serial") -> None:
        """Write nothing before :meth:`take`, and nothing at all without a folder, which is locked."""
        self._place, self.comm, self._taken = place, comm, False
        self.folder = None if place is None else place.folder
        self._tables: dict[str, Table] = {}
        self.earlier_log = ""
        self.log = logging.Logger("fingerpad", logging.INFO)  # of this run alone, apart from those of the caller
        self.log.handlers = [logging.handlers.MemoryHandler(1000, logging.CRITICAL, flushOnClose=False)]

    def take(self) -> None:
        """Open the log where that has not been done, the files of an earlier run gone; collective."""
        if self._place is None or self._taken:
            return
        self._taken = True
        self._place.take()
        if self.comm.rank == 0:
            file = _LogFile(self._place.folder / _LOG, mode="x", encoding="utf-8", delay=not self.earlier_log)
            if self.earlier_log:
                file.stream.write(self.earlier_log)
            _send(self.log, file)

    def log_text(self) -> str:
        """Return the log so far, on rank 0; empty where there is none."""
        if self._place is None or self.comm.rank != 0:
            return ""
        return (self._place.folder / _LOG).read_text(encoding="utf-8")

    def row(self, name: str, row: Mapping[str, Any]) -> None:
        """Append a row to a table, on rank 0."""
        if self._place is not None and self.comm.rank == 0:
            if name not in self._tables:
                self._tables[name] = Table(self._place.folder / f"{name}.csv", row)
            self._tables[name].write(row)

    def lost(self, why: str, trace: str) -> None:
        """Print and log, on rank 0, why a result has to do without something, in one sentence, with its traceback."""
        if self.comm.rank == 0:
            print(f"fingerpad: {why}", file=sys.stderr, flush=True)
            with suppress(OSError):  # a full disk; what is there stays
                self.log.warning("%s\n%s", why, trace)

    def restart(self) -> None:
        """Delete tables, to be started anew."""
        written = list(self._tables)
        self._close_tables()
        if self._place is not None:
            for name in written:
                (self._place.folder / f"{name}.csv").unlink()

    def _close_tables(self) -> None:
        for table in self._tables.values():
            table.close()
        self._tables.clear()

    def close(self) -> None:
        """Close every file."""
        self._close_tables()
        for handler in self.log.handlers:
            handler.close()


class _LogFile(logging.FileHandler):
    """A log that raises where it cannot be written, as tables do."""

    def handleError(self, record: logging.LogRecord) -> None:
        """Raise what went wrong."""
        raise  # noqa: PLE0704


def _send(log: logging.Logger, file: logging.Handler) -> None:
    """Write what was logged so far, and what is to come, into a file."""
    file.setFormatter(logging.Formatter("%(asctime)s %(levelname)s %(message)s"))
    for memory in log.handlers:
        if isinstance(memory, logging.handlers.MemoryHandler):
            memory.setTarget(file)
            memory.flush()
    log.handlers = [file]
