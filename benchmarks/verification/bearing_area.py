r"""The bearing area model in 30 digits, from Forsbach et al. (2023) and Table 3 alone, apart from the program's.

With :math:`\sigma_0 = \varepsilon_0 U^2 / 2 h_0^2` and the area of attraction

.. math:: \frac{A}{A_0} = \frac12 \left[ \operatorname{erfc} \frac{\bar u - h_0}{\sqrt2 h_{rms}} -
          \operatorname{erfc} \frac{\bar u}{\sqrt2 h_{rms}} \right], \qquad
          p_{ext} = \beta E^* q_0 h_{rms} e^{-\bar u / \gamma h_{rms}} - \sigma_0 \frac{A}{A_0}, \qquad
          \sigma_0 \frac{A}{A_0} = \frac{\varepsilon_0 U^2}{2 (h_0 + d_{eq})^2} .
"""

from typing import Any

from mpmath import mp

_MP = mp.clone()
_MP.dps = 30
Number = Any  # mpmath's

H_RMS, WAVELENGTH, YOUNG, GAMMA, EPS_0 = map(_MP.mpf, ("3.1e-6", "1e-4", "1e6", "0.5", "8.854e-12"))
UM = _MP.mpf("1e-6")
H_0 = _MP.mpf("425e-6") / 1650 + _MP.mpf("1e-6") / _MP.mpf("3.9")


def contact_pressure(u_bar: Number, beta: Number = 1) -> Number:
    """Return p_c (Pa), first term of Eq. 9, at a mean separation (m)."""
    return beta * 4 * YOUNG / 3 * 2 * _MP.pi / WAVELENGTH * H_RMS * _MP.exp(-u_bar / (GAMMA * H_RMS))


def attracted(u_bar: Number) -> Number:
    """Return A / A_0, Eq. 11."""
    width = _MP.sqrt(2) * H_RMS
    return (_MP.erfc((u_bar - H_0) / width) - _MP.erfc(u_bar / width)) / 2


def air_gap(u_bar: Number) -> Number:
    """Return d_eq (m), Eq. 13."""
    return H_0 * (1 / _MP.sqrt(attracted(u_bar)) - 1)


def attraction(u_bar: Number, voltage: Number) -> Number:
    """Return sigma_0 A / A_0 (Pa) at a voltage (V)."""
    return EPS_0 * _MP.mpf(voltage) ** 2 / (2 * H_0**2) * attracted(u_bar)


def external_pressure(u_bar: Number, voltage: Number) -> Number:
    """Return p_ext (Pa), Eq. 9, at a voltage (V)."""
    return contact_pressure(u_bar) - attraction(u_bar, voltage)


def separation(p_ext: Number, voltage: Number) -> Number:
    """Return u_bar (m) on the branch in contact at an external pressure (Pa)."""
    end = turn(voltage, 5e-6) if voltage > 156 else 10 * H_RMS

    def excess(x: Number) -> Number:
        return _MP.log(contact_pressure(x * H_RMS) / (p_ext + attraction(x * H_RMS, voltage)))

    return _MP.findroot(excess, (0, end / H_RMS), solver="anderson", maxsteps=100) * H_RMS


def uniform(p_ext: Number, voltage: Number) -> tuple[Number, Number]:
    """Return d_eq (m) and p_c (Pa) of a uniform ridge in contact at an external pressure (Pa)."""
    u_bar = separation(p_ext, voltage)
    return air_gap(u_bar), contact_pressure(u_bar)


def held(p_c: Number) -> Number:
    """Return d_eq (m) at a mean contact pressure (Pa)."""
    return air_gap(GAMMA * H_RMS * _MP.log(contact_pressure(0) / p_c))


def slope(u_bar: Number) -> Number:
    """Return d d_eq / d p_c (m/Pa) at a mean separation (m)."""
    x = u_bar / H_RMS
    gap, p_c = (_MP.diff(lambda y, f=f: f(y * H_RMS), x) for f in (air_gap, contact_pressure))
    return gap / p_c


def turn(voltage: Number, near: float) -> Number:
    """Return u_bar (m) at which p_ext turns, near a given one."""
    return _MP.findroot(lambda x: _MP.diff(lambda y: external_pressure(y * H_RMS, voltage), x), near / H_RMS) * H_RMS


def first_turn() -> tuple[Number, Number]:
    """Return u_bar (m) and the voltage (V) at which p_ext begins to turn: its first two derivatives vanish."""

    def slopes(x: Number, voltage: Number) -> list[Number]:
        return [_MP.diff(lambda y: external_pressure(y * H_RMS, voltage), x, k) for k in (1, 2)]

    x, voltage = _MP.findroot(slopes, (2.5, 155.5))
    return x * H_RMS, voltage


def threshold(beta: Number = 1) -> Number:
    """Return the voltage (V) at which the least p_ext is zero."""

    def squared(x: Number) -> Number:
        return contact_pressure(x * H_RMS, beta) * 2 * H_0**2 / (EPS_0 * attracted(x * H_RMS))

    return _MP.sqrt(squared(_MP.findroot(lambda x: _MP.diff(lambda y: _MP.log(squared(y)), x), 2)))
