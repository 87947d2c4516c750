"""The whole finger of a result: newtons and square millimetres by named state, their errors, and their source."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from types import SimpleNamespace

from fingerpad import notebook
from fingerpad.results.quantities import FINGER, FRICTION, MODEL, Output, plus_minus_of
from fingerpad.results.states import STATES, WORDS, called
from fingerpad.scene.parameters import Slices
from fingerpad.slices import errors
from fingerpad.slices.total import RATIOS, Total, profile
from fingerpad.slices.trace import Trace

_PARTS = errors.MESH, errors.ESTIMATED, errors.COARSE
_TITLE = "Whole finger, as a sum of slices"


@dataclass(frozen=True, eq=False, repr=False)
class WholeFinger:
    """A whole finger under one force in its named states; SI units."""

    states: dict[str, Total]
    """By the names of :data:`fingerpad.results.states.STATES`; those that are known."""
    source: str
    """Where the traces of the cross-section come from, for a reader."""
    carried: dict[str, dict[str, dict[str, float]]] = field(default_factory=dict)
    """Relative errors by state, part and quantity that no trace gives: of the cross-section's mesh and penalty, of a
    run's estimate (:mod:`fingerpad.slices.errors`), and of a cheaper model, of which an empty part is not known."""
    traces: Mapping[str, Trace] = field(default_factory=dict)
    """Of the cross-section by state."""
    shape: Slices = Slices()
    """The finger along its axis."""

    @property
    def f_ext(self) -> float:
        """External force (N)."""
        return next(iter(self.states.values())).totals["f_ext"]

    @property
    def quantities(self) -> dict[str, Output]:
        """Quantities of the whole finger by name: those of all fingers, and sums of outputs of one's own."""
        return FINGER | {each.name: each.whole for trace in self.traces.values() for each in trace.own}

    def missing(self, outputs: Iterable[Output]) -> list[str]:
        """Return why outputs with a rule of sums have no value in a state, a sentence each."""
        lacking = {
            each.name: [WORDS[name] for name, total in self.states.items() if each.name not in total.columns]
            for each in outputs
            if each.sum
        }
        return [
            f"The output {name} has no value for the whole finger in {', '.join(words)}: states of the slices have no "
            "skin and may have no ridges, its function fails on one of them, or values have both signs."
            for name, words in lacking.items()
            if words
        ]

    @cached_property
    def error(self) -> dict[str, dict[str, float]]:
        """Whole known errors by state and quantity: those carried over, and that of the interpolation of the traces."""
        finger, found = profile(self.shape), {}
        for name, total in self.states.items():
            between = {}
            if name in self.traces:
                between = errors.interpolation(finger, self.traces[name], total, self.shape.count)
            carried = self.carried.get(name, {})
            shares = errors.add(*carried.values(), between)
            known = carried.get(MODEL, shares)  # of a cheaper model nothing is known where its distance is not
            parts = [each for part in _PARTS if (each := carried.get(part))]  # an output of one's own has all or none
            there = {key for key in known if key in FINGER or all(key in each for each in parts)}
            pairs = {key: pair for key, pair in RATIOS.items() if {*pair} <= there}
            shares |= {key: sum(shares[each] for each in pair) for key, pair in pairs.items()}
            there = there - {*RATIOS} | {*pairs}
            found[name] = {key: abs(share * total.values[key]) for key, share in shares.items() if key in there}
        return found

    def values(self, name: str) -> dict[str, float]:
        """Return the quantities of a state: N, m², m, and the apparent friction coefficient."""
        return self.states[name].values

    def __getattr__(self, name: str) -> SimpleNamespace | None:
        """Return a named state with its quantities as attributes, as a result has it: ``full_slip.f_t``, in N.

        Its ``error`` has theirs. None where the finger does not have the state.
        """
        if name not in STATES:
            raise AttributeError(f"a whole finger has no {name!r}")
        if name not in self.states:
            return None
        return SimpleNamespace(**self.values(name), error=SimpleNamespace(**self.error[name]))

    def flat(self) -> dict[str, float]:
        """Return all quantities and their errors by name, such as ``full_slip_finger_f_t``; SI units."""
        found = dict[str, float]()
        for name in self.states:
            start, error = f"{name}_finger_", self.error[name]
            found |= {f"{start}{key}": value for key, value in self.values(name).items()}
            found |= {f"{start}{key}_error": value for key, value in error.items()}
        return found

    def rows(self) -> Iterator[list[str]]:
        """Yield the quantities with unit, and their values in each state with the error."""
        for key, quantity in self.quantities.items():
            friction = key in FRICTION
            known = [n for n in self.states if key in self.values(n) and (not friction or n == "full_slip")]
            cells = [self.shown(name, key) if name in known else "–" for name in self.states]
            if set(cells) - {"–"}:
                yield [quantity.title, *cells]

    def shown(self, name: str, key: str) -> str:
        """Return a quantity of a state in the unit of tables, with its error where the error reaches the digits."""
        return self.quantities[key].shown(self.values(name)[key], self.error.get(name, {}).get(key))

    def heads(self) -> list[str]:
        """Return the words of the states."""
        return [called(name, total.totals["f_electrostatic"]) for name, total in self.states.items()]

    def parts(self, *names: str) -> tuple[str, ...]:
        """Return what the errors of states are made of; of all states by default."""
        every = (self.carried.get(name, {}) for name in names or self.states)
        parts = dict.fromkeys(part for each in every for part, known in each.items() if known or part == MODEL)
        return tuple(dict.fromkeys([*parts, *[errors.POINTS] * bool(self.traces)]))

    def remarks(self) -> list[str]:
        """Return what a reader of the numbers must be told."""
        known = plus_minus_of(self.parts()) * any(map(any, (each.values() for each in self.error.values())))
        return [*filter(None, [known]), *errors.remarks([self.f_ext]), f"Slices: {self.source}."]

    def __str__(self) -> str:
        """Return the text *Whole finger* at the end of a run: the states side by side."""
        lines = notebook.side_by_side([*notebook.head_rows(self.heads()), *self.rows()])
        return "\n".join([_TITLE, *lines, *(f"  {each}" for each in self.remarks())])

    __repr__ = __str__
    """In a console, too: the values of all slices are many pages."""

    def _repr_html_(self) -> str:
        """Return the text for a notebook."""
        return notebook.page(
            _TITLE, notebook.table(["", *self.heads()], self.rows()), notebook.folded("Remarks", self.remarks())
        )


def in_order(states: Mapping[str, Total]) -> dict[str, Total]:
    """Return states in the order of :data:`fingerpad.results.states.STATES`."""
    return {name: states[name] for name in STATES if name in states}
