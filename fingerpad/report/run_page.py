"""The report of a run: what was asked and modelled, key numbers and their trust, charts, pictures, parameters."""

import math
from pathlib import Path
from typing import Any

import numpy as np

from fingerpad.reduced.registry import MODELS
from fingerpad.report import page as html
from fingerpad.report import trust
from fingerpad.report.felt import felt
from fingerpad.report.frames import conditions_of, frames, section, slider
from fingerpad.report.trust import head
from fingerpad.results import fields
from fingerpad.results.headline import band_in_words
from fingerpad.results.over_time import HARMONICS, NOTE
from fingerpad.results.printing import cells
from fingerpad.results.quantities import BAND, PER_LENGTH, STEPS, in_table, plus_minus_of
from fingerpad.results.result import Result
from fingerpad.results.states import WORDS, before_sliding, called
from variational.state import ContactState, Errors

_MM = 1e3
_LINKS = {
    "asked": "Asked", "newtons": "Newtons", "numbers": "Numbers", "trust": "Trust", "ridge-by-ridge": "One ridge",
    "sliding": "Sliding", "time": "Time", "receptors": "Receptors", "felt": "Felt", "pictures": "Pictures",
    "model": "Model", "solver": "Solver", "parameters": "Parameters", "reproduce": "Reproduce",
}  # fmt: skip
_SECTION = "Middle section of the finger"
_CHARTED, _WORK = in_table("chart"), in_table("work")
_RECEPTORS = (
    "Strain energy density per reference volume (kPa) at the Merkel sites, at the tips of the intermediate ridges, and "
    "at the Meissner sites, in the dermal papillae on either side."
)
_SAID = {
    "surface.png": "Pressure, shear traction, attraction and gap along the skin in the named states",
    "history.png": "Friction force, contact length and ridges in contact over sliding",
    "time.png": "Voltage, friction force and contact length over time",
    "field.png": "Electric field between one ridge and the screen: upright, as between plates, the law's approximation",
    "footprint.png": "Gross contact (light), ridges (dark) and pressure, slice by slice",
    "solid.png": "The finger in three dimensions from its unloaded slices, from below; ridges by mean pressure",
}
_FACE = "solid.png"  # on the first screen of a run without states to step through
_MAX_FINGERS = 4  # pictures of the finger


def page(result: Result) -> str:
    """Return the page of a run."""
    shown = frames(result)
    face = slider(shown) or (html.picture(result.folder / _FACE, _SAID[_FACE]) if result.folder is not None else "")
    title = f"fingerpad: {result.headline.sentence}"
    answer, spikes = felt(result)
    sections = [
        _newtons(result),
        _numbers(result),
        _asked(result),
        _trust(result),
        section(shown),
        _sliding(result),
        _over_time(result),
        _pictures(result, face),
        _receptors(result),
        answer,
        _model(result),
        _solver(result),
        html.section("parameters", "Parameters", html.all_parameters(result.parameters)),
        _reproduce(result),
    ]
    there = [name for part in sections for name in _LINKS if f'id="{name}"' in part]
    links = "".join(f'<a href="#{name}">{_LINKS[name]}</a>' for name in there)
    body = "\n".join([html.first(head(result), face), f"<nav>{links}</nav>", html.beside(sections)])
    data = {"finger": shown, "steps": _columns(result), "errors": _errors(result)}
    return html.page(title, body, data | ({"felt": spikes} if spikes else {}))


def _asked(result: Result) -> str:
    rows, heads = [], ("load", "change", *["state at its end"] * bool(result.loads))
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
        reached = [end for end in result.loads if end.name == load.name]
        rows.append((load.name, ", ".join(words), _cell(reached))[: len(heads)])
    intro = "A fingertip on a charged screen, loaded in this order:"
    if result.whole:
        intro = f"A force of {result.scene.force:.4g} N on the whole finger. Loads at its centre"
        intro += ", where f_ext is an estimate before the run:"
    return html.section(
        "asked",
        "What was asked",
        html.paragraph(intro),
        html.table(heads, rows),
        html.paragraph(f"{_of_path(result)}{PER_LENGTH}", "note"),
    )


def _of_path(result: Result) -> str:
    """Return that the ends of loads are of the path's mesh, where the named states are of another one."""
    final = {state.mesh_contact for state in result.named.values()} - {state.mesh_contact for state in result.steps}
    if not (final and result.steps):
        return ""
    return "States at the ends of loads are of the path, on larger elements than the key numbers below. "


def _cell(reached: list[Any]) -> str:
    if not reached:
        return "–"
    end = reached[0].end
    friction = f", f_T {end.f_t:.4g} N/m" if abs(end.f_t) > 1e-9 * max(abs(end.f_ext), 1e-9) else ""
    return f"{conditions_of(end)}{friction}"


