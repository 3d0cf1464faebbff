"""What Spinbook adds to Sphinx: how code cells, terms, maths and pictures become HTML."""

from __future__ import annotations

from typing import Any

from sphinx.application import Sphinx

from spinbook.site.extension import body, cells, maths, sections, terms
from spinbook.site.log_lexer import LogLexer

NAME = "spinbook.site.extension"


def setup(app: Sphinx) -> dict[str, Any]:
    """Called by Sphinx. Each module adds what its name says."""
    app.add_config_value("spinbook_terms", [], "env")
    app.add_lexer("ros-log", LogLexer)
    app.add_html_math_renderer("mathml", (maths.visit_inline, None), (maths.visit_block, None))
    app.add_transform(cells.DescribeCells)
    app.add_transform(terms.LinkTerms)
    app.connect("builder-inited", sections.no_index_of_sphinx)
    app.connect("source-read", body.depend)
    app.connect("html-page-context", body.finish)
    app.connect("build-finished", sections.write)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
