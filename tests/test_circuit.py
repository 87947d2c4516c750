"""The circuit of the gap: Eq. 3 without losses, closed forms, golden values, and the same response in time."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

import fingerpad as fp
from benchmarks.measured import drives, findings
from benchmarks.measured.fingers import Finger
from variational.attraction.circuit import GapCircuit, Network, fit_leak
from variational.attraction.dielectric import DRY, MOIST, VACUUM_PERMITTIVITY, TabledTissue, insulator_thickness

LAYERS = {"gap": 1.6e-6, "d_i": 1e-6, "eps_i": 3.9, "d_sc": 425e-6}
BEHIND = (1e-6, 3.9, 425e-6)
FREQUENCIES = (1.0, 10.0, 30.0, 100.0, 230.0, 1e3, 3e3, 1e4, 1e5, 1e6)
GOLDEN = {
    160.0: (0.0012, 0.1034, 0.4357, 0.6865, 0.7185, 0.7014, 0.6088, 0.5289, 0.5128, 0.4994),
    300.0: (0.0042, 0.2688, 0.6162, 0.7222, 0.7310, 0.7074, 0.6113, 0.5293, 0.5128, 0.4994),
    None: (0.7428, 0.7428, 0.7428, 0.7425, 0.7411, 0.7141, 0.6142, 0.5296, 0.5128, 0.4994),
}
"""Shares by independent code, by R_gap (ohm m²)."""
LOSSY = [GapCircuit("dry", 300.0), GapCircuit("dry"), GapCircuit("moist", 30.0), GapCircuit("lossless", 300.0)]
NAMES = ["dry, leak", "dry", "moist, leak", "lossless, leak"]


# -- tissue ----------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize(("tissue", "eps", "sigma"), [(DRY, 38.007, 1.464), (MOIST, 42.853, 1.592)], ids=["dry", "wet"])
def test_skin_at_microwaves(tissue, eps, sigma):
    """Published at 2.45 GHz, to the three digits after the point that are printed: within 2e-4 of each."""
    found = tissue.permittivity(2.45e9)
    conductivity = -found.imag * 2 * np.pi * 2.45e9 * VACUUM_PERMITTIVITY
    assert_allclose((found.real, conductivity), (eps, sigma), rtol=2e-4)


@pytest.mark.parametrize("tissue", [DRY, MOIST], ids=["dry", "moist"])
def test_spectrum_of_debye_terms(tissue):
    """Debye terms have the permittivity of the Cole–Cole terms, up to 2e-6 of what counts as instantaneous."""
    spectrum, f = tissue.debye(), np.geomspace(0.1, 1e6, 29)
    s = 2j * np.pi * f[:, None]
    found = spectrum.eps_inf + (spectrum.delta / (1 + s * spectrum.tau)).sum(axis=1)
    found += spectrum.sigma / (s[:, 0] * VACUUM_PERMITTIVITY)
    assert_allclose(np.abs(found / tissue.permittivity(f) - 1), 0, atol=2e-6)


@pytest.mark.parametrize(
    ("table", "words"),
    [
        (((0, 10), (2, 2), (0, 0)), "frequency is 0 and then 10 Hz"),
        (((1, 10), (2,), (0, 0)), "eps has 1 values and frequency has 2; each frequency needs one"),
    ],
)
def test_table_is_refused(table, words):
    with pytest.raises(ValueError, match=words):
        TabledTissue(*table)


# -- shares ----------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("leak", GOLDEN)
def test_golden_shares(leak):
    """Golden values have four digits after the point."""
    found = fp.GapCircuit(tissue="dry", leak=leak).share(FREQUENCIES, **LAYERS)
    assert_allclose(found, GOLDEN[leak], atol=1e-4)


@pytest.mark.parametrize(("leak", "at", "share"), [(160.0, 349.9, 0.7211), (300.0, 252.9, 0.7311)])
def test_golden_peak(leak, at, share):
    """The peak is flat: the share changes by 1e-6 over the 0.2 % within which its place agrees."""
    circuit = GapCircuit("dry", leak)
    assert circuit.peak(**LAYERS) == pytest.approx(at, rel=2e-3)
    assert circuit.share(circuit.peak(**LAYERS), **LAYERS) == pytest.approx(share, abs=1e-4)


def test_lossless_limit_is_eq_3():
    """E = U / (g + h_0) at every frequency. Tolerance: roundoff."""
    g, h_0 = np.array([0.5e-6, 1.6e-6, 12e-6]), insulator_thickness(425e-6, 1650.0, 1e-6, 3.9)
    for frequency in (0.01, 250.0, 1e6):
        found = GapCircuit().share(frequency, g, *BEHIND)
        assert_allclose(found, (g / (g + h_0)) ** 2, rtol=1e-14)


@pytest.mark.parametrize(("circuit", "left"), [(GapCircuit("dry", 300.0), 0.0), (GapCircuit("dry"), 0.86188)])
def test_constant_voltage(circuit, left):
    """Nothing is left across a gap that leaks; without a leak skin that conducts keeps nothing: g / (g + d_i / eps_i).

    Tolerance: of a frequency that is not 0 but 1e-5 Hz.
    """
    assert circuit.gain(0.0, **LAYERS) == pytest.approx(left, abs=1e-5)
    assert abs(circuit.gain(1e-5, **LAYERS)) == pytest.approx(left, abs=1e-5)


@pytest.mark.parametrize(("gap", "leak"), [(1.0e-6, 233.0), (1.6e-6, 309.0), (2.5e-6, 409.0)])
def test_leak_of_a_peak(gap, leak):
    """The leak that puts the peak at 250 Hz. Tolerance: the published ones are of frequencies within 1.1 % of it."""
    found = fit_leak(250.0, "dry", gap, *BEHIND)
    assert found == pytest.approx(leak, rel=2.5e-2)
    assert GapCircuit("dry", found).peak(gap, *BEHIND) == pytest.approx(250.0, rel=1e-4)


# -- over time -------------------------------------------------------------------------------------------------------
@pytest.mark.parametrize("circuit", LOSSY, ids=NAMES)
def test_modes_have_the_gain_of_the_circuit(circuit):
    """Tolerance: 2e-7 is left of the terms that count as instantaneous, at 1 MHz."""
    f = np.geomspace(0.1, 1e6, 29)
    assert_allclose(Network.of(circuit, **LAYERS).gain(f), circuit.gain(f, **LAYERS), atol=5e-7)


@pytest.mark.parametrize("circuit", LOSSY, ids=NAMES)
@pytest.mark.parametrize("frequency", [15.0, 1e3])
def test_time_and_frequency_agree(circuit, frequency):
    """A sine with an offset in the steady state. Tolerance: 1e-6; a sine of 4096 straight pieces is off by 2e-7."""
    t = np.arange(4097) / 4096
    u = 0.3 + np.sin(2 * np.pi * t)
    found = Network.of(circuit, **LAYERS).periodic(t / frequency, u)[:-1]
    assert_allclose(found, circuit.response(u[:-1], frequency, **LAYERS), atol=1e-6)


def talbot(transform, t: float, terms: int = 28) -> float:
    """Return the inverse Laplace transform at a time, by a contour of Talbot (Abate and Valkó 2004)."""
    r = 2 * terms / (5 * t)
    theta = np.arange(1, terms) * np.pi / terms
    s = r * theta * (1 / np.tan(theta) + 1j)
    sigma = theta + (theta / np.tan(theta) - 1) / np.tan(theta)
    inside = np.exp(t * s) * transform(s) * (1 + 1j * sigma)
    return float(r / terms * (np.exp(r * t) * transform(np.array([r + 0j]))[0] / 2 + inside.sum()).real)


@pytest.mark.parametrize("time", [1e-4, 3e-3, 0.05])
def test_step_against_an_inverse_transform(time):
    """A step over moist skin: modes beside Talbot's contour, which has the fractional terms as they are."""
    circuit = GapCircuit("moist", 30.0)
    found = Network.of(circuit, **LAYERS).response([0.0, 0.0, time], [0.0, 1.0, 1.0])[-1]
    assert found == pytest.approx(complex_step(circuit, time), abs=1e-6)


