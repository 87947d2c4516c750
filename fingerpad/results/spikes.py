"""Spikes of mechanoreceptive afferents over a run, from its stimuli at receptor sites: numbers, tables and a picture.

Stimuli are known in the accepted states. Between two of a load they follow the monotone cubic curve of Fritsch and
Carlson, cut at the ends of loads; a jump of the voltage takes half a sample. The state at t = 0 is taken as a steady
state. A class is refused where two states are further apart than its ``longest_step`` and its stimulus changes between
them by more than a hundredth of its range.
"""

import csv
import io
import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from itertools import groupby
from pathlib import Path
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from numpy.typing import NDArray

from fingerpad import notebook
from fingerpad.afferents import DEFAULT, Afferent, History, find
from fingerpad.results import files
from fingerpad.results.data import ResultData
from fingerpad.results.over_time import without_parts_of_jumps
from fingerpad.results.terminal import about
from fingerpad.scene.messages import SceneError, show
from variational.state import ContactState

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
_CHANGE = 0.01  # of the range of a stimulus, which may change between two states however far they are apart
_SITE_ERROR = 0.22
"""Largest known error of energy densities at three Merkel sites on the default path's mesh; docs/errors.json."""
_OVER_TIME = {
    "f_t": "friction",
    "merkel_stress": "stress at Merkel sites",
    "meissner_stress": "at Meissner sites",
    "pacinian_stress": "at Pacinian sites",
    "surface_strain": "strain of the surface",
}
_SAMPLE = 1e-4  # s, between two samples of a stimulus
_TIME_TOLERANCE = 1e-9  # of the length of a run: two times that are one


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
        attributes = {
            "title": "fingerpad: spikes of afferents",
            "seconds": self.seconds,
            "notes": "\n".join(self.remarks),
        }
        variables = {}
        for name, (values, kind, unit, meaning) in words.items():
            array: np.ndarray = np.array(values, kind)
            variables[name] = ("unit", "spike")[: array.ndim], array, {"units": unit, "long_name": meaning}
        return xarray.Dataset(variables, attrs=attributes)

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


# -- from a run ------------------------------------------------------------------------------------------
def afferents(result: ResultData, laws: str | Afferent | Iterable[str | Afferent] | None = None) -> Spikes:
    """Return the spikes of afferents over a run; see :meth:`fingerpad.results.result.Result.afferents`."""
    named = [laws] if isinstance(laws, str | Afferent) else list(DEFAULT if laws is None else laws)
    try:
        chosen = [find(law) for law in named]
    except ValueError as error:
        raise SceneError(str(error)) from None
    if not chosen:
        raise SceneError("no class of afferents is given; give one at least, such as 'SA1'")
    states = _states(result)
    ridges, at_states = _histories(states)
    time, loads = np.array([state.time for state in states]), [state.load for state in states]
    scale, notes = result.scene.numerics.step_scale, [_mesh(result, states)]
    fine: Array = np.arange(int(time[-1] / _SAMPLE * (1 + 1e-9)) + 1, dtype=np.float64) * _SAMPLE
    units, trains, refusals = list[Unit](), list[Array](), list[str]()
    for given, law in zip(named, chosen, strict=True):
        name = given if isinstance(given, str) else given.name
        if law.site not in at_states:
            raise SceneError(f"the site of {name} is {show(law.site)}; it must be {' or '.join(map(repr, at_states))}")
        stimulus = law.stimulus(at_states[law.site])
        if coarse := _too_coarse(law, stimulus, time, loads, scale):
            refusals.append(coarse)
            if laws is not None:
                raise SceneError(coarse)
            continue
        trains += law.spikes(_between(time, loads, stimulus, fine), _SAMPLE)
        units += _units(name, law, at_states[law.site], ridges, len(units))
    if not units:
        raise SceneError(refusals[0])
    notes += [f"Left out: {coarse}." for coarse in refusals]
    parts = [list(group) for _, group in groupby(range(1, len(time)), key=lambda k: loads[k])]
    spans = tuple(Span(loads[part[0]], float(time[part[0] - 1]), float(time[part[-1]])) for part in parts)
    densities = Densities(tuple(map(int, ridges)), time, at_states["merkel"].sed)
    return Spikes(tuple(units), tuple(trains), float(time[-1]), spans, tuple(notes), densities)


def _states(result: ResultData) -> list[ContactState]:
    """Return the states of a run from time 0 on, of which two at a jump have two times.

    Raises:
        SceneError: there is no time, or there are no sites.
    """
    states = list(result.steps)
    if not states or math.isnan(states[-1].time) or not states[-1].time > 0:
        raise SceneError(
            "the run has no load over time, so nothing is felt over time; give its loads a duration or a speed"
        )
    if states[-1].stimuli is None or states[-1].sites is None:
        why = "its mesh is one of your own" if result.scene.output.receptors else "output.receptors is false"
        raise SceneError(f"the run has no stimuli at receptor sites: {why}; run a finger of the package with receptors")
    begin = max(k for k, state in enumerate(states) if state.time == 0.0)
    return without_parts_of_jumps(states[begin:])


