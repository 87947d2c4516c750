"""The bearing area model against the numbers of Forsbach et al. (2023) and others evaluated from Eqs. 9 to 15."""

import numpy as np

from benchmarks.verification.case import Case, Curves, Outcome, Row, worst
from variational.roughness.bam import BearingArea

H_0 = 425e-6 / 1650 + 1e-6 / 3.9
EPS_0, MU_F = 8.854e-12, 0.25
_UM, _KPA = 1e-6, 1e3
_PAPER = "Forsbach et al. 2023, doi 10.3389/fmech.2022.1074393"
_DIGITS = "half of the last digit printed"

AIR_GAPS = {0: 1.489, 2: 1.650, 3: 1.917, 4: 2.363, 5: 3.071, 6: 4.193, 8: 8.97}  # um over um
VOLTAGES = (0.0, 50.0, 100.0, 150.0, 200.0)
CLOSURE = {  # p_ext (kPa): d_eq (um) / mu_app at VOLTAGES
    10: ((3.11, 0.250), (3.00, 0.272), (2.67, 0.359), (2.23, 0.582), (1.87, 1.03)),
    20: ((2.35, 0.250), (2.29, 0.268), (2.14, 0.329), (1.93, 0.459), (1.74, 0.685)),
    30: ((2.05, 0.250), (2.01, 0.264), (1.92, 0.312), (1.79, 0.406), (1.67, 0.560)),
    50: ((1.78, 0.250), (1.76, 0.261), (1.71, 0.295), (1.65, 0.356), (1.59, 0.450)),
}
EXTERNAL = {0.0: (4.37, 2.348, 1.565), 100.0: (3.508, 2.135, 1.546), 200.0: (1.981, 1.742, 1.509)}  # at 5, 20, 100 kPa


def _digits(value: float) -> float:
    """Return half a unit of the last digit of a number as it is written, and a thousandth more for its binary form."""
    return 0.5005 * 10.0 ** -len(repr(value).partition(".")[2])


def _printed(quantity: str, ours: float, reference: float, unit: float = 1.0, digits: float | None = None) -> Row:
    tolerance = _digits(reference) if digits is None else digits
    return Row(quantity, ours / unit, reference, tolerance, _DIGITS, absolute=True)


def separations(small: bool) -> Outcome:
    """Air gap over mean separation, Eqs. 11 and 13, its least value, Eq. 14, and where it is."""
    bam = BearingArea(H_0)
    u = np.linspace(0, 10 * _UM, 20001)
    d = bam.air_gap(u)
    rows = [_printed(f"d_eq at u_bar = {k} um (um)", float(bam.air_gap(k * _UM)), v, _UM) for k, v in AIR_GAPS.items()]

    least = (
        _printed("least d_eq (um)", float(d.min()), 1.486, _UM),
        Row("u_bar of the least d_eq over h_0", float(u[d.argmin()]) / H_0, 0.5, 1e-3, "sampling of 0.5 nm"),
    )
    known = {"reference": (list(AIR_GAPS), list(AIR_GAPS.values()))}
    axes = "mean separation ū (µm)", "equivalent air gap d_eq (µm)"
    return Outcome((worst(rows), *least), Curves(*axes, known, {"bearing area model": (u[::50] / _UM, d[::50] / _UM)}))


def thresholds(small: bool) -> Outcome:
    """Voltages of macroscopic stickiness, by Eq. 15 and by minimising Eq. 9 with either prefactor of the repulsion."""
    bam = BearingArea(H_0)
    return Outcome(
        (
            _printed("Eq. 15 (V)", bam.threshold(approximate=True), 155.2),
            _printed("least p_ext = 0, beta = 1 (V)", bam.threshold(), 163.6),
            _printed("least p_ext = 0, beta = 3/4 (V)", BearingArea(H_0, beta=0.75).threshold(), 141.7),
            _printed("p_c at u_bar = 0 (kPa)", bam.full_pressure, 259.7, _KPA),
        )
    )


def folds(small: bool) -> Outcome:
    """Pull-off and pull-in at 200 V, where p_ext(u_bar) of Eq. 9 turns."""
    bam, voltage = BearingArea(H_0), 200.0
    off = bam.pull_off_fold(voltage) or np.nan
    u = np.linspace(0, 16 * _UM, 160001)
    p = bam.external_pressure(u, voltage)
    beyond = u > off
    on = float(u[beyond][p[beyond].argmax()])

    rows = (
        _printed("pull-off: u_bar (um)", off, 4.95, _UM),
        _printed("pull-off: d_eq (um)", float(bam.air_gap(off)), 3.03, _UM),
        _printed("pull-off: p_ext (kPa)", float(bam.external_pressure(off, voltage)), -3.46, _KPA),
        _printed("pull-off: p_c (kPa)", float(bam.contact_pressure(off)), 10.7, _KPA),
        _printed("pull-in: u_bar (um)", on, 10.7, _UM),
        _printed("pull-in: p_ext (kPa)", float(p[beyond].max()), 0.107, _KPA),
    )
    known = {"folds at 200 V": ([4.95, 10.7], [-3.46, 0.107])}
    axes = "mean separation ū (µm)", "external pressure (kPa)"
    return Outcome(rows, Curves(*axes, known, {"200 V": (u[30000::2000] / _UM, p[30000::2000] / _KPA)}))


def uniform_ridge(small: bool) -> Outcome:
    """The closure of one uniform ridge, p_c = p_ext + sigma_el(d_eq(p_c)), with mu_app = mu_0 p_c / p_ext."""
    bam = BearingArea(H_0)
    gaps, frictions = [], []
    for kpa, printed in CLOSURE.items():
        for voltage, (d_eq, mu_app) in zip(VOLTAGES, printed, strict=True):
            d = bam.air_gap_at_external(kpa * _KPA, voltage)
            p_el = EPS_0 * voltage**2 / 2 / (H_0 + d) ** 2
            where = f"at {kpa} kPa, {voltage:g} V"
            gaps.append(_printed(f"d_eq {where} (um)", d, d_eq, _UM, digits=0.5005e-2))
            # Three digits are printed, four of those below one.
            digits = 0.5005e-2 if mu_app > 1 else 0.5005e-3
            frictions.append(_printed(f"mu_app {where}", MU_F * (1 + p_el / (kpa * _KPA)), mu_app, digits=digits))
    return Outcome((worst(gaps), worst(frictions)))


def external_pressures(small: bool) -> Outcome:
    """d_eq on the branch in contact at an external pressure."""
    bam = BearingArea(H_0)
    rows = [
        _printed(f"d_eq at {kpa} kPa, {voltage:g} V (um)", bam.air_gap_at_external(kpa * _KPA, voltage), d_eq, _UM)
        for voltage, printed in EXTERNAL.items()
        for kpa, d_eq in zip((5, 20, 100), printed, strict=True)
    ]
    return Outcome((worst(rows),))


CASES = (
    Case("Air gap over separation", f"{_PAPER}, Eqs. 11, 13, 14, evaluated anew", separations),
    Case("Thresholds of stickiness", f"{_PAPER}, Eqs. 9 and 15", thresholds),
    Case("Folds at 200 V", f"{_PAPER}, Eq. 9, evaluated anew", folds),
    Case("Uniform ridge", f"{_PAPER}, Eqs. 3, 9, 13, evaluated anew", uniform_ridge),
    Case("Air gap at an external pressure", f"{_PAPER}, Eqs. 9 and 13, evaluated anew", external_pressures),
)
