"""Shows the glossary's sections as a definition list, with links to the letters from A to Z."""

from __future__ import annotations

from html import escape

from docutils import nodes
from sphinx.application import Sphinx

from spinbook.site.page import GLOSSARY


def define_terms(app: Sphinx, document: nodes.document, page: str) -> None:
    """Replace the sections of the glossary. The search reads them before that."""
    top = next(document.findall(nodes.section), None)
    if page != GLOSSARY or top is None:
        return
    sections = [child for child in top.children if isinstance(child, nodes.section)]
    if sections:
        at = top.index(sections[0])
        rest = [child for child in top.children[at:] if child not in sections]
        terms = nodes.definition_list("", *map(_term, sections), classes=["terms"])
        top[at:] = [nodes.raw("", _letters(sections), format="html"), terms, *rest]


def _term(section: nodes.section) -> nodes.definition_list_item:
    title, *definition = section.children
    term = nodes.term("", "", *title.children, ids=section["ids"])
    return nodes.definition_list_item("", term, nodes.definition("", *definition))


def _letters(sections: list[nodes.section]) -> str:
    first: dict[str, str] = {}
    for section in sections:
        first.setdefault(section.astext()[0].upper(), section["ids"][0])
    links = "".join(f'<li><a href="#{escape(anchor)}">{escape(letter)}</a></li>' for letter, anchor in first.items())
    return f'<nav class="letters" aria-label="A to Z"><ul>{links}</ul></nav>'
