"""Demos as pages: a script in percent format is its prose, its code, and what it printed and drew when it was kept."""

from pathlib import Path
from typing import Any

from myst_parser.parsers.sphinx_ import MystParser

from benchmarks.notebook import cells

OUTPUT = "output"  # folder beside the demos


def markdown(script: str) -> str:
    """Return a script in percent format as Markdown."""
    parts = (text if prose else f"```python\n{text}\n```" for prose, text in cells(script))
    return "\n\n".join(parts) + "\n"


def kept(demo: Path) -> str:
    """Return the section with the kept output of a demo, or where it is."""
    folder = demo.parent / OUTPUT
    text, pictures = folder / f"{demo.stem}.txt", sorted(folder.glob(f"{demo.stem}_*.png"))
    if not text.exists():
        return "\n## Output\n\n[The first page](../docs/README.md) shows what the scene prints.\n"
    shown = [f"![Picture of this demo: {p.stem.removeprefix(demo.stem + '_')}]({OUTPUT}/{p.name})" for p in pictures]
    return "\n".join(["", "## Output", "", "```text", text.read_text(encoding="utf-8").strip(), "```", "", *shown, ""])


class Percent(MystParser):
    """Parses a script as the page that it is."""

    supported = ("percent",)

    def parse(self, inputstring: str, document: Any) -> None:
        """Fill the document with the script's prose, code and kept output."""
        super().parse(markdown(inputstring) + kept(Path(document["source"])), document)
