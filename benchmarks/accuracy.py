"""Does the error estimate find the error, and is the accuracy asked for the one that is got?

environment/run python3 benchmarks/accuracy.py [--jobs 2] [--draw]

Whole loops: scenes of which an accuracy is asked, ten of them drawn at random (benchmarks/untuned.py), run as a user
would, against what their states tend to on meshes refined further (benchmarks/limits.py). Beneath them the estimate by
itself (benchmarks/effectivity.py), whose runs benchmarks/errors.py makes. Writes docs/accuracy.md.
"""

import sys
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from benchmarks import arguments, calibration, limits, untuned
from benchmarks.convergence import Limit
from benchmarks.effectivity import HIGH, LOW, cell, hertz_table, knob_tables, tally
from benchmarks.errors import DEFAULT, LEVELS, folder_of_limits
from fingerpad.io.files import replace
from fingerpad.io.states import WORDS
from fingerpad.runs.batch import result, sweep
from fingerpad.scene import Scene

_STATES = {"press": WORDS["uncharged"], "normal": WORDS["charged"], "slip": WORDS["full_slip"]}
_SHORT = {"mu_app": "µ_app", "contact_length": "contact length", "sed": "SED"}
_CHOSEN = ("contact", "growth", "receptor")
_TEN = {"mu_app": 0.01, "contact_length": 0.03}
_SITES = {"sed": 0.05}
_DEFAULT = ({"mu_app": 0.01}, _TEN, {"contact_length": 0.01}, _SITES)  # asked of the default scene
_LIMIT = 7200.0  # s of processor time for one scene
_HEADER = f"""# Does the error estimate find the error?

Made by `environment/run python3 benchmarks/accuracy.py`; do not edit. *Estimate*: what the run estimates of its own
discretisation error, without the factors of safety with which it prints and refines (last section). *Error*: the
distance from the limit, over the same screen: the penalty's share is no part of it. *Effectivity*: estimate over error,
wanted between {LOW:g} and {HIGH:g}; one in brackets is of an error below its own bar, which says nothing. Numbers are
per cent of the limit."""
_LOOPS = """## Accuracy asked for

The default scene as it is comes with its estimate from coarser meshes, as every run does. Each other scene is run with
an `[accuracy]` and nothing else about its mesh but which ridges can touch, by the rule of thumb of
`fingerpad/model/touching.py`, as in all benchmarks. The limit is that of its states solved again on meshes of one
family down to a contact size of 1.25 µm, with its error bar. Cost: all factorisations × unknowns (path, estimate, and
coarser paths that were lost), over those of the default scene's whole run on its own mesh. Ten scenes were drawn at
random from a quarter about the default finger's lengths, materials and roughness (one seed, `benchmarks/untuned.py`),
and each is asked twice: for friction and contact length, and for energy densities. *Likely*: the error is within what
was allowed, but not by its bar; counted as met. Runs are kept, so that a cost is that of the version which ran it: most
states were carried from mesh to mesh before their skin was put down to the screen (`variational/solvers/transfer.py`),
and all before bodies were settled under their skin (`variational/solvers/continuation.py`). What was asked for had to
be met by the estimate alone then; it is now by the estimate with its factors of safety, so that the same scene may be
refined further."""


@dataclass(frozen=True)
class Judged:
    """A quantity of a run with an accuracy, against its limit; all but the name relative to the limit."""

    name: str
    allowed: float | None
    estimate: float
    error: float
    bar: float

    @property
    def met(self) -> str:
        """Whether the error is within what was allowed; ``likely`` if its bar leaves that open, empty if none was."""
        if self.allowed is None:
            return ""
        if self.error > self.allowed:
            return "no"
        return "yes" if self.error + self.bar <= self.allowed else "likely"

    @property
    def effectivity(self) -> float:
        """Estimate over error."""
        return self.estimate / self.error if self.error else float("inf")


def judged(summary: Mapping[str, Any], ends: Mapping[str, Limit]) -> list[Judged]:
    """Return the quantities of friction and contact, and the worst energy density of a state.

    The latter not where an accuracy was asked for, but not of energy densities: their sites are coarse then.
    """
    found, quantities = [], summary["accuracy"]["quantities"]
    asked = any(q["allowed"] is not None for q in quantities.values())
    for name, q in quantities.items():
        if name not in ends or name == "slip_f_t" or ("_sed_" in name and asked and q["allowed"] is None):
            continue
        end = ends[name]
        of = abs(end.value)
        if "_sed_" in name:  # over the largest
            sites = f"{name.split('_')[0]}_sed_"
            of = max(abs(each.value) for other, each in ends.items() if other.startswith(sites))
        allowed = None if q["allowed"] is None else q["allowed"] / of
        estimate = q.get("estimate", q["error"])  # runs from before there were factors of safety have the error alone
        found.append(Judged(name, allowed, estimate / of, abs(q["value"] - end.value) / of, end.bar / of))
    worst = list[Judged]()
    for state in _STATES:
        there = [row for row in found if row.name.startswith(f"{state}_sed_")]
        worst += sorted(there, key=lambda row: row.error)[-1:]
    return [row for row in found if "_sed_" not in row.name or row in worst]


def spent(summary: Mapping[str, Any]) -> tuple[float, float]:
    """Return factorisations times unknowns, and processor time (s), of all solves and of the runs before a restart."""
    a, lost = summary["accuracy"], summary.get("restarts", [])
    work = a["unknowns_times_factorisations"] + sum(start["unknowns"] * start["factorisations"] for start in lost)
    return work, a["processor_seconds"] + sum(start["processor_seconds"] for start in lost)


