"""Press, charge and slide over the whole range of forces and voltages, and at its corners: does every trace arrive?

environment/run python3 benchmarks/traces.py [--jobs 2] [--only grid fine corners]

Default options throughout. Results are kept in results/traces, a folder a scene; started again, only what is missing
is run. What is there is written to docs/traces.md.
"""

import sys
from collections.abc import Callable, Mapping, Sequence
from pathlib import Path
from typing import Any

from benchmarks import arguments
from fingerpad.io.files import replace
from fingerpad.model.touching import by_rule
from fingerpad.runs.batch import Summary, result, sweep
from fingerpad.scene import Scene, from_data
from fingerpad.scene import load as load_scene

_ROOT = Path(__file__).resolve().parents[1]
VOLTAGES = (0.0, 50.0, 100.0, 150.0, 200.0)
FORCES = (5.0, 10.0, 25.0, 50.0, 75.0, 100.0, 120.0, 150.0)
FINE_VOLTAGES, FINE_FORCES = (100.0, 200.0), (25.0, 75.0, 120.0)
_COARSE, _FINE = 10e-6, 5e-6  # m, contact sizes
SITES = 20e-6  # m, size at the Merkel sites: coarser than by default, by which their energies come out 13 % low
_LAYERS = ("subcutis", "dermis", "viable_epidermis", "stratum_corneum")
_HEADER = """# Traces over forces and voltages

Made by `environment/run python3 benchmarks/traces.py`; do not edit. Each trace presses, charges and slides the default
finger with default options; a cell says the apparent friction at full slip, the jumps (steps that needed
pseudo-transient continuation), the cut steps and the factorisations. **!** marks a trace that did not reach full slip.
"""


def trace(f_ext: float, voltage: float, size: float, **more: Any) -> Scene:
    """Return the scene of one trace; ``size`` is the contact size (m). All of one force have the same mesh."""
    mesh = {"contact": size, "receptor": SITES}
    return by_rule(from_data({"f_ext": f_ext, "voltage": voltage, "mesh": mesh} | more))


def grid(voltages: Sequence[float], forces: Sequence[float], size: float) -> dict[str, Scene]:
    """Return the traces of all pairs, the heaviest first."""
    pairs = [(f, u) for u in reversed(voltages) for f in reversed(forces)]
    return {f"{f:g} N/m, {u:g} V, {size * 1e6:g} µm": trace(f, u, size) for f, u in pairs}


def corners() -> dict[str, Scene]:
    """Return scenes at the ends of what a user would go to."""
    at = {"mesh.contact": _COARSE, "mesh.receptor": SITES}
    stiff = {name: {"poisson": 0.499} for name in _LAYERS}
    return {
        "200 V at 2 N/m": trace(2.0, 200.0, _COARSE),
        "friction coefficient 1": trace(75.0, 200.0, _COARSE, friction=1.0),
        "Poisson's ratio 0.499": trace(75.0, 200.0, _COARSE, materials=stiff),
        "400 V at 10 N/m": trace(10.0, 400.0, _COARSE),
        "unloaded at 200 V": by_rule(load_scene(_ROOT / "demos" / "scenes" / "unload.toml", at)),
    }


GROUPS: Mapping[str, Callable[[], dict[str, Scene]]] = {
    "grid": lambda: grid(VOLTAGES, FORCES, _COARSE),
    "fine": lambda: grid(FINE_VOLTAGES, FINE_FORCES, _FINE),
    "corners": corners,
}


def _cell(s: Summary | None) -> str:
    if s is None:
        return "not run"
    if "parameters" not in s:
        return f"**!** {s['failure']}"
    work = f"{s['jumps']} j, {s['cutbacks']} c, {s['factorisations']} f"
    if not s["full_slip"]:
        return f"**!** {work}"
    return f"{s['slip_mu_app']:.4f} ({work})"


def _matrix(voltages: Sequence[float], forces: Sequence[float], size: float, out: Path) -> str:
    lines = ["| f_ext (N/m) | " + " | ".join(f"{u:g} V" for u in voltages) + " |", "|---" * (len(voltages) + 1) + "|"]
    for f in forces:
        cells = [_cell(result(trace(f, u, size), out)) for u in voltages]
        lines.append(f"| {f:g} | " + " | ".join(cells) + " |")
    return "\n".join(lines)


def _checks(scenes: Mapping[str, Scene], out: Path) -> str:
    """Say what all traces of a group have in common."""
    ran = [s for scene in scenes.values() if (s := result(scene, out)) is not None]
    if not ran:
        return "None was run."
    arrived = sum(s["full_slip"] for s in ran)
    return (
        f"{arrived} of {len(scenes)} traces reach full slip ({len(ran)} run). Largest nodal imbalance "
        f"{max(s['imbalance'] for s in ran):.1g} of f_ext, deepest penetration "
        f"{1e9 * max(s['penetration'] for s in ran):.0f} nm."
    )


def page(out: Path) -> str:
    """Return the page of what has been run."""
    parts = [_HEADER]
    for name, (voltages, forces, size) in {
        "grid": (VOLTAGES, FORCES, _COARSE),
        "fine": (FINE_VOLTAGES, FINE_FORCES, _FINE),
    }.items():
        parts += [f"## Contact size {size * 1e6:g} µm", _checks(GROUPS[name](), out)]
        parts += [_matrix(voltages, forces, size, out)]
    parts += ["## Corners", f"Contact size {_COARSE * 1e6:g} µm."]
    lines = ["| scene | full slip | end |", "|---|---|---|"]
    for name, scene in corners().items():
        s = result(scene, out)
        end = "–" if s is None else s.get("failure", "reaches its end")
        cell = "–" if s is None or scene.history else _cell(s)
        lines.append(f"| {name} | {cell} | {end} |")
    return "\n\n".join([*parts, "\n".join(lines)]) + "\n"


def main(given: Sequence[str] | None = None) -> int:
    """Run what is missing of the groups asked for and write the page."""
    parser = arguments.parser(__doc__)
    parser.add_argument("--only", nargs="*", choices=GROUPS, default=list(GROUPS), help="groups to run")
    args = parser.parse_args(given)
    scenes = {name: scene for group in args.only for name, scene in GROUPS[group]().items()}
    summaries = sweep(scenes, args.out, args.jobs)
    replace(args.docs / "traces.md", page(args.out))
    failed = [name for name, s in summaries.items() if "failure" in s]
    print(f"{len(scenes) - len(failed)} of {len(scenes)} reached their end; {args.docs / 'traces.md'}")
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
