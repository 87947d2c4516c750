"""Formulas as MathML, made at build time: every present browser shows it, without a script or a font from elsewhere."""

import functools
from typing import Any

from docutils import nodes
from math_core import LatexToMathML
from sphinx.writers.html5 import HTML5Translator


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


def setup(app: Any) -> dict[str, bool]:
    """Register the renderer."""
    app.add_html_math_renderer("mathml", (inline, None), (block, None))
    return {"parallel_read_safe": True, "parallel_write_safe": True}
