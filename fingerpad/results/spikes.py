"""Spikes of afferents over a run: as numbers by unit, text, tables and a picture."""

import csv
import io
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fingerpad import notebook
from fingerpad.results import files

if TYPE_CHECKING:
    import xarray
    from matplotlib.figure import Figure

Array = NDArray[np.float64]
_CAUTION = (
    "Thresholds are relative: the laws are of other skins, and their gains those of a flat pin. Compare runs and "
    "ridges; rates of a person do not follow from them."
)
COLUMNS = ("unit", "class", "ridge", "t")
"""Of the table of spikes; t in s."""
_POPULATION = -9999  # in place of the number of a ridge


class Unit(NamedTuple):
    """A unit of a class."""

    number: int
    law: str
    ridge: int | None
    """None for a population."""
    side: str
    """``left``, ``right`` or empty."""

    @property
    def place(self) -> float:
        """Where it is drawn, in ridges."""
        return (self.ridge or 0) + {"": 0.0, "left": -0.25, "right": 0.25}[self.side]


class Span(NamedTuple):
    """A load and its times (s)."""

    name: str
    begin: float
    end: float


class Densities(NamedTuple):
    """Strain energy densities at Merkel sites over a run."""

    ridges: tuple[int, ...]
    """Their numbers."""
    time: Array
    """Of the states (s), shape (states,)."""
    values: Array
    """J/m^3 of reference volume, shape (ridges, states)."""


@dataclass(frozen=True, eq=False, repr=False)
class Spikes:
    """Spikes of all units over a run, from time 0 to its end."""

    units: tuple[Unit, ...]
    trains: tuple[Array, ...]
    """Times (s) of the spikes of each unit."""
    seconds: float
    """Length of the run (s)."""
    loads: tuple[Span, ...]
    notes: tuple[str, ...] = ()
    """Of which mesh they are, and which classes are left out."""
    densities: Densities | None = None
    """Drawn above the spikes."""

    def of(self, law: str) -> list[Array]:
        """Return the trains of a class, in the order of its units."""
        return [train for unit, train in zip(self.units, self.trains, strict=True) if unit.law == law]

    def count(self, law: str, load: str | None = None) -> int:
        """Return the number of spikes of a class, in all or in the loads of a name."""
        spans = [span for span in self.loads if load in (None, span.name)]
        return sum(self.between(law, span.begin, span.end) for span in spans)

    def between(self, law: str, begin: float, end: float) -> int:
        """Return the number of spikes of a class after one time (s) and up to another."""
        return sum(int(((train > begin) & (train <= end)).sum()) for train in self.of(law))

    @property
    def laws(self) -> list[str]:
        """The classes, in order."""
        return list(dict.fromkeys(unit.law for unit in self.units))

    @property
    def rate(self) -> Array:
        """Spikes of each unit over the length of the run (1/s), shape (units,)."""
        return np.array([len(train) for train in self.trains]) / self.seconds

    @property
    def first(self) -> Array:
        """Time of the first spike of each unit (s), shape (units,); NaN without one."""
        return np.array([train[0] if len(train) else np.nan for train in self.trains])

    def to_csv(self, path: str | Path) -> None:
        """Write a table of all spikes with :data:`COLUMNS`, unit by unit; the ridge of a population is empty."""
        text = io.StringIO()
        writer = csv.writer(text, lineterminator="\n")
        writer.writerow(COLUMNS)
        for unit, train in zip(self.units, self.trains, strict=True):
            ridge = "" if unit.ridge is None else unit.ridge
            writer.writerows((unit.number, unit.law, ridge, f"{t:.7g}") for t in train)
        files.replace(Path(path), text.getvalue())

    def to_xarray(self) -> "xarray.Dataset":
        """Return classes, ridges, spikes, rates and first spikes along the units, as a dataset with units."""
        import xarray

        longest = max([1, *map(len, self.trains)])
        spikes = [np.pad(train, (0, longest - len(train)), constant_values=np.nan) for train in self.trains]
        ridges = [_POPULATION if unit.ridge is None else unit.ridge for unit in self.units]
        words = {
            "class": ([unit.law for unit in self.units], object, "1", "law of the unit"),
            "ridge": (ridges, np.int32, "1", f"number of the ridge, 0 central; {_POPULATION} of a population"),
            "side": ([unit.side for unit in self.units], object, "1", "side of the ridge where its units have one"),
            "spikes": (spikes, float, "s", "times of the spikes; NaN beyond the last"),
            "rate": (self.rate, float, "1/s", "number of spikes over the length of the run"),
            "first": (self.first, float, "s", "time of the first spike; NaN without one"),
        }
        about = {"title": "fingerpad: spikes of afferents", "seconds": self.seconds, "notes": "\n".join(self.remarks)}
        variables = {}
        for name, (values, kind, unit, meaning) in words.items():
            array = np.array(values, kind)
            variables[name] = ("unit", "spike")[: array.ndim], array, {"units": unit, "long_name": meaning}
        return xarray.Dataset(variables, attrs=about)

    def to_netcdf(self, path: str | Path) -> None:
        """Write the dataset as NetCDF 3."""
        files.replace(Path(path), bytes(self.to_xarray().to_netcdf(engine="scipy", format="NETCDF3_64BIT")))

    def plot(self, path: str | Path | None = None) -> "Figure":
        """Draw energy densities at Merkel sites over time, and each spike unit by unit below; write a PNG if asked."""
        from fingerpad.results.pictures.curves import raster  # Matplotlib

        return raster(self, path)

    @property
    def remarks(self) -> tuple[str, ...]:
        """The caution, and the notes."""
        return _CAUTION, *self.notes

    def table(self) -> list[list[str]]:
        """Return a head and a row for each class: units, those that fired, spikes, rates, first spike, and by load."""
        spans = list(dict.fromkeys(span.name for span in self.loads))
        rows = [["class", "units", "fired", "spikes", "highest rate (1/s)", "first (ms)", *spans]]
        for law in self.laws:
            trains = self.of(law)
            fired = [train for train in trains if len(train)]
            intervals = [np.diff(train).min() for train in fired if len(train) > 1]
            most = f"{1 / min(intervals):.1f}" if intervals else "–"
            first = f"{1e3 * min(train[0] for train in fired):.1f}" if fired else "–"
            each = [str(self.count(law, span)) for span in spans]
            rows.append([law, str(len(trains)), str(len(fired)), str(sum(map(len, trains))), most, first, *each])
        return rows

    def __str__(self) -> str:
        """Return a table of the classes, with the number of spikes in each load, and remarks."""
        head = f"Spikes in {self.seconds:.4g} s; the last columns have their number in each load"
        return "\n".join([head, *notebook.side_by_side(self.table()), *(f"  {remark}" for remark in self.remarks)])

    __repr__ = __str__
