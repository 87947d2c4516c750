"""Estimated discretisation errors of named states: what a result, a summary and a console have of them."""

from collections.abc import Callable, Mapping, Sequence
from contextlib import suppress
from dataclasses import fields, replace
from typing import Any

import numpy as np
from mpi4py import MPI

from fingerpad.accuracy.richardson import RECEPTOR, TWO, of_sum, of_two_meshes, rigid
from fingerpad.accuracy.states import Solve, with_values
from fingerpad.model.options import FingerModel
from fingerpad.results.quantities import QUANTITIES, Output, plus_minus
from fingerpad.results.states import WORDS
from fingerpad.scene.messages import SceneError
from variational.caution import Caution
from variational.element import ELEMENTS
from variational.state import ContactState, Errors

_SAME_VALUE = 1e-9  # relative: friction without voltage does not depend on the mesh


class Estimate:
    """Errors of named states from those on two meshes (:func:`fingerpad.accuracy.richardson.of_two_meshes`).

    Attributes:
        model: with the mesh of the path.
        found: all solves of the states, in order, the path's first.
        base: the states that the errors are of.
        coarse: the same on a coarser mesh; None where there is none.
        failure: why the accuracy asked for is not reached, else empty.
        notes: remarks on the estimate.
        penalty: change of each quantity by a rigid screen, where contact is a penalty and this is estimated.
        degree: of the elements.
    """

    def __init__(
        self, model: FingerModel, path: Solve, comm: MPI.Comm, show: Callable[[str], None] = lambda text: None
    ) -> None:
        """Begin with the states of the path; ``show`` prints a line."""
        self.model, self.base, self.found = model, path, [path]
        self._comm, self._show = comm, show
        self.coarse: Solve | None = None
        self.failure, self.notes = "", list[str]()
        self.penalty: dict[str, float] = {}
        self.degree = ELEMENTS[self.model.numerics.element].degree
        self._two: dict[str, float] = {}

    def estimates(self) -> dict[str, float]:
        """Return the estimated error of each quantity, in its unit."""
        return self._two

    def allowed(self) -> dict[str, float]:
        """Return the largest error allowed of each quantity that is asked for, in its unit."""
        return {}

    def summary(self) -> dict[str, Any]:
        """Return how errors were found, ready for JSON; collective."""
        values, found, allowed = self.base.values(), self.estimates(), self.allowed()
        shares = {name: self._shares(name, error) for name, error in found.items()}
        quantities = {
            name: {
                "value": values[name],
                "error": error,
                "estimate": sum(shares[name].values()),
                "penalty": self.penalty.get(name),
                "allowed": allowed.get(name),
                "shares": shares[name],
            }
            for name, error in found.items()
        }
        return {
            "reached": not self.failure,
            "mesh": self.base.mesh.model_dump(),
            "step_scale": self.model.numerics.step_scale,
            "quantities": quantities,
            "notes": self.notes,
            **self._cost(),
        }

    def _cost(self) -> dict[str, Any]:
        """Return what each solve and all of them took, ready for JSON; collective."""
        seconds = [float(np.sum(self._comm.allgather(solve.processor_seconds))) for solve in self.found]
        return {
            "solves": [
                {
                    "mesh": solve.mesh.model_dump(),
                    "unknowns": solve.unknowns,
                    "factorisations": solve.factorisations,
                    "processor_seconds": spent,
                }
                for solve, spent in zip(self.found, seconds, strict=True)
            ],
            "factorisations": sum(solve.factorisations for solve in self.found),
            "unknowns_times_factorisations": sum(s.unknowns * s.factorisations for s in self.found),
            "processor_seconds": sum(seconds),
        }

    def doubts(self) -> list[Caution]:
        """Return which states roundoff may have chosen among others."""
        return [Caution("roundoff", each) for solve in self.found for each in solve.doubts]

    def compare(self, coarse: Solve, fine: Solve, short: bool = True) -> None:
        """Take the errors of states from two meshes, of which the coarser has elements twice as large.

        Args:
            coarse: states on the coarser mesh.
            fine: states on the finer one.
            short: whether its facets are shorter where their contact ends.
        """
        facets = {
            name: (coarse.states[name].facet, state.facet)
            for name, state in fine.states.items()
            if name in coarse.states
        }
        parts = fine.parts()
        if fine.mesh.receptor > RECEPTOR:  # of densities there is no estimate
            parts = {name: part for name, part in parts.items() if "_sed_" not in name}
        law = self.model.friction
        by_area = law is not None and law.by_area
        self._two = of_two_meshes(coarse.parts(), parts, facets, self.degree, short=short, by_area=by_area)
        self.base, self.coarse = fine, coarse

    def _shares(self, name: str, error: float) -> dict[str, float]:
        """Return the parts of a quantity's estimate, without factors of safety, by mesh parameter."""
        return {"mesh": error / TWO}

    def _note(self, text: str) -> None:
        self.notes.append(text)
        self._show(text)

    def _report(self) -> None:
        """Print the values of the states with their errors."""
        values, found, allowed = self.base.values(), self.estimates(), self.allowed()
        for name, error in found.items():
            if "_sed_" in name or error <= _SAME_VALUE * abs(values[name]):
                continue
            quantity, words = of_key(name)
            limit = f", {allowed[name] * quantity.scale:.2g} allowed" if name in allowed else ""
            number = f"{plus_minus(values[name] * quantity.scale, error * quantity.scale)} {quantity.unit}".rstrip()
            self._show(f"{words}: {number} (estimated discretisation error){limit}")


