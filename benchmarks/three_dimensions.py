"""What docs/newtons.md has on fingers in three dimensions: all comparisons, and that of benchmarks/solid.py."""

from pathlib import Path

from benchmarks import harness
from fingerpad.slices import errors

COMPARISONS = {"ridged, 200 V": errors.ONCE, "smooth, earlier": errors.EARLIER, "smooth, below": errors.SMOOTH}
_LEAST = 0.3  # N: below it a few elements are in contact, and areas are coarse


def comparisons() -> str:
    """Return what :mod:`fingerpad.slices.errors` has, by quantity and range of force."""
    rows = []
    for key, words in errors.COMPARED.items():
        for of, comparison in COMPARISONS.items():
            points = comparison.get(key, ())
            if points:
                low, high = (100 * end(each[k] for _, each in points) for k, end in ((0, min), (1, max)))
                rows.append([words, of, f"{points[0][0]:.2g} to {points[-1][0]:.2g}", f"{low:+.3g} to {high:+.3g}"])
    return harness.table(("quantity", "comparison", "force (N)", "sum of slices less the finger (%)"), rows)


def section(docs: Path) -> str:
    """Return the comparison with a finger in three dimensions, empty without docs/solid.json."""
    if not (docs / "solid.json").exists():
        return ""
    rows, shares = [], {"force": [], "area": [], "same": []}  # type: ignore[var-annotated]
    for each in harness.kept("solid", docs).numbers:
        ratios = (
            each["f_ext_slices"] / each["f_ext"] - 1, each["area_slices"] / each["area"] - 1,
            each["area_slices_at_force"] / each["area"] - 1,
        )  # fmt: skip
        for kind, ratio in zip(shares, ratios, strict=True):
            if kind == "force" or each["f_ext"] > _LEAST:
                shares[kind].append(100 * ratio)
        width = f"{1e3 * each['f_ext'] / each['centre']:.1f}"
        cells = (f"{each['f_ext']:.3f}", f"{each['centre']:.1f}", width, f"{1e6 * each['area']:.0f}")
        rows.append([f"{1e3 * each['depth']:.1f}", *cells, *(f"{100 * ratio:+.1f}" for ratio in ratios)])
    heads = ("δ (mm)", "force (N)", "centre (N/m)", "their ratio (mm)", "area (mm²)")
    errors = ("slices: force at equal δ (%)", "area at equal δ (%)", "area at equal force (%)")
    ends = {f"{kind}_{end}": of(each) for kind, each in shares.items() for end, of in (("low", min), ("high", max))}
    text = harness.prose("newtons")["solid"].format(least=_LEAST, **ends)
    return f"## A finger in three dimensions\n\n{text}\n\n{harness.table((*heads, *errors), rows)}"
