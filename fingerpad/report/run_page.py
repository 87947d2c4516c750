"""The report of a run: what was asked and modelled, key numbers and their trust, charts, pictures, parameters."""

import math
from collections.abc import Iterator
from itertools import cycle
from typing import Any

import numpy as np
from markupsafe import Markup

from fingerpad.report import page as html
from fingerpad.report import trust
from fingerpad.report.charts import Panel, Series, chart, elasticities
from fingerpad.report.frames import conditions_of, frames
from fingerpad.results.over_time import NOTE, without_parts_of_jumps
from fingerpad.results.printing import remarks, table, timed
from fingerpad.results.quantities import STEPS, in_table
from fingerpad.results.result import Result
from fingerpad.results.slopes import SLOPES, rows
from fingerpad.results.spikes import Spikes
from fingerpad.results.states import before_sliding, called
from fingerpad.scene.messages import SceneError
from fingerpad.scene.remarks import coefficient

_MM, _MS, _KPA = 1e3, 1e3, 1e-3
_PICTURES = {
    "finger.png": "The deformed finger, and its strain energy density near the contact",
    "surface.png": "Pressure, shear traction, attraction and gap along the skin in the named states",
    "history.png": "Friction force, contact length and ridges in contact over sliding",
    "time.png": "What is prescribed, friction force and contact length over time",
    "field.png": "Electric field between one ridge and the screen: upright, as between plates, the law's approximation",
    "footprint.png": "Gross contact (light), ridges (dark) and pressure, slice by slice",
    "uncertainty.png": "Budget of µ_app: people, models and numerical errors, by fingerpad uncertainty",
    "solid.png": "The finger in three dimensions from its unloaded slices, from below; ridges by mean pressure",
}
_FACE = "solid.png"  # on the first screen of a run without states to step through
_MAX_STATES = 200  # of the pressure of ridges over time
_MAX_SLOPES = 15  # of numbers that move friction most


def page(result: Result) -> str:
    """Return the page of a run."""
    shown, scale = frames(result)
    pictures = list(_pictures(result))
    face = next((each for each in pictures if each[0] == _FACE), None) if not shown else None
    spikes, refusal = _spikes(result)
    versions = (result.record.get("provenance") or {}).get("versions", {})
    found, headline = trust.findings(result), result.headline
    return html.page(
        "run.html", f"fingerpad: {headline.sentence}", result=result, headline=headline, factor=_factor(result),
        name="" if result.folder is None else result.folder.name, verdict=trust.verdict(found), findings=found,
        sure=_claims(result), frames=shown, scale=scale, face=face, slopes=_slopes(result),
        newtons=None if result.finger is None else result.finger, numbers=table(result), remarks=remarks(result),
        asked=list(_asked(result)), of_path=_of_path(result), sliding=_sliding(result), over_time=timed(result),
        receptors=_receptors(result), spikes=spikes, raster=None if spikes is None else _raster(result, spikes),
        note=NOTE, refusal=refusal, pictures=[each for each in pictures if each != face], laws=_laws(result),
        model=result.model_words,
        omitted=[f"{each['what']}: {each['reason']}" for each in result.record.get("omitted") or []],
        cost=_cost(result), parameters=html.parameters(result.parameters), versions=versions,
        again=html.recipe(result.parameters, result.model),
    )  # fmt: skip


def _factor(result: Result) -> str:
    """Return in words how many times the friction without attraction that of the headline is."""
    found, friction = result.headline, coefficient(result.scene)
    if not friction or found.quantity.name != "mu_app" or math.isnan(found.value):
        return ""
    return f": {abs(found.value) / friction:.2f} times the {friction:.3g} without attraction"


def _claims(result: Result) -> list[str]:
    """Return sentences on how far the number is solved and known, without their points."""
    found = result.headline
    known = (line.removesuffix(".") for line in (found.people, found.closures, found.remark))
    return [words for words in (found.solved, *known) if words]


def _asked(result: Result) -> Iterator[tuple[str, ...]]:
    """Yield a row for each load: its name, what it changes and, where it was reached, the state at its end."""
    for load in result.scene.loads():
        at = [f"{conditions_of(each.end)}{_friction(each.end)}" for each in result.loads if each.name == load.name]
        yield (load.name, ", ".join(load.aims()), *([at[0] if at else "–"] if result.loads else []))


def _friction(end: Any) -> str:
    return f", f_T {end.f_t:.4g} N/m" if abs(end.f_t) > 1e-9 * max(abs(end.f_ext), 1e-9) else ""


def _of_path(result: Result) -> bool:
    """Return whether the ends of loads are of the path's mesh, and the named states of another one."""
    final = {state.mesh_contact for state in result.named.values()} - {state.mesh_contact for state in result.steps}
    return bool(final and result.steps)