def with_errors(
    estimate: Estimate, path: Mapping[str, ContactState], outputs: Sequence[Output] = ()
) -> dict[str, ContactState]:
    """Return the named states of a path with their results on the final mesh, and their errors.

    Args:
        estimate: of the path's states.
        path: the states by name, as the path has them.
        outputs: computed from each state, whose errors come from the same two meshes.
    """
    estimates, found = estimate.estimates(), dict(path)
    for name, kept in estimate.base.states.items():
        if name in found:
            mesh, penalty = (_errors_of(name, each) for each in (estimates, estimate.penalty))
            whole = {key: value + abs(penalty.get(key, 0.0)) for key, value in mesh.items()}
            own, springs = _of_outputs(estimate, name, outputs)
            error = whole | {key: value + abs(springs.get(key, 0.0)) for key, value in own.items()}
            state = with_values(found[name], kept)
            found[name] = replace(state, error=Errors.of(error), penalty=Errors.of(penalty | springs))
    if {"uncharged", "charged"} <= set(found) and path["uncharged"].step == path["charged"].step:  # at 0 V one state
        found["uncharged"] = found["charged"]
    return found


def _of_outputs(estimate: Estimate, name: str, outputs: Sequence[Output]) -> tuple[dict[str, float], dict[str, float]]:
    """Return the errors of outputs in a state by two meshes, and the changes by a rigid screen, by name.

    One with a rule of sums has the order of the forces, or of the contact length; another one is of first order.
    One that is not computed from the forces, ridges and sites of a state alone has no error.
    """
    base, mesh, penalty = estimate.base, dict[str, float](), dict[str, float]()
    now = base.states[name]
    before = None if estimate.coarse is None else estimate.coarse.states.get(name)
    stiff = None if base.stiffer is None else base.stiffer.states.get(name)
    ratio = 1.0 if estimate.coarse is None else estimate.coarse.mesh.contact / base.mesh.contact
    for each in outputs:
        with suppress(SceneError):
            if before is not None and ratio > 1:
                values, facets = (each.of(before.state), each.of(now.state)), (before.facet, now.facet)
                mesh[each.name] = TWO * abs(values[1] - values[0]) / (ratio - 1)
                if each.sum:
                    mesh[each.name] = of_sum(*values, facets, estimate.degree, each.si == "m")
            if each.sum and estimate.penalty and stiff is not None:
                penalty |= rigid({each.name: each.of(now.state)}, {each.name: each.of(stiff.state)})
    return mesh, penalty


def _errors_of(name: str, changes: Mapping[str, float]) -> dict[str, float]:
    """Return the changes of a named state's quantities, of those by key; densities at receptors are left out."""
    known = {field.name for field in fields(Errors)}
    return {k: v for key, v in changes.items() if (k := key.removeprefix(f"{name}_")) in known and k != key}


def of_key(key: str) -> tuple[Output, str]:
    """Return the quantity of a key such as ``full_slip_mu_app``, and the key in words: quantity and state."""
    state = next(name for name in WORDS if key.startswith(f"{name}_"))
    quantity = QUANTITIES[key.removeprefix(f"{state}_")]
    return quantity, f"{quantity.words} at {WORDS[state]}"
