"""Insulators between finger and electrode, and what they lose: keys of a scene.

Without losses the attraction is that of Eq. 3 at every frequency. With a leak or with tissue that conducts it is that
of a circuit (:mod:`variational.attraction.circuit`), by the frequency and the waveform of the drive.
"""

from typing import Annotated, Any, Literal

from pydantic import BeforeValidator, Discriminator, Tag, model_validator

from fingerpad.scene.messages import NAME, NUMBER, TABLE
from geometry.units import Finite, Table, within
from variational.attraction.circuit import LEAKS, GapCircuit, fit_leak
from variational.attraction.dielectric import TISSUES, TabledTissue, insulator_thickness

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
