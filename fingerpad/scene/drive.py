r"""What a drive puts across the gap: a period of its voltage, and the voltage of Eq. 3 that attracts as much.

A drive repeats itself. Its voltages at equal times over one period go through the circuit of the gap
(:mod:`variational.attraction.circuit`), which gives the field E(t) across a gap g in the steady state, and the
attraction :math:`\sigma_{el} = \varepsilon_0 E^2 / 2` at each instant. Models take it as the voltage of Eq. 3,

.. math:: V(t, g) = |E(t)| \,(h_0 + g), \qquad \bar V(g) = \Big( \frac1T \int V^2 dt \Big)^{1/2},

which is the amount of U, and its root mean square, where nothing is lost. A constant voltage is that of an instant. It
attracts by Eq. 3 whatever leaks, and :func:`remains` computes what is left of it.

**Insulators** between finger and electrode, and what they lose, are keys of a scene. Without losses the attraction is
that of Eq. 3 at every frequency. With a leak or with tissue that conducts it is that of the circuit, by the frequency
and the waveform of the drive.
"""

from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache, cached_property
from typing import Annotated, Any, Literal

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import BeforeValidator, Discriminator, Tag, model_validator

from fingerpad.scene.controls import CarriedWaveform
from fingerpad.scene.messages import NAME, NUMBER, TABLE, show
from geometry.units import Finite, Table, within
from variational.attraction.circuit import LEAKS, GapCircuit, Network, fit_leak
from variational.attraction.dielectric import TISSUES, VACUUM_PERMITTIVITY, TabledTissue, insulator_thickness
from variational.roughness.gaps import BREAKDOWN_FIELD, BREAKDOWN_PLATEAU, breakdown_voltage

Array = NDArray[np.float64]
SAMPLES = 4096
"""Least number of samples of a period."""
_MOST_SAMPLES = 65536
_OF_CARRIER, _OF_WAVE, _OF_PIECE = 32, 128, 4  # samples of a period of either, and of the shortest piece of a file
REFERENCE = 1.6e-6
"""Gap (m) for which tables print the attraction and what remains, and at which the full model has the waveform: that of
a ridge of the default finger."""
GAPS = np.geomspace(2e-8, 2e-4, 97)
"""Gaps (m) between which the voltage of Eq. 3 is interpolated, in the logarithm; within 1e-4 of the largest."""


# -- keys of a scene -------------------------------------------------------------------------------------------
Permittivity = Annotated[Finite, within(1.0, 1e7)]
_Many = BeforeValidator(lambda value: tuple(value) if isinstance(value, list) else value)
_Frequency = Annotated[Finite, within(1e-3, 1e12, "Hz")]
_Conductivity = Annotated[Finite, within(1e-15, 1e3, zero=True)]


class TissueTable(Table):
    """A measured tissue over the frequency, in place of a name."""

    frequency: Annotated[tuple[_Frequency, ...], _Many]
    """Frequencies (Hz), growing. A drive of another frequency is refused."""
    eps: Annotated[tuple[Permittivity, ...], _Many]
    """Relative permittivity at each."""
    sigma: Annotated[tuple[_Conductivity, ...], _Many]
    """Conductivity at each (S/m)."""

    @model_validator(mode="after")
    def _consistent(self) -> "TissueTable":
        self.tissue()
        return self

    def tissue(self) -> TabledTissue:
        """Return the tissue; raises ``ValueError`` as that does."""
        return TabledTissue(self.frequency, self.eps, self.sigma)


class PeakLeak(Table):
    """A leak by the frequency at which the share of the gap in the voltage is largest, in place of a number."""

    peak: Annotated[Finite, within(1.0, 1e4, "Hz")]
    """Frequency of the peak (Hz)."""
    gap: Annotated[Finite, within(1e-8, 1e-4, "m")] = 1.6e-6
    """Gap (m) at which it was found."""


def _kind(value: Any) -> str:
    """Return which kind of value a key has that takes a number, a name or a table."""
    if isinstance(value, dict | Table):
        return TABLE
    return NAME if isinstance(value, str) and not any(map(str.isdigit, value)) else NUMBER


