"""Links and comments are found where markdown-it finds them: never in code."""

from __future__ import annotations

import pytest

from spinbook.chapter.comments import without_comments
from spinbook.chapter.links import linked, links_in
from spinbook.site.prose import terms_of


def to_notebook(target: str, is_image: bool) -> str | None:
    return target.replace(".md", ".ipynb") if target.endswith(".md") and not is_image else None


@pytest.mark.parametrize(
    ("markdown", "expected"),
    [
        ('See [topics](03-nodes.md "Topics").', 'See [topics](03-nodes.ipynb "Topics").'),
        ("See [topics](<03-nodes.md> 'Topics').", "See [topics](03-nodes.ipynb 'Topics')."),
        ("[topics][1]\n\n[1]: 03-nodes.md", "[topics][1]\n\n[1]: 03-nodes.ipynb"),
        ('[topics]\n\n[topics]: 03-nodes.md "Topics"', '[topics]\n\n[topics]: 03-nodes.ipynb "Topics"'),
        ("- > *[a](a.md)* and [b](b.md)", "- > *[a](a.ipynb)* and [b](b.ipynb)"),
        ("| a |\n| - |\n| [a](a.md) |", "| a |\n| - |\n| [a](a.ipynb) |"),
        ('<a href="a.md">a</a>', '<a href="a.ipynb">a</a>'),
        ("![a.md](a.md)", "![a.md](a.md)"),
    ],
)
def test_the_target_of_a_link_is_replaced(markdown: str, expected: str) -> None:
    assert linked(markdown, to_notebook) == expected


def test_a_footnote_is_no_link() -> None:
    assert links_in("One[^1] and [two](b.md).\n\n[^1]: Really\n") == (("b.md", 1),)


@pytest.mark.parametrize(
    "markdown",
    [
        "Write `[topics](03-nodes.md)` for a link.",
        "```markdown\n[topics](03-nodes.md)\n\n[1]: 03-nodes.md\n```",
        "Text\n\n    [topics](03-nodes.md)\n",
        "- ~~~\n  [topics](03-nodes.md)\n  ~~~",
        "\\[topics](03-nodes.md)",
    ],
)
def test_what_looks_like_a_link_in_code_stays(markdown: str) -> None:
    assert linked(markdown, to_notebook) == markdown


@pytest.mark.parametrize(
    ("markdown", "shown"),
    [
        ("One.\n<!-- note -->\nTwo.", "One.\nTwo."),
        ("One <!-- note --> two.", "One  two."),
        ("a <!-- one\n\ntwo --> b", "a\n b"),
        ("One.\n<!-- a\n\n```python\nb\n```\n-->\nTwo.", "One.\nTwo."),
        ("<div>\n<!-- a\n\n-->\n</div>\n", "<div>\n</div>\n"),
        ("One. <!-- never closed\n\nTwo.", "One."),
        ("`x` <!-- 1 --> ``<!-- `2` -->`` <!-- 3 -->", "`x`  ``<!-- `2` -->``"),
        ("- ~~~\n  <!-- code -->\n  ~~~\n- <!-- note -->a", "- ~~~\n  <!-- code -->\n  ~~~\n- a"),
    ],
)
def test_comments_are_taken_out(markdown: str, shown: str) -> None:
    assert without_comments(markdown) == shown
    assert without_comments(markdown, keep_lines=True).count("\n") == markdown.count("\n")


@pytest.mark.parametrize(
    "markdown",
    [
        "Write `<!-- exercise: x -->` here.",
        "> > Write `<!-- a`, then `-->`.",
        "```html\n<!-- shown -->\n```",
        "Text\n\n    <!-- shown -->\n",
        "````\n```\n<!-- never closed\n````\n\nText.",
    ],
)
def test_a_comment_in_code_stays(markdown: str) -> None:
    assert without_comments(markdown) == markdown


def test_the_terms_of_a_glossary_are_its_headings_of_the_second_level() -> None:
    text = (
        "# Glossary\n\n## Node\n\nText.\n\n```bash\n## not a term\n```\n\nQuality of service (QoS)\n---\n\n### Deeper\n"
    )

    assert [term.forms[0] for term in terms_of(text)] == ["Node", "Quality of service"]
