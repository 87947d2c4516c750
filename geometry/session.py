"""gmsh's one session a process: our own, or a place in that of a caller, who may be making a mesh."""

import tempfile
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

import gmsh


@contextmanager
def session(name: str) -> Iterator[None]:
    """Work in an empty model with gmsh's default options; a caller's models and options are there again afterwards.

    No configuration of gmsh is read: the options that its window saves in the user's home would change the mesh.

    Args:
        name: name of the model.
    """
    if gmsh.isInitialized():
        with tempfile.TemporaryDirectory(prefix="fingerpad-") as folder:
            options, current = str(Path(folder) / "options.opt"), gmsh.model.getCurrent()
            gmsh.write(options)
            gmsh.option.restoreDefaults()
            try:
                _begin(name)
                yield
            finally:
                gmsh.merge(options)  # which would name a model of the caller that has no name
                gmsh.model.remove()
                gmsh.model.setCurrent(current)
    else:
        gmsh.initialize(readConfigFiles=False, interruptible=False)
        try:
            _begin(name)
            yield
        finally:
            gmsh.finalize()


def _begin(name: str) -> None:
    gmsh.option.setNumber("General.Terminal", 0)
    gmsh.model.add(name)