_TissueName = Literal["lossless", "dry", "moist"]
_LeakName = Literal["none", "sliding dry", "resting", "moist"]
assert {*TISSUES, "lossless"} == {*_TissueName.__args__} and {*LEAKS, "none"} == {*_LeakName.__args__}  # type: ignore[attr-defined]
_Tissue = Annotated[
    Annotated[_TissueName, Tag(NAME)] | Annotated[TissueTable, Tag(TABLE)],
    Discriminator(lambda value: TABLE if _kind(value) == TABLE else NAME),
]
_Ohms = Annotated[Finite, within(1e-3, 1e9, "ohm m^2")]
_Leak = Annotated[
    Annotated[_Ohms, Tag(NUMBER)] | Annotated[_LeakName, Tag(NAME)] | Annotated[PeakLeak, Tag(TABLE)],
    Discriminator(_kind),
]


class Electric(Table):
    """Insulators between finger and electrode (Table 3), and their losses."""

    eps_sc: Permittivity = 1650.0
    """Relative permittivity of the stratum corneum at 3 kHz. Range: vacuum to ten times the skin's at the lowest
    frequencies."""
    d_i: Annotated[Finite, within(1e-9, 1e-2, "m")] = 1e-6
    """Thickness of the screen's coating, its insulating layer (m). Range: a few atoms to a pane of glass."""
    eps_i: Permittivity = 3.9
    """Relative permittivity of the screen's coating. Range: vacuum to ferroelectrics."""
    tissue: _Tissue = "lossless"
    """Stratum corneum over the frequency: ``"lossless"`` with eps_sc, as in the paper, ``"dry"`` or ``"moist"`` by
    published constants of skin (:mod:`variational.attraction.dielectric`), or a table. *Assumption*: they are of the
    forearm and of whole skin, dry and wetted. The reach of the attraction in the microscale stays that of eps_sc."""
    leak: _Leak = "none"
    """Resistance R_gap (ohm m²) of a unit of area through which charge leaks over the gap: a number, a preset, or the
    frequency of a peak. *Assumption*: no source gives it; ``"sliding dry"`` is 300, likely 230 to 410, from a
    published peak at 250 Hz, ``"resting"`` 67, likely 30 to 150, and ``"moist"`` 30, a guess of 3 to 100. Range: much
    less than any skin to none at all."""
    follows: Literal["mean", "instantaneous"] = "instantaneous"
    """Which attraction the full model takes of a waveform in a load: at each instant, or its mean over the period
    with which the drive repeats itself. A finger is too slow for the force of a drive above some 100 Hz, where inertia
    begins to matter and the quasi-static model ends; its shape then follows the mean. A carrier is always averaged."""

    def h_0(self, d_sc: float) -> float:
        """Return the effective insulator thickness (m) under stratum corneum of thickness ``d_sc`` (m)."""
        return insulator_thickness(d_sc, self.eps_sc, self.d_i, self.eps_i)

    def circuit(self, d_sc: float) -> GapCircuit:
        """Return the circuit of the gap under stratum corneum of thickness ``d_sc`` (m).

        Raises:
            ValueError: no leak has the peak that is asked for.
        """
        tissue = self.tissue.tissue() if isinstance(self.tissue, TissueTable) else self.tissue
        if isinstance(self.leak, PeakLeak):
            dielectric = GapCircuit(tissue, eps_sc=self.eps_sc).dielectric
            try:
                leak: str | float | None = fit_leak(
                    self.leak.peak, dielectric, self.leak.gap, self.d_i, self.eps_i, d_sc
                )
            except ValueError as error:
                raise ValueError(f"electric.leak.{error}; give another tissue, or a leak in ohm m^2") from None
        else:
            leak = None if self.leak == "none" else self.leak
        return GapCircuit(tissue, leak, self.eps_sc)


