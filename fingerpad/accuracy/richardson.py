r"""Discretisation error of states from their values on other meshes: on two, or one mesh parameter after the other.

**Two meshes.** A run without an accuracy has its named states on two meshes, those of its path and of its results, with
elements of 2 h and h. Their difference makes the error (:func:`of_two_meshes`), of two whole paths over time too
(:func:`of_two_paths`).

**An accuracy** is met on one mesh after the other. A mesh parameter is a set of element sizes, or the step size, that
is halved at once, one parameter at a time, so that each change :math:`\Delta_k` of a quantity q belongs to one of them.
An error of :math:`C_k h_k^{p_k}` each gives to first order

.. math:: q - q_{exact} = \sum_k \frac{q(2 h_k) - q(h_k)}{2^{p_k} - 1}, \qquad
          E = \sum_k \frac{|\Delta_k|}{2^{p_k} - 1}

(Richardson's extrapolation as an estimate; Roache 1994, doi 10.1115/1.2910291). E adds magnitudes: signs that cancel on
one mesh need not on the next. The estimated error is E with a factor of safety on the share of each parameter:
:data:`ONCE` for one that was halved once, :data:`MORE` for others. Roache takes 3 and 1.25, for two and three meshes.

The orders are those known beforehand: p = 1 for forces and lengths, that of a contact's edge on a mesh whose nodes are
not at the edge; for energy densities deep in the skin that of the strains, p = 2 with quadratic elements and p = 1 with
linear ones. An order observed from three meshes is mostly noise, since an edge moves facet by facet. Two meshes that
differ in all elements leave lengths alone to the edge, whose facets are short there, and have p = 2 for all else.

For the same reason a change may come out small by accident. That of a sum over ridges counts as at least the root of
the sum of their squared changes, and any as at least a quarter of the one before it, which is second order.

Plain numbers only: no mesh, no solver.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from itertools import groupby

import numpy as np
from numpy.typing import ArrayLike

from fingerpad.results.quantities import in_table

Parts = Mapping[str, ArrayLike]  # a number, or the parts of a sum, shape (ridges,)

ONCE, MORE = 2.0, 1.5
"""Factors of safety on the share of a parameter that was halved once, and of one that was halved more often.

With them the estimated error covers the known one in at least 90 % of the known cases of each kind, of runs with an
accuracy, where all sizes are changed in turn. One size changed alone does not show the scatter of energy densities.
``docs/accuracy.json`` has the cases, ``benchmarks/accuracy.py`` counts them for ``docs/errors.md``, and
``tests/test_calibration.py`` holds the factors to it.
"""
TWO = 2.0
"""The same on an error from two meshes that differ in all elements; see :data:`SITES`."""
_EQUAL = 2.5  # ratio of two facets up to which they are as different as all elements
SITES = 0.5
"""Of the median relative error of the sites of a state: least one of a single site.

With :data:`TWO` and this the error covers what half of all sizes changes in all known cases of friction, contact
lengths, highest pressures and energy densities, of the last in 457 of 457, and in 411 without both; and the whole
error, of which that is a half to three quarters, in at least 95 % of each kind. These factors, and the order of the
highest pressure, were chosen on the same scenes.
``docs/two_meshes.json`` has the values on the three meshes, ``benchmarks/two_meshes.py`` counts the cases for
``docs/errors.md``, and ``tests/test_calibration.py`` holds the factors to it.
"""
RECEPTOR = 5e-6
"""Largest element (m) at a receptor site with which the error of an energy density there is estimated. The tips of the
intermediate ridges have a radius of 6 µm. With 20 µm two meshes gave too small an error in six of seven scenes, by a
factor of up to 4.1."""
FEW_FACETS = 4
"""Facets in contact on a ridge below which its length changes by accident with the mesh, and the effect of a rigid
screen is doubtful: at two or three, a few Gauss points bear the contact, and their number changes."""
ORDER = 0.75
"""In one over the stiffness, of what the penalty changes."""


@dataclass
class MeshParameter:
    """What halving one mesh parameter changed, from its first size to the one in use."""

    changes: list[dict[str, float]] = field(default_factory=list)
    """By how much each quantity changed, at each halving; magnitudes."""
    degree: int = 2
    """Polynomial degree of the elements."""

    def record(self, coarse: Parts, fine: Parts) -> None:
        """Record values before and after the next halving."""
        self.changes.append({name: _change(name, coarse[name], fine[name]) for name in coarse if name in fine})

    def acts_on(self, name: str) -> bool:
        """Return whether the parameter has a part in a quantity's error."""
        return name in self.changes[-1]

    def share(self, name: str) -> float:
        """Return the estimated part of a quantity's error that is this parameter's, at the size in use, in its unit."""
        change = self.changes[-1][name]
        if len(self.changes) > 1:
            change = max(change, self.changes[-2].get(name, 0.0) / 4)
        return change / (2 ** self.order(name) - 1)

    def order(self, name: str) -> int:
        """Return the order with which the error of a quantity falls."""
        return min(self.degree, 2) if "_sed_" in name else 1

    def safe(self, name: str) -> float:
        """Return the same with its factor of safety."""
        return self.share(name) * (ONCE if len(self.changes) == 1 else MORE)


