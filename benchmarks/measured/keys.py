"""Findings that the default finger cannot have, with keys of a scene that it leaves out.

- Flat tips: ``geometry.ridge_profile`` of :data:`.fingers.FLAT`, flat over half a ridge. Pressed as the page's other
  fingers.
- Viscous layers: the preset "fingerpad" in all soft layers. Its force over time and its friction after a step of the
  voltage are those of docs/viscosity.json; a press that is held for 20 s is run here.
- A shear stress on the ridges in place of a friction coefficient: ``Derjaguin`` with mu_f of 0, by the closed form.
- Boundary elements without a field in contact, at the pressures of ridges with flat tips.
"""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import brentq

from benchmarks import viscosity
from benchmarks.measured import fingers, rules
from benchmarks.measured.rules import HIT, RATIO, SIMILAR, by_factor, by_form, by_share
from benchmarks.runs import FORCES, Run
from fingerpad.reduced import cylinders
from fingerpad.scene import Scene
from variational.attraction.dielectric import VACUUM_PERMITTIVITY
from variational.roughness.boundary_elements import BoundaryElements

Array = NDArray[np.float64]
Row = tuple[dict[str, float], str]
SHEAR = 12.1e3  # Pa, on the ridges; makes mu_app of the default finger 0.25 at 0.5 N without voltage
EFFECTIVE = (0.0, 70.7)  # V; 200 V from peak to peak at most
GROWS = 20.0  # s, for which the real contact on glass was seen to grow
GROWN = 0.95  # of the growth in that time


def scene() -> Scene:
    """Return a viscous finger that is pressed at once and held by its force."""
    press = {"name": "press", "f_ext": fingers.FORCE}
    layers = {name: {"viscosity": {"preset": "fingerpad"}} for name in viscosity.SOFT}
    history = [press, press | {"name": "hold", "duration": GROWS}]
    return fingers.pressed(fingers.SIZES[-1], {"materials": layers, "history": history})


def held(out: Path) -> dict[str, list[float]]:
    """Return contact length (m) over time (s) of the finger that is held, from its run in a folder."""
    steps = Run(scene(), out).steps
    last = int(np.flatnonzero(steps["load"] == "press")[-1])
    return {"time": list(steps["time"][last:]), "length": list(steps["contact_length"][last:])}


def _time(held: Mapping[str, list[float]]) -> Row:
    """Judge for how long the contact grows."""
    time, length = (np.array(held[name]) for name in ("time", "length"))
    grown = (length - length[0]) / (length[-1] - length[0])
    until = float(np.interp(GROWN, np.maximum.accumulate(grown), time))
    numbers = {"growth": float(length[-1] / length[0] - 1), "until": until, "seconds": float(time[-1])}
    return numbers, by_factor(until, until, GROWS, GROWS, RATIO)


def _relaxation(known: Mapping[str, Any]) -> Row:
    """Judge the three times of the force at a held depth."""
    times = known["held"]["times"]
    factors = [found / measured for found, measured in zip(times, viscosity.TIMES, strict=True)]
    numbers = {f"time_{k}": 1e3 * time for k, time in enumerate(times)}
    return numbers, by_factor(min(factors), max(factors), 1.0, 1.0, RATIO)


def _speed(known: Mapping[str, Any]) -> Row:
    """Judge that friction follows a voltage with a delay, at first order, and sooner at the higher speed."""
    delays, fitted = [], []
    for speed in viscosity.SPEEDS:
        found = known["steps"][f"fingerpad at {1e3 * speed:g} mm/s"]
        time, rise = np.array(found["time"]), np.array(found["rise"])
        delays.append(float(np.interp(1 - np.exp(-1), np.maximum.accumulate(rise), time)))
        early = time <= 3 * found["way"] / speed
        fits = [rules.of_largest(form, time[early][1:], rise[early][1:]) for form in (rules.first_order, rules.ramp)]
        fitted.append([fit.misfit for fit in fits])
    misfits, others = zip(*fitted, strict=True)
    holds = [min(delays) > 0, delays[1] < delays[0], by_form(misfits, others) == HIT]
    names = {"slow": 1e3 * delays[0], "fast": 1e3 * delays[1], "misfit": max(misfits), "ramp": max(others)}
    return names, by_share(sum(holds) / len(holds))