# -- the drive -------------------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Measures:
    """How large a drive is: of the voltage in V, of the attraction in Pa."""

    amplitude: float
    """Half of the peak-to-peak value."""
    peak_to_peak: float
    rms: float
    """Root mean square of the whole voltage, its offset too."""
    mean: float
    """Mean voltage."""
    sigma_el: float
    """Mean attraction across a gap of :data:`REFERENCE`."""

    def __str__(self) -> str:
        """Return one line."""
        return (
            f"U: amplitude {self.amplitude:.4g} V, peak to peak {self.peak_to_peak:.4g} V, rms {self.rms:.4g} V, mean "
            f"{self.mean:.3g} V; mean attraction {self.sigma_el:.4g} Pa across {1e6 * REFERENCE:g} µm of air"
        )


@dataclass(frozen=True)
class Drive:
    """A drive and the circuit behind it."""

    wave: CarriedWaveform
    circuit: GapCircuit
    layers: tuple[float, float, float]
    """d_i (m), eps_i and d_sc (m)."""
    h_0: float
    """Effective insulator thickness of Eq. 3 (m)."""

    @property
    def frequency(self) -> float:
        """Frequency (Hz) with which the drive repeats itself."""
        return 1 / self.wave.period

    @cached_property
    def voltages(self) -> Array:
        """Voltages of the drive at equal times over one period, shape (samples,) (V)."""
        return one_period(self.wave)

    def across(self, gap: float) -> Array:
        """Return the voltage across a gap (m) over one period, shape (samples,) (V)."""
        return self.circuit.response(self.voltages, self.frequency, gap, *self.layers)

    def attraction(self, gap: float) -> Array:
        """Return the attraction sigma_el across a gap (m) over one period, shape (samples,) (Pa)."""
        return np.asarray(VACUUM_PERMITTIVITY / 2 * (self.across(gap) / gap) ** 2)

    def measures(self) -> Measures:
        """Return how large the drive is."""
        u = self.voltages
        low, high = float(u.min()), float(u.max())
        rms, sigma = float(np.sqrt(np.mean(u**2))), float(self.attraction(REFERENCE).mean())
        mean = self.wave.mean
        return Measures((high - low) / 2, high - low, rms, 0.0 if abs(mean) < 1e-9 * rms else mean, sigma)

    @cached_property
    def reference(self) -> float:
        """The constant voltage of Eq. 3 that attracts as the drive on average across :data:`REFERENCE` (V)."""
        return float(self.effective(REFERENCE))

    # -- as a voltage of Eq. 3 -----------------------------------------------------------------------------
    @cached_property
    def _table(self) -> Array:
        """The voltage of Eq. 3 with its sign, over gaps and time, shape (gaps, samples)."""
        return np.array([self.across(g) * (self.h_0 + g) / g for g in GAPS])

    @cached_property
    def _means(self) -> Array:
        return np.asarray(np.sqrt(np.mean(self._table**2, axis=1)))

    def instants(self, gap: Array) -> Array:
        """Return the voltage of Eq. 3 at each instant of a period (V), by the gap (m) then; shape (samples,)."""
        if self.circuit.lossless:
            return np.abs(self.voltages)
        place = np.interp(np.log(gap), np.log(GAPS), np.arange(len(GAPS)))
        low = np.minimum(place.astype(int), len(GAPS) - 2)
        part, at = place - low, np.arange(len(self.voltages))
        return np.abs((1 - part) * self._table[low, at] + part * self._table[low + 1, at])

    def effective(self, gap: ArrayLike) -> Array:
        """Return the constant voltage of Eq. 3 that attracts as the drive on average, by the gap (m); its shape (V)."""
        if self.circuit.lossless:
            return np.full(np.shape(gap), float(np.sqrt(np.mean(self.voltages**2))))
        return np.asarray(np.interp(np.log(np.asarray(gap, dtype=float)), np.log(GAPS), self._means))

    def largest(self, low: float, high: float) -> float:
        """Return the largest voltage of Eq. 3 (V) across gaps from ``low`` to ``high`` (m)."""
        if self.circuit.lossless:
            return float(np.abs(self.voltages).max())
        first, last = np.searchsorted(GAPS, (low, high))
        return float(np.abs(self._table[max(first - 1, 0) : last + 1]).max())

    def pressure(self, volts: Array, gap: Array) -> Array:
        """Return the attraction (Pa) at voltages of Eq. 3 (V) across gaps (m), of their shape."""
        return np.asarray(VACUUM_PERMITTIVITY / 2 * (volts / (self.h_0 + gap)) ** 2)