def _numbers(result: Result) -> str:
    if not result.named:
        return html.section("numbers", "Key numbers", html.paragraph("The run has no named state."))
    every = [(quantity.title, *cells(result, key)) for key, quantity in result.printed.items()]
    rows = [row for row in every if set(row[1:]) - {"–"}]
    slip = result.full_slip
    notes = []
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
    heads = ("", *(called(name, state.voltage) for name, state in result.named.items()))
    return html.section(
        "numbers",
        "Key numbers" if result.finger is None else _SECTION,
        html.table(heads, rows, "numbers"),
        html.items(notes),
    )


def _newtons(result: Result) -> str:
    if result.finger is None:
        return ""
    table = html.table(("", *result.finger.heads()), result.finger.rows(), "numbers")
    return html.section("newtons", "The whole finger, in newtons", table, html.items(result.finger.remarks()))


def _trust(result: Result) -> str:
    found = trust.findings(result)
    lines = "".join(
        f'<li class="{each.verdict}"><b>{html.MARKS[each.verdict]}</b> <span><strong>{html.text(each.what)}.</strong> '
        f"{html.typeset(each.words)}</span></li>"
        for each in found
    )
    band = band_in_words(result.record.get(BAND, {}))
    note = (
        "All this is about the mathematics. The finger is less certain: its law of friction, ridge tips and roughness "
        "move µ_app by 10 % and more (docs/assumptions.md)." + (f" {band}" if band else "")
    )
    return html.section(
        "trust", "Can these numbers be relied on?", f'<ul class="findings">{lines}</ul>', html.paragraph(note)
    )


def _sliding(result: Result) -> str:
    still = len(before_sliding(result.steps))
    if still in (0, len(result.steps)):
        return ""
    shown = list(in_table("sliding").values())
    rows = [
        (str(s.step), *(each.shown(getattr(s, each.name)) for each in shown), "jump" if trust.jumped(s) else "")
        for s in result.steps[still - 1 :]
    ]
    return html.section(
        "sliding",
        "Friction and contact length over sliding",
        html.paragraph("Dotted lines and crosses mark steps in which part of the skin jumped."),
        html.chart("friction", "Friction and contact length over the sideways displacement of the bone"),
        html.folded("The same as a table", html.table(("step", *(each.head for each in shown), "jump"), rows)),
    )


def _over_time(result: Result) -> str:
    """Return extremes, means and the spectrum of friction of loads over time; nothing without such a load."""
    f_t, length = STEPS["f_t"], STEPS["contact_length"]
    rows, spectra = [], []
    for load in result.loads:
        passed, friction = load.over_time, load.extremes["f_t"]
        if passed is None:
            continue
        ends = ((friction.min, friction.min_time), (friction.max, friction.max_time))
        at = (f"{f_t.shown(value)} at {1e3 * time:.4g} ms" for value, time in ends)
        means = (f_t.shown(passed.mean["f_t"]), *at, length.shown(passed.mean["contact_length"]))
        rows.append((load.name, f"{1e3 * passed.seconds:.4g}", *means))
        largest = sorted(zip(passed.f_t_amplitude, passed.frequency, strict=True), reverse=True)[:HARMONICS]
        amplitudes = sorted((frequency, value) for value, frequency in largest)
        spectra += [(load.name, f"{frequency:.4g}", f_t.shown(value)) for frequency, value in amplitudes]
    if not rows:
        return ""
    friction_heads = (f"{end} {f_t.head}" for end in ("mean", "least", "largest"))
    heads = ("load", "length (ms)", *friction_heads, f"mean {length.head}")
    spectrum = html.table(("load", "frequency (Hz)", f"amplitude of {f_t.head}"), spectra) if spectra else ""
    return html.section("time", "Loads over time", html.paragraph(NOTE), html.table(heads, rows), spectrum)


def _receptors(result: Result) -> str:
    """Return the largest densities of each named state and those at every ridge; nothing where a run has none."""
    named = {called(name, state.voltage): state.sites for name, state in result.named.items()}
    found = {words: sites for words, sites in named.items() if sites is not None and len(sites.number)}
    if not found:
        return ""
    kinds = {
        "a Merkel site": {words: 1e-3 * sites.merkel for words, sites in found.items()},
        "a Meissner site": {words: 1e-3 * np.maximum(sites.left, sites.right) for words, sites in found.items()},
    }
    rows = [(f"largest at {site}", *(f"{each.max():.4g}" for each in kind.values())) for site, kind in kinds.items()]
    merkel = kinds["a Merkel site"].values()
    of = (str(int(sites.number[values.argmax()])) for sites, values in zip(found.values(), merkel, strict=True))
    rows.insert(1, ("of the ridge", *of))
    cells = [[f"{value:.4g}" for value in values] for kind in kinds.values() for values in kind.values()]
    every = list(zip(map(str, next(iter(found.values())).number), *cells, strict=True))
    heads = ("ridge", *(f"{site}, {words}" for site in ("Merkel", "larger Meissner") for words in found))
    return html.section(
        "receptors", "Mechanoreceptors", html.paragraph(_RECEPTORS), html.table(("", *found), rows, "numbers"),
        html.folded("Every ridge", html.table(heads, every, "numbers")),
    )  # fmt: skip