def _shear() -> dict[str, Row]:
    """Judge how friction falls with the load where a shear stress limits it."""
    sheared = Scene(voltage=0.0, friction={"law": "Derjaguin", "mu_f": 0.0, "tau_0": SHEAR})  # type: ignore[arg-type]
    force: Array = np.array(FORCES)
    mu: Array = np.array([state.mu_app for state in cylinders.over_forces(sheared, FORCES, "full_slip")])
    factor, fall = float(mu.max() / mu.min()), float(1 - mu[-1] / mu[0])
    misfit, line = (rules.of_each(form, force, mu).misfit for form in (rules.falling_power, rules.falling_line))
    numbers = {"first": float(mu[0]), "last": float(mu[-1]), "factor": factor, "misfit": misfit, "line": line}
    numbers["exponent"] = float(np.polyfit(np.log(force), np.log(mu), 1)[0])
    verdicts = {
        "friction_occluded": by_factor(factor, factor, 5.0, 5.0, RATIO),
        "friction_acrylic": by_share(float(fall > SIMILAR)),
        "friction_power": by_form((misfit,), (line,)),
    }
    return {key: (numbers, verdict) for key, verdict in verdicts.items()}


def _flat(runs: Mapping[str, Any]) -> dict[str, Row]:
    """Judge share of the ridges, form of the pressure and air gaps of a finger with flat tips."""
    shares, fits, width = [], [], Scene().geometry.ridge_wavelength
    for size in fingers.SIZES:
        run = runs[fingers.name("flat", size)]
        shares.append(run["length"] / fingers.gross(run))
        points = np.array(run["place"]), np.array(run["pressure"])
        fits.append([rules.of_largest(form, *points).misfit for form in (rules.paraboloid, rules.ellipse)])
    coarse, fine = (runs[fingers.name("flat", size)] for size in fingers.SIZES)
    law, each = BoundaryElements(Scene().h_0, field_in_contact=False), fine["length"] / fine["ridges"]
    borne, of_coarse = (fingers.FORCE / run["length"] for run in (fine, coarse))
    most = width * float(np.max(fine["pressure"])) / each
    gaps = [1e6 * _gap(law, p, u) for p in (borne, most) for u in EFFECTIVE]
    error = abs(1e6 * _gap(law, of_coarse, EFFECTIVE[0]) - gaps[0])
    return {
        "ridges": (
            {"share": shares[-1], "error": abs(shares[-1] - shares[0])},
            by_factor(shares[-1], shares[-1], 0.67, 0.67, RATIO),
        ),
        "pressure_shape": (
            {"misfit": fits[-1][0], "error": abs(fits[-1][0] - fits[0][0]), "other": fits[-1][1]},
            by_form((fits[-1][0],), (fits[-1][1],)),
        ),
        "gap": (
            {"low": min(gaps), "high": max(gaps), "error": error, "mean": borne / 1e3, "most": most / 1e3},
            by_factor(min(gaps), max(gaps), 1.5, 2.5),
        ),
    }


def _gap(law: BoundaryElements, pressure: float, voltage: float) -> float:
    """Return the air gap (m) of a flat ridge that is pressed from outside (Pa) and attracted by a voltage (V)."""

    def excess(x: float) -> float:
        p_c = np.exp(x)
        return p_c - pressure - VACUUM_PERMITTIVITY * voltage**2 / 2 / (law.h_0 + float(law(p_c).d_eq)) ** 2

    p_c = np.exp(brentq(excess, np.log(pressure * (1 - 1e-9)), np.log(law.pressures[1])))
    return float(law(p_c).d_eq)


def of_time(known: Mapping[str, Any], held: Mapping[str, list[float]]) -> dict[str, Row]:
    """Return the rows of time, which the default scene does not have.

    Args:
        known: numbers of docs/viscosity.json.
        held: what :func:`held` returns.
    """
    return {"time": _time(held), "relaxation": _relaxation(known), "speed": _speed(known)}


def others(runs: Mapping[str, Any]) -> dict[str, Row]:
    """Return rows of the default finger once more, with other keys."""
    return _shear() | _flat(runs)