@cache
def drive_of(wave: CarriedWaveform, electric: Electric, d_sc: float) -> Drive:
    """Return the drive of a drive.

    Args:
        wave: the drive.
        electric: insulators and losses.
        d_sc: thickness of the stratum corneum (m).
    """
    return Drive(wave, electric.circuit(d_sc), (electric.d_i, electric.eps_i, d_sc), electric.h_0(d_sc))


def refuse_drives(drives: Mapping[str, CarriedWaveform], electric: Electric, d_sc: float) -> None:
    """Refuse insulators without a circuit, and drives that break down every gap or whose frequency no tissue has.

    Args:
        drives: of a scene, by key.
        electric: insulators and losses.
        d_sc: thickness of the stratum corneum (m).

    Raises:
        ValueError: in one sentence.
    """
    electric.circuit(d_sc)
    for key, wave in drives.items():
        drive = drive_of(wave, electric, d_sc)
        if abs(wave.offset) > (highest := _widest(drive.h_0)):
            raise ValueError(
                f"{key}.offset is {show(wave.offset)} V, beyond breakdown of air in a gap of any width; it must be at "
                f"most {highest:.4g} V"
            )
        try:
            drive.circuit.dielectric.refuse(wave.frequency or drive.frequency)
        except ValueError as error:
            raise ValueError(f"{key}.{error}") from None


def _widest(h_0: float) -> float:
    """Return the largest voltage (V) that some gap bears without losses."""
    gaps = np.array([BREAKDOWN_PLATEAU / BREAKDOWN_FIELD])  # where the plateau begins
    return float(np.max(breakdown_voltage(gaps) * (gaps + h_0) / gaps))


def one_period(wave: CarriedWaveform) -> Array:
    """Return the voltages of a drive at equal times over the period with which it repeats itself, from its start on.

    Returns:
        A power of two of voltages (V), at least :data:`SAMPLES`.
    """
    if wave.times is not None:
        least = _OF_PIECE * wave.period / float(np.diff(wave.times).min())
    else:
        carried = 0 if wave.carrier is None else round(wave.carrier.frequency * wave.period)
        least = max(_OF_WAVE * round(wave.period * (wave.frequency or 1.0)), _OF_CARRIER * carried)
    n = min(max(SAMPLES, 1 << int(np.ceil(np.log2(max(least, 1))))), _MOST_SAMPLES)
    return wave.at(np.arange(n), n)


# -- a constant voltage ----------------------------------------------------------------------------------------
@dataclass(frozen=True)
class Remains:
    """What is left of a constant voltage across a gap that leaks."""

    decay: float
    """Time constant of what leaks (s); infinite where nothing does."""
    share: float
    """Attraction after a tenth of a second, over that without losses."""


def remains(electric: Electric, d_sc: float) -> Remains:
    """Return what is left of a constant voltage across :data:`REFERENCE` after 0.1 s.

    Args:
        electric: insulators and losses.
        d_sc: thickness of the stratum corneum (m).

    Raises:
        ValueError: the tissue is a table, which has no equations in time.
    """
    network = Network.of(electric.circuit(d_sc), REFERENCE, electric.d_i, electric.eps_i, d_sc)
    left = network.response([0.0, 0.0, 0.1], [0.0, 1.0, 1.0])[-1]
    return Remains(network.decay(), float(left * (electric.h_0(d_sc) + REFERENCE) / REFERENCE) ** 2)


def leak_in_words(circuit: GapCircuit) -> str:
    """Return the leak with the range in which it is likely, for every page that uses it."""
    if circuit.leak is None:
        return "no leak"
    known = LEAKS[circuit.leak] if isinstance(circuit.leak, str) else LEAKS["sliding dry"]
    name = f"'{circuit.leak}', " if isinstance(circuit.leak, str) else ""
    of = known.source if name else "likely for a dry finger that slides"
    return f"R_gap {name}{circuit.resistance:.4g} ohm m², {known.low:g} to {known.high:g}: {of}"
