r"""A trace followed on coarse elements, corrected by some of its states solved for again on finer ones.

Where a force is prescribed, an error of the mesh changes indentation, attraction, contact length, gross width, and
friction over contact force by a few per cent, and by about as much at neighbouring forces. So each of these is
multiplied by the ratio r of its values on the fine and the coarse mesh. Between the forces :math:`f_k` of the states
that are known on both, r is linear in the logarithm of the force; beyond them it is constant. Two errors are left:

* of the *mesh*: that of the section on the fine one, by :mod:`fingerpad.richardson` for one halving of all sizes, at
  the largest force that is known on both; it is carried over to the sum,
* of the *correction*: what the sum over the slices changes with the ratio at the largest force alone, or, where no
  other one is known, without a correction.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from fingerpad.richardson import MeshParameter
from fingerpad.slices.total import TOTALS, Profile, at_force
from fingerpad.slices.trace import Trace, columns
from variational.state import ContactState

_SCALED = ("depth", "f_electrostatic", "contact_length", "gross_width", "grip")
_SUMS = {"f_electrostatic": "f_electrostatic", "contact_area": "contact_length", "gross_area": "gross_width"}
_OF_SUM = {**_SUMS, "indentation": "depth", "f_t": "f_t", "mu_app": "f_t"}
"""Names of a sum's quantities, and of the section's value whose relative error each has."""
_ROUNDOFF = 1e-9  # of the contact force: sideways forces of normal contact are below


@dataclass(frozen=True)
class Pair:
    """A state on the trace's mesh, and under the same force on the fine one."""

    coarse: ContactState
    fine: ContactState


def corrected(trace: Trace, pairs: Sequence[Pair], wavelength: float) -> Trace:
    """Return a trace as on the fine mesh.

    Args:
        trace: on the coarse mesh.
        pairs: states of the trace on both, at growing forces.
        wavelength: of a ridge (m).
    """
    coarse, fine = (_values([getattr(pair, which) for pair in pairs], wavelength) for which in ("coarse", "fine"))
    force, at = np.log(trace.columns["f_ext"]), np.log([pair.coarse.f_ext for pair in pairs])
    ratio = {name: np.interp(force, at, _ratio(fine[name], coarse[name])) for name in _SCALED}
    found = {name: values * ratio.get(name, 1.0) for name, values in trace.columns.items()}
    borne = trace.columns["f_ext"] + trace.columns["f_electrostatic"]
    grip = ratio["grip"] * trace.columns["f_t"] / borne
    return Trace(trace.depth * ratio["depth"], found | {"f_t": grip * (found["f_ext"] + found["f_electrostatic"])})


def mesh_errors(pair: Pair, wavelength: float) -> dict[str, float]:
    """Return the relative errors of a sum by the fine mesh, those of the section, by the sum's quantities."""
    coarse, fine = (_parts(state, wavelength) for state in (pair.coarse, pair.fine))
    parameter = MeshParameter()
    parameter.record(coarse, fine)
    values = {name: float(np.sum(fine[of])) for name, of in _OF_SUM.items()}
    return {name: parameter.safe(_OF_SUM[name]) / value for name, value in values.items() if value}


def correction_errors(
    finger: Profile, trace: Trace, pairs: Sequence[Pair], wavelength: float, force: float, count: int
) -> dict[str, float]:
    """Return the relative errors of a sum by the ratios between the states that are known on both meshes.

    Args:
        finger: along its axis.
        trace: on the coarse mesh.
        pairs: states of the trace on both, at growing forces.
        wavelength: of a ridge (m).
        force: on the finger (N).
        count: slices in each stretch of contact.
    """
    less = corrected(trace, pairs[-1:], wavelength) if len(pairs) > 1 else trace
    found = [at_force(finger, each, force, count).values for each in (corrected(trace, pairs, wavelength), less)]
    names = {*TOTALS, "mu_app", "indentation"} - {"f_ext"}
    return {name: abs(found[1][name] / found[0][name] - 1) for name in sorted(names) if found[0][name]}


def _values(states: Sequence[ContactState], wavelength: float) -> dict[str, np.ndarray]:
    """Return what is scaled of states, shape (states,)."""
    found = columns(states, wavelength)
    depth, borne = np.array([-state.bone_height for state in states]), found["f_ext"] + found["f_electrostatic"]
    f_t = np.where(found["f_t"] > _ROUNDOFF * borne, found["f_t"], 0.0)
    return found | {"depth": depth, "f_t": f_t, "grip": f_t / borne}


def _parts(state: ContactState, wavelength: float) -> Mapping[str, np.ndarray]:
    """Return the values of a state, its contact length by ridge."""
    found = _values([state], wavelength)
    if state.ridges is not None:
        found["contact_length"] = np.asarray(state.ridges.length)
    return found


def _ratio(fine: np.ndarray, coarse: np.ndarray) -> np.ndarray:
    return np.divide(fine, coarse, out=np.ones_like(fine), where=coarse > 0)
