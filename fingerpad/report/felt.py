"""The section *What is felt*: spikes of afferents over a run in time, under the pressure of the ridges, by a slider."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from fingerpad.report import page as html
from fingerpad.results.over_time import without_parts_of_jumps
from fingerpad.results.result import Result
from fingerpad.results.spikes import Spikes
from fingerpad.scene.messages import SceneError
from variational.state import ContactState

_MAX_STATES = 200  # of the slider
_BESIDE = {"": 0.0, "left": -0.25, "right": 0.25}  # ridges
_TITLE = "What is felt"
_INTRO = (
    "Spikes of nerve fibres below each ridge that can touch: SA1 at Merkel sites, RA1 at Meissner sites, PC as one "
    "population. Move the slider to read the pressure of the ridges at a time."
)


def felt(result: Result) -> tuple[str, dict[str, Any]]:
    """Return the section and the data of its charts; nothing of a run without stimuli over time."""
    if not any(state.stimuli is not None for state in result.steps[-1:]):
        return "", {}
    try:
        spikes = result.afferents()
    except SceneError as error:
        return html.section("felt", _TITLE, html.paragraph(f"No spikes are computed: {error}.", "note")), {}
    states = without_parts_of_jumps([state for state in result.steps if state.ridges is not None])
    states = [state for k, state in enumerate(states) if k == len(states) - 1 or states[k + 1].time > 0]
    chosen = [states[k] for k in np.unique(np.linspace(0, len(states) - 1, _MAX_STATES).round().astype(int))]
    head, *rows = spikes.table()
    slider = f"""<div class="controls needs-js"><label for="moment">Time</label>
<input type="range" id="moment" min="0" max="{len(chosen) - 1}" step="1" value="{len(chosen) - 1}">
<output id="then" aria-live="polite"></output></div>"""
    section = html.section(
        "felt",
        _TITLE,
        html.paragraph(_INTRO),
        html.paragraph(spikes.remarks[0], "note"),
        slider,
        html.chart("touch", "Mean contact pressure of each ridge, and stress at its Merkel site, at the time chosen"),
        html.chart("raster", "Raster of spikes over time, a row for each unit"),
        html.table(head, rows, "numbers"),
        html.items(spikes.remarks[1:]),
    )
    return section, _data(chosen, spikes)


def _data(states: Sequence[ContactState], spikes: Spikes) -> dict[str, Any]:
    """Return the ridges in each state and the spikes, in the units of charts."""
    rows = []
    for state in states:
        assert state.ridges is not None and state.stimuli is not None
        there = np.isin(state.stimuli.number, state.ridges.number)
        rows.append(
            {
                "t": round(1e3 * state.time, 4),
                "about": f"{state.load}, {state.f_ext:.4g} N/m, {state.voltage:.4g} V, f_T {state.f_t:.3g} N/m",
                "p": [round(1e-3 * float(value), 3) for value in state.ridges.p_c],
                "merkel": [round(1e-3 * float(value), 3) for value in state.stimuli.merkel_stress[there]],
            }
        )
    first = states[0].ridges
    assert first is not None
    units = []
    for law in spikes.laws:
        mine = [(u, train) for u, train in zip(spikes.units, spikes.trains, strict=True) if u.law == law]
        places = [(round(1e3 * float(t), 2), (u.ridge or 0) + _BESIDE[u.side]) for u, train in mine for t in train]
        units.append({"law": law, "t": [t for t, _ in places], "ridge": [ridge for _, ridge in places]})
    loads = [[span.name, round(1e3 * span.begin, 4), round(1e3 * span.end, 4)] for span in spikes.loads]
    return {"ridges": first.number.tolist(), "states": rows, "units": units, "loads": loads}
