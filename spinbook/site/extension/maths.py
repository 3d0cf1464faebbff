"""Maths as MathML, which browsers draw and screen readers read without any script."""

from __future__ import annotations

import re

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


#: Functions that LaTeX sets upright, with a thin space around them (The TeXbook, chapter 18: "Op" atoms).
_NAMES = "arccos|arcsin|arctan|arg|cos|cosh|cot|det|dim|exp|gcd|inf|ker|lim|ln|log|max|min|sec|sin|sinh|sup|tan|tanh"
_OPERATOR = re.compile(
    rf"(?P<before></m(?:i|n|row|sup|sub|frac|sqrt)>)?"
    rf"(?P<name><mi>(?:{_NAMES})</mi>|<m(?P<script>sup|sub)><mi>(?:{_NAMES})</mi>.*?</m(?P=script)>)"
    rf"(?P<after>(?=<m(?:i|n|row|sup|sub|frac|sqrt)>))?"
)
_THIN = '<mspace width="0.167em" />'


def spaced(mathml: str) -> str:
    """Put the thin spaces around names of functions that the library leaves out: 0.5 sin t, and not 0.5sint."""
    return _OPERATOR.sub(_with_spaces, mathml)


def _with_spaces(match: re.Match[str]) -> str:
    before = f"{match['before']}{_THIN}" if match["before"] else ""
    return f"{before}{match['name']}{_THIN if match['after'] is not None else ''}"


def _mathml(node: nodes.Element, display: str) -> str:
    text = node.astext()
    try:
        return spaced(str(convert(text, display=display)))
    except Exception as error:  # the library raises many kinds, for what an author wrote
        _LOG.warning("this is no LaTeX that can be read: %s (%s)", text, error, location=node)
        return f"<code>{node.astext()}</code>"
