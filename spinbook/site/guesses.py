"""Questions to guess before the output is seen: "**Guess before you look.**", a list of options, code, and an answer.

In a chapter, and in its notebook, they are plain Markdown. On a page the options can be chosen; outputs and answer are
folded until one is, or until the reader runs the code. Style sheets do this, so that it also works without scripts.
"""

from __future__ import annotations

from collections.abc import Iterator
from html import escape
from itertools import takewhile
from typing import Any

from docutils import nodes
from sphinx.transforms import SphinxTransform
from sphinx.util import logging

BEGINNING = "Guess before you look"
_DETAILS, _END = "<details", "</details>"
_UNKNOWN = "I don’t know"
_WAIT = "The output and the answer show when you have chosen, or run the code."
_LOG = logging.getLogger(__name__)


class AskGuesses(SphinxTransform):
    """Makes the options of each question choices, and folds what follows up to the end of its answer."""

    default_priority = 450

    def apply(self, **kwargs: Any) -> None:
        """Change the document's questions."""
        questions = [node for node in self.document.findall(nodes.paragraph) if _asks(node)]
        for number, question in enumerate(questions, 1):
            _ask(question, f"guess-{number}")


def _asks(paragraph: nodes.paragraph) -> bool:
    first = next((child for child in paragraph.children if child.astext()), None)
    return isinstance(first, nodes.strong) and first.astext().startswith(BEGINNING)


def _ask(question: nodes.paragraph, name: str) -> None:
    parent = question.parent
    after = parent.children[parent.index(question) + 1 :]
    between = list(takewhile(lambda node: not _is_raw(node, _DETAILS), after))
    answer = list(takewhile(lambda node: not _is_raw(node, _END), after[len(between) :]))
    if not between or not isinstance(between[0], nodes.bullet_list) or len(between) + len(answer) == len(after):
        found = 'after "%s" there must be a list of options, and <details> with the answer'
        _LOG.warning(found, BEGINNING, location=question)
        return
    options = between[0]
    texts = [item.astext() for item in options]
    right = _right(answer)
    if right not in texts:
        found = "the answer must begin with the right option in bold. It begins with %r; the options are %s"
        _LOG.warning(found, right, ", ".join(map(repr, texts)), location=question)
    question["ids"].append(f"{name}-question")
    opening = (
        f'<div class="guess" id="{name}" data-question="{escape(question.astext())}" data-right="{escape(right)}">'
    )
    opening += f'<fieldset role="radiogroup" aria-labelledby="{name}-question">'
    parent.insert(parent.index(options), nodes.raw("", opening, format="html"))
    answer[0].replace_self(
        nodes.raw("", answer[0].astext().replace(_DETAILS, '<details class="answer"', 1), format="html")
    )
    end = after[len(between) + len(answer)]
    end.replace_self(nodes.raw("", f"{end.astext()}</div>", format="html"))
    options.replace_self(list(_choices(options, name)))


def _is_raw(node: nodes.Node, beginning: str) -> bool:
    return isinstance(node, nodes.raw) and node.astext().lstrip().startswith(beginning)


def _right(answer: list[nodes.Node]) -> str:
    """Return the text in bold with which an answer begins, without its full stop."""
    bold = next((node for part in answer for node in part.findall(nodes.strong)), None)
    return bold.astext().rstrip(".") if bold else ""


def _choices(options: nodes.bullet_list, name: str) -> Iterator[nodes.Node]:
    for item in options:
        choice = f'<label><input type="radio" name="{name}" value="{escape(item.astext())}"> '
        words = [child for block in item for child in block.children]
        yield from (nodes.raw("", choice, format="html"), nodes.inline("", "", *words))
        yield nodes.raw("", "</label>", format="html")
    unknown = f'<label><input type="radio" name="{name}" value="?"> <span>{_UNKNOWN}</span></label>'
    told = '<p class="guess-told" role="status"></p>'
    yield nodes.raw("", f'{unknown}</fieldset>{told}<p class="guess-wait">{_WAIT}</p>', format="html")