def complex_step(circuit: GapCircuit, time: float) -> float:
    """Return the voltage across the gap after a step of 1 V, from the circuit at complex frequencies."""
    tissue, (d_i, eps_i, d_sc), g = circuit.dielectric, BEHIND, LAYERS["gap"]

    def transform(s):
        eps = tissue.eps_inf + sum(d / (1 + (s * tau) ** (1 - a)) for d, tau, a in tissue.terms)
        skin = d_sc / (s * VACUUM_PERMITTIVITY * eps + tissue.sigma)
        leak = s * VACUUM_PERMITTIVITY / g + 1 / circuit.resistance
        return 1 / (1 + (d_i / (s * VACUUM_PERMITTIVITY * eps_i) + skin) * leak) / s

    return talbot(transform, time)


def test_polarity_changes():
    """What has leaked while a constant voltage lasted is there again, with the other sign, when it changes its own.

    After ten time constants of each state the jump is twice that of switching on, within 1e-3 of slow tissue.
    """
    network = Network.of(GapCircuit("dry", 300.0), **LAYERS)
    long = 30 * network.decay()
    found = network.response([0.0, 0.0, long, long, 2 * long], [0.0, 1.0, 1.0, -1.0, -1.0])
    assert abs(found[2]) < 1e-6 and abs(found[4]) < 1e-6
    assert found[3] == pytest.approx(-2 * found[1], rel=1e-6)