def _histories(states: Sequence[ContactState]) -> tuple[NDArray[np.int64], dict[str, History]]:
    """Return the numbers of the ridges that can touch, and the stimuli below them in each state by kind of site.

    Those to the left and to the right of a ridge are in turn.
    """
    first = states[0].stimuli
    assert first is not None
    there = np.isfinite(first.surface_strain_left)

    def rows(*names: str, of: str = "stimuli") -> Array:
        columns = [np.array([getattr(getattr(state, of), name) for state in states]).T[there] for name in names]
        return np.stack(columns, axis=1).reshape(-1, len(states))

    strain = rows("surface_strain_left", "surface_strain_right")
    stress, sed = rows("meissner_stress_left", "meissner_stress_right"), rows("left", "right", of="sites")
    nothing = np.full((int(there.sum()), len(states)), np.nan)
    return first.number[there], {
        "merkel": History(rows("merkel_stress"), rows("merkel", of="sites"), (strain[::2] + strain[1::2]) / 2),
        "meissner": History(stress, sed, strain),
        "pacinian": History(rows("pacinian_stress"), nothing, nothing),
    }


def _too_coarse(law: Afferent, stimulus: Array, time: Array, loads: Sequence[str], scale: float) -> str:
    """Return in a sentence that two states are too far apart for a class; empty where none are."""
    apart = np.diff(time)
    changes = np.abs(np.diff(stimulus, axis=1)).max(axis=0) > _CHANGE * np.ptp(stimulus, axis=1).max()
    wide = np.where(changes & (apart > law.longest_step * (1 + 1e-9)), apart, 0.0)
    if not wide.any():
        return ""
    k = int(wide.argmax())
    enough = float(f"{0.9 * scale * law.longest_step / wide[k]:.1g}")
    return (
        f"{law.name} needs a state every {1e3 * law.longest_step:.2g} ms and the load {show(loads[k + 1])} has two "
        f"{1e3 * wide[k]:.3g} ms apart; give numerics.step_scale = {enough:g}, or a load that takes less time"
    )


def _between(time: Array, loads: Sequence[str], values: Array, fine: Array) -> Array:
    """Return values at states, shape (units, states), at fine times, shape (units, times)."""
    from scipy.interpolate import PchipInterpolator

    moved, near = time.copy(), _TIME_TOLERANCE * time[-1]
    jumps = np.flatnonzero(np.diff(moved) <= near) + 1
    after = np.append(np.diff(moved), _SAMPLE)[jumps]  # to the next state
    moved[jumps] += np.minimum(_SAMPLE, after) / 2
    found = np.repeat(values[:, -1:], len(fine), axis=1)
    for _, group in groupby(range(1, len(time)), key=lambda k: loads[k]):
        part = list(group)
        places = [part[0] - 1, *part]
        cuts = [0, *[n for n, k in enumerate(places) if k in jumps and n > 0], len(places) - 1]
        for a, b in zip(cuts[:-1], cuts[1:], strict=True):
            mine = places[a : b + 1]
            inside = (fine >= moved[mine[0]]) & (fine <= moved[mine[-1]])
            if b > a and inside.any():
                found[:, inside] = PchipInterpolator(moved[mine], values[:, mine], axis=1)(fine[inside])
    return found


def _units(name: str, law: Afferent, history: History, ridges: NDArray[np.int64], first: int) -> list[Unit]:
    """Return the units of a law in the order of its stimulus."""
    if law.population:
        return [Unit(first, name, None, "")]
    count = len(history.stress)
    if count == len(ridges):
        return [Unit(first + k, name, int(number), "") for k, number in enumerate(ridges)]
    return [Unit(first + k, name, int(ridges[k // 2]), ("left", "right")[k % 2]) for k in range(count)]


def _mesh(result: ResultData, states: Sequence[ContactState]) -> str:
    """Return of which mesh the stimuli are, and what is known of its error."""
    sizes = result.record.get("path_mesh") or {}
    contact = f"{1e6 * states[-1].mesh_contact:.3g} µm in contact"
    sites = f" and {1e6 * sizes['receptor']:.3g} µm at the Merkel sites" if "receptor" in sizes else ""
    begins = f"Stimuli and spikes are of the mesh of the path, with elements of {contact}{sites}."
    over_time = (result.record.get("accuracy") or {}).get("over_time", {})
    known = {words: over_time[key]["error"] for key, words in _OVER_TIME.items() if key in over_time}
    errors = [f"{words} {about(100 * error)} %" for words, error in known.items()]
    if errors:
        return (
            f"{begins} Estimated discretisation errors over time, from the path on elements twice as large, are at "
            f"most, of the largest value: {', '.join(errors)}. Those of spikes are not estimated."
        )
    return (
        f"{begins} Their discretisation error is not estimated. On the path of the default scene, with 20 µm in both, "
        f"energy densities at three Merkel sites are known to be off by up to {_SITE_ERROR:.0%}, and stresses, whose "
        "square they go with, by about half of that (docs/errors.json)."
    )
