"""The page: every program beside ours, state by state, and a picture of the tractions."""

from collections.abc import Iterable
from dataclasses import dataclass
from pathlib import Path

import matplotlib
import numpy as np
from matplotlib.figure import Figure

from benchmarks.peers import profile
from benchmarks.peers.cases import PEERS, VARIANTS, cases
from benchmarks.peers.exchange import Answer, Ridge, State, read_answer

matplotlib.use("Agg")

FORCE, SHAPE = 5e-4, 1e-2  # bars: relative differences of forces, and of half-width and peak pressure
_STYLES = {"fingerpad": ("C0", "-", ""), "NGSolve": ("C1", "", "o"), "GetFEM": ("C2", "", "x"),
           "FElupe": ("C3", "", "s"), "CalculiX": ("C4", "", "^")}  # fmt: skip
_HEADER = """# Other codes, same problem

Written from the programs' answers by `python3 -m benchmarks.peers page`, the last step of `benchmarks/peers/run`; do
not edit. One papillary ridge, 0.483 mm wide and 0.6 mm high, is pressed by 0.06 mm on a rigid plane in 20 equal steps,
without friction and with a coefficient of 0.25; then its top and sides are moved sideways by 5 µm in 10 steps and on to
50 µm in 15. Stratum corneum of the paper: G_0 = 0.08676 MPa, exponent 14.53 of the modified stretches, ν = 0.48, plane
strain. Penalty 1000 N/mm³, tangential 100 N/mm³, per reference area. All programs read the same mesh of six-node
triangles and take the same steps; each uses its own assembly, differentiation and contact, or weak forms written anew
in its own language. Half the contact's current length is found from the skin's displaced nodes in the same way for all;
the peak pressure is the largest at a program's own contact points.

**!** marks a difference from ours above 0.05 % of a force or 1 % of half-width or peak pressure. Friction is zero by
symmetry in the pressed ridge; its difference there is not judged.
"""


@dataclass(frozen=True)
class Row:
    """A program's numbers in a state: N/mm, N/mm, mm, MPa."""

    program: str
    f_n: float
    f_t: float
    half_width: float
    peak: float

    @property
    def numbers(self) -> tuple[float, ...]:
        """Normal force, friction, half-width, peak pressure."""
        return (self.f_n, self.f_t, self.half_width, self.peak)


def stem(name: str, variant: str) -> str:
    """Return the name of a case's file."""
    return f"{name}_{variant}".replace(" ", "_") if variant else name


def answer_path(folder: Path, size: float, name: str, variant: str, program: str) -> Path:
    """Return where a program's answer is."""
    return folder / f"{program}_{stem(name, variant)}_{size:g}.json"


def row(answer: Answer, state: State, ridge: Ridge, variant: str = "") -> Row:
    """Return a program's numbers in a state."""
    label = f"{answer.program}, {variant}" if variant else answer.program
    return Row(label, state.f_n, state.f_t, profile.half_width(ridge, state), max(state.p_n))


def line(one: Row, ours: Row) -> str:
    """Return a row of the table, with differences from ours."""
    cells = [one.program]
    slides = abs(ours.f_t) > 1e-2 * ours.f_n
    bars, judged = (FORCE, FORCE, SHAPE, SHAPE), (True, slides, True, True)
    for value, reference, bar, judge in zip(one.numbers, ours.numbers, bars, judged, strict=True):
        text = f"{value:.6f}"
        if one is not ours and judge:
            difference = value / reference - 1
            text += f" ({'**!** ' if abs(difference) > bar else ''}{100 * difference:+.4f} %)"
        cells.append(text)
    return "| " + " | ".join(cells) + " |"


def table(rows: Iterable[Row]) -> str:
    """Return a table of programs, ours first."""
    rows = list(rows)
    head = "| program | F_n (N/mm) | F_t (N/mm) | half-width (mm) | peak pressure (MPa) |\n|---|---|---|---|---|"
    return "\n".join([head, *(line(one, rows[0]) for one in rows)])


def draw(answers: list[Answer], names: list[str], path: Path) -> None:
    """Draw pressure and friction over x, a panel for each state."""
    figure = Figure(figsize=(9.0, 3.2 * len(names)), layout="constrained")
    axes = figure.subplots(len(names), 2, squeeze=False)
    for name, (pressure, friction) in zip(names, axes, strict=True):
        for answer in answers:
            state = next((s for s in answer.states if s.name == name), None)
            if state is None:
                continue
            colour, dash, marker = _STYLES[answer.program]
            touching = np.array(state.p_n) > 0
            for ax, values in ((pressure, state.p_n), (friction, state.t_t)):
                ax.plot(
                    np.array(state.x)[touching] * 1e3,
                    np.array(values)[touching] * 1e3,
                    color=colour, linestyle=dash or "none", marker=marker, markersize=3.5, markerfacecolor="none",
                    label=answer.program,
                )  # fmt: skip
        pressure.set(title=name, xlabel="x (µm)", ylabel="contact pressure (kPa)")
        friction.set(title=name, xlabel="x (µm)", ylabel="friction on the skin (kPa)")
        if not any(np.any(s.t_t) for answer in answers for s in answer.states if s.name == name):
            friction.remove()
    axes[0, 0].legend()
    figure.savefig(path, dpi=110)


def write(folder: Path, docs: Path) -> Path:
    """Write page and picture from the answers in a folder; return the page."""
    sizes = sorted((float(path.stem) for path in folder.glob("*.npz")), reverse=True)
    parts, programs = [_HEADER], dict[str, str]()
    for size in sizes:
        ridge = Ridge.read(folder / f"{size:g}.npz")
        parts.append(f"## Facets of {size:g} µm ({len(ridge.triangles)} triangles)")
        for name in cases():
            found = [(variant, peer) for case, variant, peer in VARIANTS if case == name]
            paths = [("", peer) for peer in ("ours", *PEERS)] + found
            answers = [
                (variant, read_answer(path))
                for variant, peer in paths
                if (path := answer_path(folder, size, name, variant, peer)).exists()
            ]
            for _, a in answers:
                programs[a.program] = f"| {a.program} | {a.version} | {a.licence} |"
            for k, state in enumerate(answers[0][1].states):
                rows = [row(answer, answer.states[k], ridge, variant) for variant, answer in answers]
                parts.append(f"**{state.name[0].upper()}{state.name[1:]}**\n\n" + table(rows))
            work = ", ".join(f"{a.program} {a.iterations}" for v, a in answers if not v)
            parts.append(f"Iterations: {work}.")
    parts.insert(1, "| program | version | licence |\n|---|---|---|\n" + "\n".join(programs.values()))
    parts.insert(2, (Path(__file__).parent / "reasons.md").read_text(encoding="utf-8").strip())
    finest = [
        read_answer(path)
        for name in cases()
        for peer in ("ours", *PEERS)
        if (path := answer_path(folder, sizes[-1], name, "", peer)).exists()
    ]
    pictures = docs / "peers"
    pictures.mkdir(parents=True, exist_ok=True)
    names = ["pressed without friction", "moved 5 µm", "moved 50 µm"]
    draw(finest, names, pictures / "tractions.png")
    parts.insert(3, "![Pressure and friction over x in all programs, finest mesh](peers/tractions.png)")
    page = docs / "peers.md"
    page.write_text("\n\n".join(parts) + "\n", encoding="utf-8")
    return page
