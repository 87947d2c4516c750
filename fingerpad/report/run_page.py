"""The report of a run: what was asked and modelled, key numbers and their trust, charts, pictures, parameters."""

import math
from collections.abc import Iterator
from typing import Any

import numpy as np
from markupsafe import Markup

from fingerpad.report import page as html
from fingerpad.report import trust
from fingerpad.report.charts import Panel, Series, bars, chart
from fingerpad.report.frames import conditions_of, frames
from fingerpad.results.headline import band_in_words
from fingerpad.results.over_time import HARMONICS, NOTE, without_parts_of_jumps
from fingerpad.results.printing import cells
from fingerpad.results.quantities import BAND, KNOWN, PER_LENGTH, STEPS, in_table, plus_minus_of
from fingerpad.results.result import Result
from fingerpad.results.spikes import Spikes
from fingerpad.results.states import before_sliding, called
from fingerpad.scene.messages import SceneError
from fingerpad.scene.remarks import coefficient

_MM, _MS, _KPA = 1e3, 1e3, 1e-3
_PICTURES = {
    "finger.png": "The deformed finger, and its strain energy density near the contact",
    "surface.png": "Pressure, shear traction, attraction and gap along the skin in the named states",
    "history.png": "Friction force, contact length and ridges in contact over sliding",
    "time.png": "Voltage, friction force and contact length over time",
    "field.png": "Electric field between one ridge and the screen: upright, as between plates, the law's approximation",
    "footprint.png": "Gross contact (light), ridges (dark) and pressure, slice by slice",
    "solid.png": "The finger in three dimensions from its unloaded slices, from below; ridges by mean pressure",
}
_FACE = "solid.png"  # on the first screen of a run without states to step through
_MAX_STATES = 200  # of the pressure of ridges over time


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
        sure=_claims(result), bars=bars_of(result), frames=shown, scale=scale, face=face,
        newtons=None if result.finger is None else result.finger, numbers=_numbers(result), notes=_notes(result),
        asked=list(_asked(result)), of_path=_of_path(result), per_length=PER_LENGTH,
        band=band_in_words(result.record.get(BAND, {})), sliding=_sliding(result), over_time=_over_time(result),
        receptors=_receptors(result), spikes=spikes, raster=None if spikes is None else _raster(result, spikes),
        note=NOTE, refusal=refusal, pictures=[each for each in pictures if each != face], laws=_laws(result),
        model=result.model_words,
        omitted=[f"{each['what']}: {each['reason']}" for each in result.record.get("omitted") or []],
        work=_work(result), cost=_cost(result), parameters=html.parameters(result.parameters), versions=versions,
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
    known = (line.removesuffix(".") for line in found.known.splitlines())
    return [words for words in (found.solved, *known, found.remark.removesuffix(".")) if words]


def bars_of(result: Result) -> Markup:
    """Return the bars of a result's band; empty without one."""
    found = result.headline
    return bars(result.record[KNOWN], found.error, found.of) if found.known else Markup()


def _asked(result: Result) -> Iterator[tuple[str, ...]]:
    """Yield a row for each load: its name, what it changes and, where it was reached, the state at its end."""
    for load in result.scene.loads():
        given = {
            "external force": (load.f_ext, 1.0, "N/m"),
            "bone height": (load.bone_height, _MM, "mm"),
            "voltage": (load.level, 1.0, "V"),
            "bone sideways": (load.bone_x, _MM, "mm"),
        }
        words = [
            f"{name} to {value * scale:.4g} {unit}" for name, (value, scale, unit) in given.items() if value is not None
        ]
        words += [f"voltage: {load.wave}"] if load.wave is not None else []
        words += [f"bone sideways by {_MM * load.bone_x_by:+.4g} mm"] if load.bone_x_by is not None else []
        words += [load.pace] if load.pace else []
        words += ["ends at full slip"] if load.until_full_slip else []
        reached = [each.end for each in result.loads if each.name == load.name]
        at = [f"{conditions_of(end)}{_friction(end)}" for end in reached] or ["–"]
        yield (load.name, ", ".join(words), *(at[:1] if result.loads else ()))


def _friction(end: Any) -> str:
    return f", f_T {end.f_t:.4g} N/m" if abs(end.f_t) > 1e-9 * max(abs(end.f_ext), 1e-9) else ""


def _of_path(result: Result) -> bool:
    """Return whether the ends of loads are of the path's mesh, and the named states of another one."""
    final = {state.mesh_contact for state in result.named.values()} - {state.mesh_contact for state in result.steps}
    return bool(final and result.steps)


def _numbers(result: Result) -> list[list[str]]:
    """Return the table of key numbers, its heads first; empty without a named state."""
    if not result.named:
        return []
    every = [[quantity.title, *cells(result, key)] for key, quantity in result.printed.items()]
    heads = ["", *(called(name, state.voltage) for name, state in result.named.items())]
    return [heads, *(row for row in every if set(row[1:]) - {"–"})]