def _sliding(result: Result) -> dict[str, Any] | None:
    """Return the chart of friction and contact length over sliding, and its table with heads; None without sliding."""
    still, known = len(before_sliding(result.steps)), []
    if still in (0, len(result.steps)):
        return None
    steps, shown = result.steps[still - 1 :], list(in_table("sliding").values())
    rows = [
        [str(s.step), *(each.shown(getattr(s, each.name)) for each in shown), "jump" * trust.jumped(s)] for s in steps
    ]
    x = [_MM * state.bone_x for state in steps]
    words = [f"step {state.step}" for state in steps]
    panels = []
    for key, dash, colour in (("mu_app", "", "ink"), ("contact_length", "6 3", "blue")):
        of = STEPS[key]
        series = [Series(of.words, x, [of.scale * getattr(s, key) for s in steps], "both", colour, dash, labels=words)]
        hit = [(place, of.scale * getattr(s, key)) for place, s in zip(x, steps, strict=True) if trust.jumped(s)]
        if hit:
            series.append(Series("jump", [x for x, _ in hit], [y for _, y in hit], "points", "vermilion"))
        known = [
            (name, s) for name, s in result.named.items() if not math.isnan(getattr(s.error, key) + getattr(s, key))
        ]
        known = [(name, s) for name, s in known if key != "mu_app" or name == "full_slip"]
        if known:
            series.append(Series(
                "± discretisation error", [_MM * s.bone_x for _, s in known],
                [of.scale * getattr(s, key) for _, s in known], "points", "soft",
                error=[of.scale * getattr(s.error, key) for _, s in known],
                labels=[called(name, s.voltage) for name, s in known],
            ))  # fmt: skip
        panels.append(Panel(of.title, series))
    jumps = [place for place, s in zip(x, steps, strict=True) if trust.jumped(s)]
    words_of = "Friction and contact length over the sideways displacement of the bone"
    drawn = chart(panels, "sideways displacement of the bone (mm)", words_of, lines=jumps)
    return {"chart": drawn, "heads": ["step", *(each.head for each in shown), "jump"], "rows": rows}


def _receptors(result: Result) -> list[tuple[str, ...]]:
    """Return a row for each named state: the largest densities at Merkel sites, with its ridge, and Meissner sites."""
    rows = list[tuple[str, ...]]()
    for name, state in result.named.items():
        if (sites := state.sites) is not None and len(sites.number):
            merkel, meissner = _KPA * sites.merkel, _KPA * np.maximum(sites.left, sites.right)
            ridge = str(int(sites.number[merkel.argmax()]))
            rows.append((called(name, state.voltage), f"{merkel.max():.4g}", ridge, f"{meissner.max():.4g}"))
    return rows


def _slopes(result: Result) -> tuple[Markup, str]:
    """Return the largest elasticities of friction as bars, or why there are none; neither of a run without."""
    if SLOPES not in result.record:
        return Markup(), ""
    try:
        most = [row for row in rows(result) if row.elasticity][:_MAX_SLOPES]
        return (elasticities(most, "µ_app"), "") if most else (Markup(), "friction is zero")
    except SceneError as error:
        return Markup(), str(error)


def _spikes(result: Result) -> tuple[Spikes | None, str]:
    """Return the spikes of a run with stimuli over time, or why there are none; neither of another run."""
    if not any(state.stimuli is not None for state in result.steps[-1:]):
        return None, ""
    try:
        return result.afferents(), ""
    except SceneError as error:
        return None, str(error)


def _raster(result: Result, spikes: Spikes) -> Markup:
    """Return the mean pressure of each ridge over time, and below it the spikes of each class."""
    states = without_parts_of_jumps([state for state in result.steps if state.ridges is not None])
    states = [state for k, state in enumerate(states) if k == len(states) - 1 or states[k + 1].time > 0]
    chosen = [states[int(k)] for k in np.unique(np.linspace(0, len(states) - 1, _MAX_STATES).round())]
    time = [_MS * state.time for state in chosen]
    found = [state.ridges for state in chosen if state.ridges is not None]
    means: list[dict[Any, Any]] = [dict(zip(each.number, _KPA * each.p_c, strict=True)) for each in found]
    numbers = sorted({int(number) for mean in means for number in mean})  # a path may go on with more ridges
    ridges = [Series(f"ridge {j}", time, np.array([mean.get(j, 0.0) for mean in means])) for j in numbers]
    panels = [Panel("pressure (kPa)", [each for each in ridges if max(each.y) > 0])]
    for law, colour in zip(spikes.laws, cycle(("blue", "vermilion", "ink", "green", "purple")), strict=False):
        mine = [(u, train) for u, train in zip(spikes.units, spikes.trains, strict=True) if u.law == law]
        places = [(_MS * float(t), u.place) for u, train in mine for t in train]
        x, y = zip(*places, strict=True) if places else ((), ())
        units = [unit.place for unit, _ in mine]
        ends = min(units) - 1, max(units) + 1
        panels.append(Panel(f"{law}, ridge", [Series(law, x, y, "ticks", colour)], 40 + 4 * (ends[1] - ends[0]), ends))
    begins = [_MS * span.begin for span in spikes.loads]
    words = "Mean contact pressure of each ridge, and the spikes of each class of afferents, over time"
    return chart(panels, "time (ms)", words, ends=(0.0, _MS * spikes.seconds), lines=begins, legend=False)


def _pictures(result: Result) -> Iterator[tuple[str, str, str]]:
    """Yield name, link and words of each picture in the folder."""
    if result.folder is None:
        return
    for name, each in _PICTURES.items():
        if (result.folder / name).exists():
            yield name, html.picture(result.folder / name), each


def _laws(result: Result) -> list[tuple[str, str]]:
    laws = result.record.get("laws") or {}
    return [(name.replace("_", " "), law) for name, law in laws.items()] if isinstance(laws, dict) else []


def _cost(result: Result) -> list[tuple[str, str]]:
    cost = result.cost
    values = {
        "wall time": f"{cost.wall_seconds:.0f} s",
        "processor time": f"{cost.processor_seconds:.0f} s",
        "memory": f"{cost.memory_mb:.0f} MB",
        "ranks": str(cost.ranks),
        "unknowns": str(cost.unknowns),
        "Newton iterations of the loading path": str(cost.newton_iterations),
        "its factorisations": str(cost.factorisations),
    }
    return [(name, value) for name, value in values.items() if value not in ("0", "0 s", "0 MB")]
