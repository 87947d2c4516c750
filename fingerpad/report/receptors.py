"""The section of a report on mechanoreceptors: strain energy densities at the Merkel and Meissner sites."""

import numpy as np

from fingerpad.io.dataset import sites
from fingerpad.io.result import Result
from fingerpad.io.states import STATES, called
from fingerpad.report import page as html

_KPA = 1e-3
_INTRO = (
    "Strain energy density per reference volume (kPa) at the Merkel sites, at the tips of the intermediate ridges, and "
    "at the Meissner sites, in the dermal papillae on either side. How nerves answer to it is not part of the model."
)


def section(result: Result) -> str:
    """Return the largest densities of each named state and those at every ridge; nothing where a run has none."""
    found = sites(result)
    if not found:
        return ""
    ridges = found["ridge"][1]
    merkel, meissner = (_KPA * found[f"{name}_sed"][1] for name in ("merkel", "meissner"))
    named = {STATES.index(name): called(name, state.voltage) for name, state in result.named.items()}
    there = [k for k in named if np.isfinite(merkel[k]).any()]
    heads = ("", *(named[k] for k in there))
    most = [int(ridges[np.nanargmax(merkel[k])]) for k in there]
    rows = [
        ("largest at a Merkel site", *(f"{np.nanmax(merkel[k]):.4g}" for k in there)),
        ("of the ridge", *map(str, most)),
        ("largest at a Meissner site", *(f"{np.nanmax(meissner[k]):.4g}" for k in there)),
    ]
    every = [
        (str(ridge), *(_cell(merkel[k, j]) for k in there), *(_cell(meissner[k, j].max()) for k in there))
        for j, ridge in enumerate(ridges)
        if np.isfinite(merkel[there, j]).any()
    ]
    all_heads = ("ridge", *(f"{site}, {named[k]}" for site in ("Merkel", "larger Meissner") for k in there))
    return html.section(
        "receptors", "Mechanoreceptors", html.paragraph(_INTRO), html.table(heads, rows, "numbers"),
        html.folded("Every ridge", html.table(all_heads, every, "numbers")),
    )  # fmt: skip


def _cell(value: float) -> str:
    return f"{value:.4g}" if np.isfinite(value) else "–"