def value(name: str, parts: ArrayLike) -> float:
    """Return a quantity from its parts of each ridge: the highest of pressures, the sum of all else."""
    return float(np.max(parts) if name.endswith("p_max") else np.sum(parts))


def _change(name: str, before: ArrayLike, now: ArrayLike) -> float:
    """Return by how much a quantity changes, or more where its parts do and the changes cancel by accident."""
    whole, parts = value(name, now) - value(name, before), np.atleast_1d(np.subtract(now, before))
    if name.endswith("p_max"):  # as those of other ridges on average, of the half that bears more
        parts = parts[np.atleast_1d(now) >= value(name, now) / 2]
        parts = parts / np.sqrt(len(parts))
    return max(abs(whole), float(np.linalg.norm(parts)))


def of_two_meshes(
    coarse: Parts,
    fine: Parts,
    facets: Mapping[str, tuple[float, float]],
    degree: int = 2,
    safety: float = TWO,
    sites: float = SITES,
    short: bool = True,
    by_area: bool = False,
) -> dict[str, float]:
    r"""Return the error of each quantity on the finer of two meshes, one with all elements twice as large, in its unit.

    .. math:: E = s \frac{|q(2h) - q(h)|}{r^p - 1}

    Lengths in contact are of first order in the facets where contact ends, and r is how much shorter these are. All
    else has r = 2 and p = 2 (1 with linear elements), and p = 3/2 for the highest pressure, which means over facets
    give. Where facets are not shorter where contact ends, friction, attraction and the bone's height have the order and
    the ratio of lengths, since they depend on the edge of contact.

    The change of a single number may come out small by accident. So the relative error at a site in the skin is at
    least a part of the median of all sites' of its state. Changes of lengths and friction of single ridges are
    independent: their root of squares counts where it is larger; of the highest pressure the root of mean squares of
    the ridges that have half of it or more.

    Args:
        coarse: values on the mesh with elements twice as large.
        fine: values on the finer one.
        facets: lengths of the facets where contact ends (m), coarse and fine, by the prefix of a state's quantities.
        degree: polynomial degree of the elements.
        safety: factor of safety s.
        sites: that part of the median.
        short: whether facets are shorter where contact ends than elsewhere.
        by_area: whether friction goes with the area in contact, and so has the order and the ratio of lengths.
    """
    lengths = ("contact_length", "f_t", "mu_app") if by_area else ("contact_length",)
    found, first_order = {}, lengths if short else tuple(in_table("edges"))
    for name in (name for name in fine if name in coarse):
        of_ends = name.endswith(first_order)
        state = next((prefix for prefix in facets if name.startswith(f"{prefix}_")), None)
        ratio = facets[state][0] / facets[state][1] if of_ends and state else 2.0
        order = 1 if of_ends else min(degree, 1.5 if name.endswith("p_max") else 2)
        found[name] = safety * _change(name, coarse[name], fine[name]) / (ratio**order - 1)
    densities = sorted(name for name in found if "_sed_" in name)
    for _, same in groupby(densities, lambda name: name.partition("_sed_")[0]):  # of one state
        names = list(same)
        values = np.array([value(name, fine[name]) for name in names])
        relative = np.array([found[name] for name in names]) / np.where(values > 0, values, np.inf)
        found |= dict(zip(names, np.maximum(relative, sites * np.median(relative)) * values, strict=True))
    return {name: float(error) for name, error in found.items()}


