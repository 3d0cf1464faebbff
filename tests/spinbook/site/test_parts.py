"""A long chapter is divided into parts, each of which begins where a reader can tell what it belongs to."""

from __future__ import annotations

from docutils import nodes
from docutils.core import publish_doctree

from spinbook.site.parts import divide

WORDS = "word " * 400
CHAPTER = f"""
Title
=====

Long
----

First
~~~~~

{WORDS}

Second
~~~~~~

{WORDS}

Short
-----

{WORDS}
"""


def lengths(document: nodes.document) -> list[str]:
    openings = [raw.astext() for raw in document.findall(nodes.raw) if 'class="part-place"' in raw.astext()]
    return [opening.partition("about ")[2].partition("<")[0] for opening in openings]


def test_a_part_that_begins_within_a_section_repeats_its_heading() -> None:
    document = publish_doctree(CHAPTER, settings_overrides={"doctitle_xform": False})

    divide(document, {"long": 40, "short": 15})

    openings = [raw.astext() for raw in document.findall(nodes.raw) if 'class="part-place"' in raw.astext()]
    assert [opening.partition("</p>")[2] for opening in openings] == [
        "",
        '<h2 class="part-within">Long, continued</h2>',
        "",
    ]


def test_a_long_beginning_of_a_section_is_a_part_without_the_first_subsection() -> None:
    chapter = f"Title\n=====\n\nLong\n----\n\n{WORDS * 4}\n\nFirst\n~~~~~\n\n{WORDS}\n\nNext\n----\n\n{WORDS}\n"
    document = publish_doctree(chapter, settings_overrides={"doctitle_xform": False})

    divide(document, {"long": 25, "next": 10})

    assert lengths(document) == ["20 minutes", "15 minutes"]


def test_a_short_section_joins_a_neighbour() -> None:
    chapter = "Title\n=====\n\n" + "".join(f"{name}\n-----\n\nWords.\n\n" for name in ("First", "Small", "Third"))
    document = publish_doctree(chapter, settings_overrides={"doctitle_xform": False})

    divide(document, {"first": 15, "small": 6, "third": 20})

    assert lengths(document) == ["21 minutes", "20 minutes"]
