"""Libraries that may not be installed: what needs one of them says so in one sentence."""

from collections.abc import Iterator
from contextlib import contextmanager

OPTIONAL = ("dolfinx", "ufl", "basix", "ffcx", "petsc4py", "mpi4py", "gmsh", "matplotlib")


@contextmanager
def needed_by(what: str) -> Iterator[None]:
    """Name the library that is missing, and how to install it.

    Raises:
        ImportError: a library of :data:`OPTIONAL` is not installed.
    """
    try:
        yield
    except ModuleNotFoundError as error:
        missing = (error.name or "").partition(".")[0]
        if missing not in OPTIONAL:
            raise
        raise ImportError(
            f"{what} needs {missing}, which is not installed; finite elements come by conda env create -f "
            "environment.yml, by pip install 'fingerpad[fem]', or with environment/run",
            name=missing,
        ) from error