def test_offset_and_sine_attract_at_two_frequencies():
    """(U_0 + U_1 sin)² has 2 U_0 U_1 at f and U_1² / 2 at 2 f, each by the gains there; with a leak f is gone."""
    f, n = 100.0, 256
    u = 150 + 50 * np.sin(2 * np.pi * np.arange(n) / n)
    for circuit in (GapCircuit(), GapCircuit("dry", 300.0)):
        h_0, h_1 = circuit.gain(0.0, **LAYERS), abs(circuit.gain(f, **LAYERS))
        squared = np.abs(np.fft.rfft(circuit.response(u, f, **LAYERS) ** 2)) * 2 / n
        assert_allclose(squared[1:3], (2 * 150 * 50 * abs(h_0) * h_1, 50**2 / 2 * h_1**2), rtol=1e-12, atol=1e-9)


# -- breakdown, refusals ---------------------------------------------------------------------------------------------


@pytest.mark.parametrize(
    ("changes", "words"),
    [
        ({"tissue": "wet"}, "tissue is 'wet'; it must be 'lossless', 'dry', 'moist' or a Tissue"),
        ({"leak": 0.0}, "leak is 0.0; it must be greater than 0 ohm m² and finite"),
    ],
)
def test_circuit_is_refused(changes, words):
    with pytest.raises(ValueError, match=words):
        GapCircuit(**changes)


@pytest.mark.parametrize(
    ("frequency", "gap", "words"),
    [
        (0.0, 1e-6, "frequency is 0 Hz; it must be greater than 0"),
        (100.0, 0.0, "gap is 0 m; it must be greater than 0"),
        (2e3, 1e-6, "frequency is 2000 Hz; the table of the tissue has 10 to 1000 Hz"),
    ],
)
def test_share_is_refused(frequency, gap, words):
    circuit = GapCircuit(TabledTissue((10, 1000), (2000, 1000), (1e-4, 1e-3)))
    with pytest.raises(ValueError, match=words):
        circuit.share(frequency, gap, *BEHIND)


def test_impedance_of_a_sliding_finger():
    """Of equal plates it goes with 1 over their length. At 10 Hz it hardly changes with a gap that the leak shorts."""
    row, finger = findings.read()[0]["gap_sliding"], Finger(fp.Scene(), {})
    gap, length = np.full(3, 1.6e-6), np.full(3, 2e-3)
    numbers, verdict = drives.sliding(row, finger, (gap, length), finger, (gap, length / 2))
    assert_allclose((numbers["low"], numbers["high"]), 2.0)
    assert verdict == "hit"
    numbers, verdict = drives.sliding(row, finger, (gap, length), finger, (1.1 * gap, length))
    assert abs(numbers["low"] - 1) < 0.01 and 1.05 < numbers["high"] < 1.1 and verdict == "miss"