def of_sum(coarse: float, fine: float, facets: tuple[float, float], degree: int, length: bool) -> float:
    """Return the error of a sum over the ridges of a section by two meshes, in its unit.

    Arguments are as of :func:`of_two_meshes`; ``length`` is whether it has the order of a length in contact, else that
    of a force.
    """
    name, short = "state_contact_length" if length else "state_f_t", facets[0] > _EQUAL * facets[1]
    return of_two_meshes({name: coarse}, {name: fine}, {"state": facets}, degree, short=short)[name]


def of_two_paths(differences: Mapping[str, float], ratio: float) -> dict[str, float]:
    r"""Return the error over time of the finer of two paths, one with all elements twice as large, in the unit given.

    It is of first order, :math:`E = s \max_t |q(2h) - q(h)| / (r - 1)` with s = :data:`TWO`: the largest difference
    belongs to the time and the site at which edges between nodes matter most, of contact and of skin that sticks.

    Args:
        differences: largest difference over time by quantity.
        ratio: r, of the facets that can touch, coarse over fine.
    """
    return {name: TWO * difference / (ratio - 1) for name, difference in differences.items()}


def errors(parameters: Mapping[str, MeshParameter], names: Sequence[str]) -> dict[str, float]:
    """Return the error of each quantity, with its factors of safety, in its unit."""
    return {name: sum(each.safe(name) for each in parameters.values() if each.acts_on(name)) for name in names}


def to_refine(parameters: Mapping[str, MeshParameter], allowed: Mapping[str, float]) -> list[str]:
    """Return the names of the parameters to halve once more on the way to errors within what is allowed.

    Of each quantity that is not within it, as few as will do by their orders, those with the largest shares first, and
    none that spends no more than its equal part. Empty if every error is within what is allowed.

    Args:
        parameters: that can be halved, with what halving them changed.
        allowed: largest error of each quantity, in its unit.
    """
    found: set[str] = set()
    estimate = errors(parameters, list(allowed))
    for name, most in allowed.items():
        left = estimate[name]
        shares = {key: each.safe(name) for key, each in parameters.items() if each.acts_on(name)}
        for key in sorted(shares, key=shares.__getitem__, reverse=True):
            if left <= most or shares[key] * len(shares) <= most:
                break
            left -= shares[key] * (1 - 2 ** -parameters[key].order(name))
            found.add(key)
    return [key for key in parameters if key in found]


def rigid(values: Mapping[str, float], stiffer: Mapping[str, float]) -> dict[str, float]:
    r"""Return by how much a rigid screen would change each quantity, in its unit: the effect of a penalty.

    Springs of stiffness :math:`\epsilon` let the skin sink in by :math:`p_n / \epsilon`, which makes its contact
    longer. For an error of :math:`C \epsilon^{-p}` of a quantity, two stiffnesses on one mesh give the change by a
    rigid screen:

    .. math:: q_{rigid} - q(\epsilon) = \frac{q(2 \epsilon) - q(\epsilon)}{1 - 2^{-p}}

    The springs act over :math:`\ell = E / \epsilon` from an edge of contact, E the skin's modulus: 0.2 um by default,
    on ridges of a half-width a of some 50 um. Without attraction the length of a contact grows by some :math:`\ell
    \ln(a / \ell)`, whose order about there is :math:`1 - 1 / \ln(a / \ell) = 0.8`; of a light finger (5 N/m, 200 V,
    facets of 2.5 um) it is 0.7 from three stiffnesses, and p is :data:`ORDER`. The share is known to a factor of two
    (``docs/errors.md``). For friction, which hardly depends on the penalty, only the order of magnitude is right. On
    facets far longer than :math:`\ell` a much stiffer screen holds the skin at single Gauss points: an error of the
    mesh, and not in here.

    Nitsche's method has no such part: its conditions are exact on any mesh. An augmented Lagrangian leaves gaps of up
    to ``contact.tolerance``, negligible beside the error of the mesh.

    Args:
        values: at the stiffness in use.
        stiffer: at twice that.
    """
    return {name: (stiffer[name] - value) / (1 - 2**-ORDER) for name, value in values.items() if name in stiffer}
