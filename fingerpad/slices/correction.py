r"""A trace followed on coarse elements, corrected by some of its states solved for again on finer ones.

Where a force is prescribed, an error of the mesh changes indentation, attraction, contact length, gross width, and
friction over contact force by a few per cent, and by about as much at neighbouring forces. So each of these is
multiplied by the ratio r of its values on the fine and the coarse mesh. Between the forces :math:`f_k` of the states
that are known on both, r is linear in the logarithm of the force; beyond them it is constant. Three errors are left:

* of the *mesh*: that of the section on the fine one, from the two meshes
  (:func:`fingerpad.accuracy.richardson.of_two_meshes`), at the largest force that is known on both; it is carried over
  to the sum,
* of the *penalty*: what a rigid screen would change of that state, carried over as well,
* of the *correction*: the largest change of the sum over the slices without one of the ratios but the last, or, with a
  single ratio, without a correction.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fingerpad.accuracy.richardson import of_sum, of_two_meshes, rigid
from fingerpad.results.quantities import FRICTION, Output
from fingerpad.slices.total import AREAS, Profile, at_force
from fingerpad.slices.trace import NAMES, Trace, borne, columns
from variational.state import ContactState

_SUMS = {AREAS.get(name, name): name for name in NAMES if name not in ("f_ext", "f_t")}
_SCALED = ("|bone_height|", *_SUMS.values(), "f_t/f_c")
_OF_SUM = {**_SUMS, "indentation": "|bone_height|", **dict.fromkeys(FRICTION, "f_t")}
"""Names of a sum's quantities, and of the section's value whose relative error each has."""
_SECTION = "section_"
_NO_FRICTION = 1e-9  # of the contact force: sideways forces of normal contact are below


@dataclass(frozen=True)
class Pair:
    """A state on the trace's mesh, and under the same force on the fine one."""

    coarse: ContactState
    fine: ContactState
    facets: tuple[float, float]
    """Lengths of the facets where its contact ends (m), on the trace's mesh and on the fine one."""


def corrected(trace: Trace, pairs: Sequence[Pair], wavelength: float) -> Trace:
    """Return a trace on the coarse mesh as on the fine one, by pairs of its states at growing forces."""
    coarse, fine = (
        _values([getattr(pair, which) for pair in pairs], wavelength, trace.own) for which in ("coarse", "fine")
    )
    own = [each for each in trace.own if each.name in coarse and each.name in fine]
    force, at = np.log(trace.columns["f_ext"]), np.log([pair.coarse.f_ext for pair in pairs])
    ratio = {
        name: np.interp(force, at, _ratio(fine[name], coarse[name]))
        for name in (*_SCALED, *(each.name for each in own))
    }
    found = {name: values * ratio.get(name, 1.0) for name, values in trace.columns.items() if name in coarse}
    found["f_t"] = ratio["f_t/f_c"] * trace.columns["f_t"] / borne(trace.columns) * borne(found)
    return Trace(trace.depth * ratio["|bone_height|"], found, trace.ridges, tuple(own))


def mesh_errors(pair: Pair, wavelength: float, degree: int = 2, own: Sequence[Output] = ()) -> dict[str, float]:
    """Return the relative errors of a sum by the fine mesh, those of the section, by the sum's quantities.

    Args:
        pair: the section on both meshes.
        wavelength: of a ridge (m).
        degree: polynomial degree of the elements.
        own: outputs that are summed.
    """
    coarse, fine = (_parts(state, wavelength) for state in (pair.coarse, pair.fine))
    found = of_two_meshes(coarse, fine, {_SECTION[:-1]: pair.facets}, degree)
    values = {name: float(np.sum(fine[_SECTION + of])) for name, of in _OF_SUM.items()}
    known = {name: found[_SECTION + _OF_SUM[name]] / value for name, value in values.items() if value}
    ends = {each: (each.of(pair.coarse), each.of(pair.fine)) for each in own}
    errors = {each: of_sum(*both, pair.facets, degree, each.si == "m") for each, both in ends.items()}
    return known | {each.name: errors[each] / abs(value) for each, (_, value) in ends.items() if value}


def penalty_errors(
    state: ContactState, stiffer: ContactState, wavelength: float, own: Sequence[Output] = ()
) -> dict[str, float]:
    """Return the relative changes of a sum by a rigid screen, those of the section, by the sum's quantities.

    Args:
        state: on the fine mesh.
        stiffer: the same over a screen of twice the stiffness (:func:`fingerpad.accuracy.richardson.rigid`).
        wavelength: of a ridge (m).
        own: outputs that are summed.
    """
    value, over = ({of: float(each[0]) for of, each in _values([s], wavelength, own).items()} for s in (state, stiffer))
    change, names = rigid(value, over), _OF_SUM | {each.name: each.name for each in own}
    return {name: abs(change[of] / value[of]) for name, of in names.items() if of in change and value[of]}


def correction_errors(
    finger: Profile, trace: Trace, pairs: Sequence[Pair], wavelength: float, force: float, count: int
) -> dict[str, float]:
    """Return the relative errors of a sum by the ratios between the states that are known on both meshes.

    The trace is on the coarse mesh, ``pairs`` as of :func:`corrected`, all else as of
    :func:`fingerpad.slices.total.at_force`.
    """
    less = [[*pairs[:k], *pairs[k + 1 :]] for k in range(len(pairs) - 1)]
    other = [corrected(trace, each, wavelength) for each in less] or [trace]
    value, *others = (
        at_force(finger, each, force, count).values for each in (corrected(trace, pairs, wavelength), *other)
    )
    names = sorted({*value} - {"f_ext"})
    return {name: max(abs(o[name] / value[name] - 1) for o in others) for name in names if value[name]}


def _values(states: Sequence[ContactState], wavelength: float, own: Sequence[Output] = ()) -> dict[str, np.ndarray]:
    """Return what is scaled of states, shape (states,)."""
    found = columns(states, wavelength, own)
    depth, bears = np.array([-state.bone_height for state in states]), borne(found)
    f_t = np.where(found["f_t"] > _NO_FRICTION * bears, found["f_t"], 0.0)
    return found | {"|bone_height|": depth, "f_t": f_t, "f_t/f_c": f_t / bears}


def _parts(state: ContactState, wavelength: float) -> Mapping[str, np.ndarray]:
    """Return the values of a state, its contact length by ridge."""
    found = _values([state], wavelength)
    if state.ridges is not None:
        found["contact_length"] = np.asarray(state.ridges.length)
    return {_SECTION + name: value for name, value in found.items()}


def _ratio(fine: np.ndarray, coarse: np.ndarray) -> np.ndarray:
    return np.divide(fine, coarse, out=np.ones_like(fine), where=coarse != 0)
