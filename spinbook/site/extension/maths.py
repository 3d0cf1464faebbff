"""Maths as MathML, which browsers draw and screen readers read without any script."""

from __future__ import annotations

from docutils import nodes
from latex2mathml.converter import convert
from sphinx.util import logging
from sphinx.writers.html5 import HTML5Translator

_LOG = logging.getLogger(__name__)


def visit_inline(translator: HTML5Translator, node: nodes.math) -> None:
    """`$…$` in a line."""
    translator.body.append(_mathml(node, "inline"))
    raise nodes.SkipNode


def visit_block(translator: HTML5Translator, node: nodes.math_block) -> None:
    """`$$…$$`, on a line of its own."""
    translator.body.append(f'<div class="math">{_mathml(node, "block")}</div>\n')
    raise nodes.SkipNode


def _mathml(node: nodes.Element, display: str) -> str:
    text = node.astext()
    try:
        return str(convert(text, display=display))
    except Exception as error:  # the library raises many kinds, for what an author wrote
        _LOG.warning("this is no LaTeX that can be read: %s (%s)", text, error, location=node)
        return f"<code>{node.astext()}</code>"