def _pictures(result: Result, face: str) -> str:
    """Return the finger at the end of each load, in order, then several states; none that the first screen shows."""
    folder = result.folder
    if folder is None:
        return ""
    fingers = _fingers(result, folder)
    files = [(file, f"Deformed finger: {words}") for file, words in fingers[:_MAX_FINGERS]]
    files += [(folder / name, words) for name, words in _SAID.items()]
    left = len(list(folder.glob("finger_*.png"))) - len(fingers[:_MAX_FINGERS])
    more = f"{left} more pictures of the finger are in the folder." if left else ""
    drawn = [part for part in (html.picture(file, words) for file, words in files) if part != face]
    if (folder / fields.FILE).exists() and not fields.read(folder):
        drawn.append(html.paragraph(f"{fields.FILE} is left out: it has no arrays of a run.", "note"))
    return html.section("pictures", "Pictures", *drawn, html.paragraph(more, "note") if more else "")


def _fingers(result: Result, folder: Path) -> list[tuple[Path, str]]:
    """Return the last picture of the finger in each load, in their order: that of the final mesh where there is one."""
    states = {load.name: {load.name: f"end of {load.name}"} for load in result.loads}
    for name, state in result.named.items():
        states.setdefault(state.load, {})[WORDS[name]] = called(name, state.voltage)
    found = []
    for named in states.values():
        files = [(folder / f"finger_{name.replace(' ', '_')}.png", words) for name, words in named.items()]
        found += [each for each in files if each[0].exists()][-1:]
    return found


def _model(result: Result) -> str:
    laws = result.record.get("laws") or {}
    rows = [(name.replace("_", " "), law) for name, law in laws.items()] if isinstance(laws, dict) else []
    omitted = [f"{each['what']}: {each['reason']}" for each in result.record.get("omitted") or []]
    always = (
        "Never in the model: inertia, waves, leakage of charge, moisture, the deformation and roughness "
        "of the screen, and the direction along the finger (plane strain). See docs/model.md."
    )
    words = MODELS[result.model].words if result.model in MODELS else "A model that is not registered here"
    first = f"{words} (model {result.model!r})."
    unknowns = f" {result.cost.unknowns} unknowns." if result.cost.unknowns else ""
    left = html.items(omitted) if omitted else html.paragraph("Nothing of the scene was left out.")
    return html.section(
        "model",
        "What was modelled, and what was left out",
        html.paragraph(first + unknowns),
        html.table(("part", "law"), rows) if rows else "",
        "<h3>Left out</h3>",
        left,
        html.paragraph(always, "note"),
        "".join(html.paragraph(note, "note") for note in result.notes),
    )


def _solver(result: Result) -> str:
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
    rows = [(name, value) for name, value in values.items() if value not in ("0", "0 s", "0 MB")]
    known = any(state.record is not None for state in result.steps)
    drawn = html.chart("work", "Newton iterations, factorisations and cut steps over the steps") if known else ""
    return html.section("solver", "Solver history", drawn, html.table(("", "whole run"), rows) if rows else "")


def _reproduce(result: Result) -> str:
    found = result.record.get("provenance") or {}
    versions = found.get("versions", {}) if isinstance(found, dict) else {}
    rows = [(name, str(version)) for name, version in versions.items()]
    return html.section(
        "reproduce",
        "How to reproduce and cite",
        html.again(result.parameters, result.model),
        html.folded("Versions", html.table(("program", "version"), rows)) if rows else "",
        html.cite(str(versions.get("fingerpad", ""))),
    )


def _columns(result: Result) -> dict[str, list[Any]]:
    """Return the steps as columns in the units of tables, and the first of them that the charts of sliding show."""
    steps = result.steps
    found: dict[str, list[Any]] = {key: [getattr(state, key) for state in steps] for key in ("step", "load")}
    found |= {key: [_number(key, state) for state in steps] for key in _CHARTED}
    found |= {key: [0 if s.record is None else int(getattr(s.record, key)) for s in steps] for key in _WORK}
    return found | {"first": [max(len(before_sliding(steps)) - 1, 0) if steps else 0]}


def _errors(result: Result) -> list[dict[str, Any]]:
    """Return the named states with an error, for the charts of sliding."""
    found: list[dict[str, Any]] = []
    for name, state in result.named.items():
        if state.error.known():
            known = {key: _number(key, state) if key != "mu_app" or name == "full_slip" else None for key in _CHARTED}
            errors = {f"{key}_error": _number(key, state.error) for key in _CHARTED if key != "bone_x"}
            found.append({"name": called(name, state.voltage)} | known | errors)
    return found


def _number(key: str, of: ContactState | Errors) -> float | None:
    value = STEPS[key].scale * getattr(of, key)
    return float(f"{value:.6g}") + 0.0 if math.isfinite(value) else None