def _notes(result: Result) -> list[str]:
    """Return remarks on the key numbers."""
    slip, notes = result.full_slip, list[str]()
    if result.whole:
        notes.append("Each state of the section is under its own part of the force on the whole finger.")
    if any(state.error.known() for state in result.named.values()):
        notes.append(plus_minus_of(result.parts()))
    if slip is not None and not math.isnan(slip.penalty.contact_length):
        friction = f"µ_app at full slip by {slip.penalty.mu_app:+.2g}"
        if math.isnan(slip.penalty.mu_app):
            friction = f"f_T at full slip by {slip.penalty.f_t:+.2g} N/m"
        length = f"the contact length by {_MM * slip.penalty.contact_length:+.2g} mm"
        notes.append(f"Contact is a penalty: a rigid screen would change {friction}, and {length}.")
    return notes


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
            series.append(Series("jump", *zip(*hit, strict=True), "points", "vermilion"))
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


def _over_time(result: Result) -> dict[str, Any] | None:
    """Return extremes, means and the spectrum of friction of loads over time; None without such a load."""
    f_t, length = STEPS["f_t"], STEPS["contact_length"]
    rows, spectra = [], []
    for load in result.loads:
        passed, friction = load.over_time, load.extremes["f_t"]
        if passed is None:
            continue
        ends = ((friction.min, friction.min_time), (friction.max, friction.max_time))
        at = (f"{f_t.shown(value)} at {_MS * time:.4g} ms" for value, time in ends)
        means = (f_t.shown(passed.mean["f_t"]), *at, length.shown(passed.mean["contact_length"]))
        rows.append((load.name, f"{_MS * passed.seconds:.4g}", *means))
        largest = sorted(zip(passed.f_t_amplitude, passed.frequency, strict=True), reverse=True)[:HARMONICS]
        amplitudes = sorted((frequency, value) for value, frequency in largest)
        spectra += [(load.name, f"{frequency:.4g}", f_t.shown(value)) for frequency, value in amplitudes]
    friction_heads = (f"{end} {f_t.head}" for end in ("mean", "least", "largest"))
    heads = ("load", "length (ms)", *friction_heads, f"mean {length.head}")
    spectrum = ("load", "frequency (Hz)", f"amplitude of {f_t.head}")
    return {"heads": heads, "rows": rows, "spectrum": spectrum, "spectra": spectra} if rows else None


def _receptors(result: Result) -> dict[str, Any] | None:
    """Return the largest densities of each named state and those at every ridge; None where a run has none."""
    named = {called(name, state.voltage): state.sites for name, state in result.named.items()}
    found = {words: sites for words, sites in named.items() if sites is not None and len(sites.number)}
    if not found:
        return None
    kinds = {
        "a Merkel site": {words: _KPA * sites.merkel for words, sites in found.items()},
        "a Meissner site": {words: _KPA * np.maximum(sites.left, sites.right) for words, sites in found.items()},
    }
    rows = [(f"largest at {site}", *(f"{each.max():.4g}" for each in kind.values())) for site, kind in kinds.items()]
    merkel = kinds["a Merkel site"].values()
    of = (str(int(sites.number[values.argmax()])) for sites, values in zip(found.values(), merkel, strict=True))
    rows.insert(1, ("of the ridge", *of))
    cells = [[f"{value:.4g}" for value in values] for kind in kinds.values() for values in kind.values()]
    every = list(zip(map(str, next(iter(found.values())).number), *cells, strict=True))
    heads = ("ridge", *(f"{site}, {words}" for site in ("Merkel", "larger Meissner") for words in found))
    return {"heads": ("", *found), "rows": rows, "every": heads, "ridges": every}


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
    pressures = [_KPA * np.asarray(state.ridges.p_c) for state in chosen if state.ridges is not None]
    numbers = [] if not chosen or chosen[0].ridges is None else chosen[0].ridges.number
    time = [_MS * state.time for state in chosen]
    ridges = [
        Series(f"ridge {number}", time, each) for number, each in zip(numbers, np.transpose(pressures), strict=True)
    ]
    panels = [Panel("pressure (kPa)", [each for each in ridges if max(each.y) > 0])]
    for law, colour in zip(spikes.laws, ("blue", "vermilion", "ink", "green", "purple"), strict=False):
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


def _work(result: Result) -> Markup:
    """Return the chart of the solver's work over the steps; empty where it is not known."""
    steps = [state for state in result.steps if state.record is not None]
    if not steps:
        return Markup()
    x, loads = [state.step for state in steps], [state.load for state in steps]
    series = [
        Series(words, x, [getattr(state.record, key) for state in steps], "bars", colour, labels=loads)
        for words, key, colour in (
            ("Newton iterations", "newton_iterations", "blue"),
            ("factorisations",) * 2 + ("vermilion",),
        )
    ]
    cut = [state for state in steps if state.record is not None and state.record.cutbacks]
    if cut:
        words = [f"cut {state.record.cutbacks} times" for state in cut if state.record is not None]
        series.append(
            Series("cut step", [state.step for state in cut], [0.0] * len(cut), "points", "ink", labels=words)
        )
    words = "Newton iterations, factorisations and cut steps over the steps"
    return chart([Panel("number (–)", series)], "step", words)


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