def of_default() -> dict[str, Scene]:
    """Return the default scene with the accuracies that are asked of it, by name."""
    return {_words(asked): untuned.asked(DEFAULT, **asked) for asked in _DEFAULT}


def loops() -> dict[str, tuple[Scene, Scene]]:
    """Return by name the scenes with an accuracy, and without as their limits are of."""
    found = {"default scene as it is": (DEFAULT, DEFAULT)}
    found |= {f"default scene, {asked}": (scene, DEFAULT) for asked, scene in of_default().items()}
    for asked in (_TEN, _SITES):
        for name, scene in untuned.scenes().items():
            found[f"{name}; {_words(asked)}"] = (untuned.asked(scene, **asked), scene)
    return found


def _asked(scene: Scene) -> str:
    return "" if scene.accuracy is None else _words(scene.accuracy.tolerances())


def _words(asked: Mapping[str, float]) -> str:
    return ", ".join(f"{_SHORT[name]} {100 * value:g} %" for name, value in asked.items())


def _known(plain: Scene, out: Path) -> dict[str, Any] | None:
    return limits.kept(plain, LEVELS, folder_of_limits(out))


def loop_tables(out: Path) -> str:
    """Return the tables of the scenes with an accuracy."""
    base = result(DEFAULT, out)
    whole = None if base is None else base["unknowns"] * base["factorisations"]
    lines = ["| scene | quantity | allowed (%) | estimate (%) | error (%) | effectivity | met |", "|---" * 7 + "|"]
    costs = ["| scene | contact (µm) | growth | sites (µm) | unknowns | solves | cost |", "|---" * 7 + "|"]
    coarser = list[str]()  # whose limit is of fewer meshes
    met, effectivities, asked_for = dict[str, list[bool]](), list[float](), list[float]()
    for name, (scene, plain) in loops().items():
        summary, known = result(scene, out), _known(plain, out)
        if summary is None or known is None:
            words = "not run yet" if summary is None else "its limit is not known"
            lines.append(f"| {name} | {words} |" + " |" * 5)
            continue
        if "accuracy" not in summary or "failure" in summary:
            lines.append(f"| {name} | {summary.get('failure', 'comes without an estimate')} |" + " |" * 4 + " no |")
            if plain != DEFAULT:
                met.setdefault(_asked(scene), []).append(False)
            continue
        coarser += [name] if len(known["levels"]) < LEVELS else []
        rows = judged(summary, limits.limits(known))
        good = [row.met != "no" for row in rows if row.met]
        if plain != DEFAULT:
            met.setdefault(_asked(scene), []).append(all(good))
        for row in rows:
            clear = row.error > row.bar
            effectivities += [row.effectivity] if clear else []
            asked_for += [row.effectivity] if clear and row.met else []
            allowed = "" if row.allowed is None else f"{100 * row.allowed:.2g}"
            error = f"{100 * row.error:.2g} ± {100 * row.bar:.1g}"
            cells = [name, _title(row.name), allowed, f"{100 * row.estimate:.2g}", error]
            cells += [cell(row.effectivity, clear), row.met]
            lines.append("| " + " | ".join(cells) + " |")
        a = summary["accuracy"]
        cost = f"{spent(summary)[0] / whole:.2f}" if whole else "–"
        sizes = [f"{a['mesh'][s] * 1e6:g}" if s != "growth" else f"{a['mesh'][s]:g}" for s in _CHOSEN]
        unknowns = max(solve["unknowns"] for solve in a["solves"])
        costs.append(f"| {name} | " + " | ".join([*sizes, str(unknowns), str(len(a["solves"])), cost]) + " |")
    verdicts = [f"{asked} in {sum(good)} of {len(good)}" for asked, good in met.items()]
    verdict = f"**Met in the scenes drawn and run whose limit is known: {'; '.join(verdicts) or 'none is'}.**"
    verdict += f" {tally(effectivities)} Of what was asked for: {tally(asked_for)}"
    if coarser:
        verdict += (
            f" A state was not found on the last mesh, so that the limit is of those before: {'; '.join(coarser)}."
        )
    return "\n\n".join([_LOOPS, verdict, "\n".join(lines), "What was chosen and what it cost:", "\n".join(costs)])


def _title(name: str) -> str:
    state, quantity = name.split("_", 1)
    if quantity.startswith("sed_"):
        return f"SED at ridge {quantity[4:]}, {_STATES[state]}"
    return f"{_SHORT[quantity]}, {_STATES[state]}"


def page(out: Path) -> str:
    """Return the page of what has been run."""
    return "\n\n".join([_HEADER, loop_tables(out), knob_tables(out), hertz_table()]) + "\n"


def main(given: Sequence[str] | None = None) -> int:
    """Run what is missing and write the page."""
    parser = arguments.parser(__doc__)
    parser.add_argument("--draw", action="store_true", help="run nothing, draw what is there")
    args = parser.parse_args(given)
    failed = list[str]()
    if not args.draw:
        wanted = loops()
        sweep({name: scene for name, (scene, _) in wanted.items()}, args.out, args.jobs, _LIMIT)
        folder = folder_of_limits(args.out)
        known = limits.ask_all({"default scene": DEFAULT}, LEVELS, folder, 1)
        known |= limits.ask_all(untuned.scenes(), LEVELS, folder, args.jobs, uncharged=False)
        failed = [f"{name}: {found['failure']}" for name, found in known.items() if "failure" in found]
    replace(args.docs / "accuracy.md", page(args.out))
    calibration.write(args.docs)
    print("\n".join([*failed, str(args.docs / "accuracy.md")]))
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
