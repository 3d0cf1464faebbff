"""No line ends within what belongs together."""

from __future__ import annotations

from docutils import nodes
from docutils.core import publish_doctree

from spinbook.site.unbroken import KeepTogether


def test_code_stays_with_its_punctuation_and_keys_stay_whole() -> None:
    document = publish_doctree("Type ``a-b``, then (``c``) and ``d`` or *press Ctrl-C*.\n\n``Ctrl-C``")

    KeepTogether(document).apply()

    together = [part.astext() for part in document.findall(nodes.inline) if "unbroken" in part["classes"]]
    assert together == ["a-b,", "(c)", "Ctrl-C"]
    assert document.astext().startswith("Type a-b, then (c) and d or press Ctrl-C.")
