"""What a path's solves left, in order: those of an earlier run of the scene first, in place of solving, then new ones.

A run is determined by the outcomes of its solves (:mod:`variational.solvers.outcome`) and of its examinations of
stability. A run that resumes goes through its loads from the first, takes each outcome from the checkpoint while there
is one, and writes all its tables anew; where the outcomes end it solves. At the end of a part of the checkpoint a run
forgets the factorisation that it would keep, which the run that resumes does not have: on one rank, both go on the
same to the last bit.
"""

from collections.abc import Iterator
from functools import partial

from mpi4py import MPI

from fingerpad.io.checkpoint import Arrays, Checkpoint, CheckpointError
from variational.solvers.continuation import Continuation
from variational.solvers.failure import NotConverged
from variational.solvers.outcome import OtherBody, Outcome, Taken
from variational.solvers.stability import Stability, StabilityCheck

_STEPS = 5  # accepted steps a part, at most
_BODY = "body/"  # beginning of the names of places


class Journal:
    """Outcomes of one run, kept in a checkpoint.

    Attributes:
        parts: number of the checkpoint's parts.
        seconds: wall time and processor time (s) of earlier runs.
    """

    def __init__(self, comm: MPI.Comm, checkpoint: Checkpoint, resume: bool) -> None:
        """Begin; collective.

        Args:
            comm: communicator of the run.
            checkpoint: where outcomes are kept.
            resume: go on from what is there.

        Raises:
            CheckpointError: the run cannot go on from there; on every rank.
        """
        self._comm, self._checkpoint = comm, checkpoint
        self._bodies: list[tuple[Continuation, Taken | None]] = []
        self._places: dict[int, Arrays] = {}  # of earlier runs' bodies, on rank 0
        self._new: list[Outcome] = []  # of the present part, whole on rank 0
        self._new_places: Arrays = {}
        self.parts, self._steps = 0, 0
        refusal: str | None = None
        if comm.rank == 0 and resume:
            try:
                checkpoint.check()
            except CheckpointError as error:
                refusal = str(error)
            else:
                self.parts = checkpoint.count()
        refusal, self.parts = comm.bcast((refusal, self.parts))
        if refusal is not None:
            raise CheckpointError(refusal)
        self._again = self.parts > 0  # whether outcomes of earlier runs may be left
        self._earlier = self._read() if comm.rank == 0 else iter(())
        self.seconds = (0.0, 0.0)
        if self._again:
            self.seconds = comm.bcast(checkpoint.read(self.parts)[0]["seconds"] if comm.rank == 0 else None)

    # -- solving -----------------------------------------------------------------------------------------
    def follow(self, path: Continuation) -> None:
        """Keep what a path's solves leave; the bodies of a run come in the same order each time."""
        number = len(self._bodies)
        self._bodies.append((path, None))
        path.solve = partial(self._solve, number)

    def _solve(self, number: int, pseudo_transient: bool) -> None:
        """Solve, or take the outcome from the checkpoint; collective.

        Raises:
            NotConverged: no equilibrium was found.
        """
        kept = self._next()
        taken = self._taken(number, kept is not None)
        if kept is not None:
            taken.put(kept)
            return
        outcome = taken.solve(pseudo_transient)
        self._new.append(outcome)
        if outcome.facts["failure"] is not None:
            reason, *flags = outcome.facts["failure"]
            raise NotConverged(reason, *flags)

    def _taken(self, number: int, kept: bool) -> Taken:
        path, taken = self._bodies[number]
        if taken is None:
            places = self._comm.bcast(self._places.get(number)) if kept else None
            try:
                taken = Taken(path.coupling, places)
            except OtherBody as error:
                raise CheckpointError(f"the checkpoint is of another mesh: {error}") from error
            self._bodies[number] = path, taken
            if not kept and self._comm.rank == 0:
                self._new_places |= {f"{_BODY}{number}/{name}": values for name, values in taken.places.items()}
        return taken

    def examine(self, check: StabilityCheck) -> Stability:
        """Examine a state's stability, or take the verdict from the checkpoint; collective.

        Raises:
            NotConverged: the factorisation failed.
        """
        kept = self._next()
        counts = check.solver.counts
        if kept is not None:
            counts.factorisations += kept.facts["factorisations"]
            return Stability(*kept.facts["stability"])
        before = counts.factorisations
        found = check.check()
        verdict = [found.lambda_min, found.settled]
        self._new.append(Outcome({"stability": verdict, "factorisations": counts.factorisations - before}))
        return found

    def _next(self) -> Outcome | None:
        """Return the next outcome of earlier runs on every rank, None where there is none; collective."""
        if not self._again:
            return None
        kept = self._comm.bcast(next(self._earlier, None))
        self._again = kept is not None
        return kept

    def _read(self) -> Iterator[Outcome]:
        """Return the outcomes of earlier runs, on rank 0."""
        for number in range(1, self.parts + 1):
            facts, arrays = self._checkpoint.read(number)
            for name in [name for name in arrays if name.startswith(_BODY)]:
                body, _, kind = name.removeprefix(_BODY).partition("/")
                self._places.setdefault(int(body), {})[kind] = arrays.pop(name)
            for k, each in enumerate(facts["outcomes"]):
                mine = [name for name in arrays if name.startswith(f"{k}/")]
                yield Outcome(each, {name.partition("/")[2]: arrays.pop(name) for name in mine})

    # -- keeping -----------------------------------------------------------------------------------------
    def accepted(self, seconds: tuple[float, float]) -> None:
        """Count an accepted step and end a part now and then; collective; ``seconds`` as for :meth:`keep`."""
        self._steps += 1
        if self._steps >= _STEPS:
            self.keep(seconds)

    def keep(self, seconds: tuple[float, float]) -> None:
        """End a part of the checkpoint; collective.

        Args:
            seconds: wall time and processor time until now (s), of earlier runs too.
        """
        for _, taken in self._bodies:
            if taken is not None:
                taken.forget()
        self._steps = 0
        if not self._new:
            return
        self.parts += 1
        if self._comm.rank == 0:
            arrays = {f"{k}/{name}": value for k, each in enumerate(self._new) for name, value in each.arrays.items()}
            facts = {"outcomes": [each.facts for each in self._new], "seconds": seconds}
            self._checkpoint.write(self.parts, facts, arrays | self._new_places)
        self._new, self._new_places = [], {}

    def end(self) -> None:
        """Delete the checkpoint of a run that has reached its end; collective."""
        if self._comm.rank == 0:
            self._checkpoint.delete()
