"""The section of a report on mechanoreceptors: strain energy densities at the Merkel and Meissner sites."""

import numpy as np

from fingerpad.io.result import Result
from fingerpad.io.states import called
from fingerpad.report import page as html

_KPA = 1e-3
_INTRO = (
    "Strain energy density per reference volume (kPa) at the Merkel sites, at the tips of the intermediate ridges, and "
    "at the Meissner sites, in the dermal papillae on either side. How nerves answer to it is not part of the model."
)


def section(result: Result) -> str:
    """Return the largest densities of each named state and those at every ridge; nothing where a run has none."""
    named = {called(name, state.voltage): state.sites for name, state in result.named.items()}
    found = {words: sites for words, sites in named.items() if sites is not None and len(sites.number)}
    if not found:
        return ""
    merkel = {words: _KPA * sites.merkel for words, sites in found.items()}
    meissner = {words: _KPA * np.maximum(sites.left, sites.right) for words, sites in found.items()}
    heads = ("", *found)
    rows = [
        ("largest at a Merkel site", *(f"{values.max():.4g}" for values in merkel.values())),
        ("of the ridge", *(str(int(sites.number[merkel[words].argmax()])) for words, sites in found.items())),
        ("largest at a Meissner site", *(f"{values.max():.4g}" for values in meissner.values())),
    ]
    cells = [[f"{value:.4g}" for value in values] for kind in (merkel, meissner) for values in kind.values()]
    every = list(zip(map(str, next(iter(found.values())).number), *cells, strict=True))
    all_heads = ("ridge", *(f"{site}, {words}" for site in ("Merkel", "larger Meissner") for words in found))
    return html.section(
        "receptors", "Mechanoreceptors", html.paragraph(_INTRO), html.table(heads, rows, "numbers"),
        html.folded("Every ridge", html.table(all_heads, every, "numbers")),
    )  # fmt: skip
