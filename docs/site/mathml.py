"""Formulas as MathML, made at build time: every present browser shows it, without a script or a font from elsewhere.

The site has its own mathematical font, STIX Two Math (SIL Open Font License 1.1, named in the font), from the package
ziamath. Many systems have none, and their browsers then show boxes for italic Greek letters.
"""

import functools
import logging
from importlib.metadata import distribution
from pathlib import Path
from typing import Any

from docutils import nodes
from math_core import LatexToMathML
from sphinx.writers.html5 import HTML5Translator

_CHARACTERS = (  # first and last: Latin, Greek, punctuation, arrows and operators, brackets, bold and italic letters
    *((0x20, 0xFF), (0x300, 0x3FF), (0x2000, 0x22FF), (0x2308, 0x230B), (0x27E6, 0x27EB)),
    *((0x1D400, 0x1D49B), (0x1D6A4, 0x1D755), (0x1D7CE, 0x1D7D7)),
)


@functools.cache
def _converter() -> LatexToMathML:
    return LatexToMathML()


def mathml(latex: str, displaystyle: bool) -> str:
    """Return a formula as a <math> element; raises LatexError for one that is no LaTeX."""
    return _converter().convert_with_local_state(latex, displaystyle=displaystyle)


def inline(self: HTML5Translator, node: nodes.math) -> None:
    """Write a formula in a line."""
    self.body.append(mathml(node.astext(), displaystyle=False))
    raise nodes.SkipNode


def block(self: HTML5Translator, node: nodes.math_block) -> None:
    """Write a formula by itself; one wider than the window can be scrolled."""
    self.body.append(f'<div class="math" tabindex="0">{mathml(node.astext(), displaystyle=True)}</div>\n')
    raise nodes.SkipNode


def font(app: Any, error: Exception | None) -> None:
    """Write the characters of formulas in the font to the site's static files: 200 kB instead of 1.5 MB."""
    from fontTools import subset

    logging.getLogger("fontTools").setLevel(logging.WARNING)
    options = subset.Options(flavor="woff", layout_features=["*"], name_IDs=["*"], hinting=False)
    whole = subset.load_font(str(distribution("ziamath").locate_file("ziamath/fonts/STIXTwoMath-Regular.ttf")), options)
    part = subset.Subsetter(options)
    part.populate(unicodes=[code for first, last in _CHARACTERS for code in range(first, last + 1)])
    part.subset(whole)
    subset.save_font(whole, str(Path(app.outdir) / "_static" / "math.woff"), options)


def setup(app: Any) -> dict[str, bool]:
    """Register the renderer."""
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    app.connect("build-finished", font)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
