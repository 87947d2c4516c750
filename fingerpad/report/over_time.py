"""The section of a report on loads over time: extremes, means and the spectrum of friction."""

from fingerpad.io.over_time import HARMONICS, NOTE
from fingerpad.io.result import Result
from fingerpad.report import page as html

_MM, _MS = 1e3, 1e3


def section(result: Result) -> str:
    """Return extremes, means and the spectrum of friction of loads over time; nothing without such a load."""
    rows, spectra = [], []
    for load in result.loads:
        passed, friction = load.over_time, load.extremes["f_t"]
        if passed is None:
            continue
        ends = ((friction.min, friction.min_time), (friction.max, friction.max_time))
        rows.append(
            (
                load.name, f"{_MS * passed.seconds:.4g}", f"{passed.mean['f_t']:.4g}",
                *(f"{value:.4g} at {_MS * time:.4g} ms" for value, time in ends),
                f"{_MM * passed.mean['contact_length']:.4g}",
            )
        )  # fmt: skip
        largest = sorted(zip(passed.f_t_amplitude, passed.frequency, strict=True), reverse=True)[:HARMONICS]
        amplitudes = sorted((frequency, value) for value, frequency in largest)
        spectra += [(load.name, f"{frequency:.4g}", f"{value:.4g}") for frequency, value in amplitudes]
    if not rows:
        return ""
    heads = ("load", "length (ms)", "mean f_T (N/m)", "least f_T (N/m)", "largest f_T (N/m)", "mean L_R (mm)")
    spectrum = html.table(("load", "frequency (Hz)", "amplitude of f_T (N/m)"), spectra) if spectra else ""
    return html.section("time", "Loads over time", html.paragraph(NOTE), html.table(heads, rows), spectrum)
