"""A syntax tree is walked to its end, whatever else reads it."""

from __future__ import annotations

import ast
from typing import cast

from spinbook.chapter.syntax import descendants


def test_a_tree_ends_where_ipython_has_linked_it_to_its_parents() -> None:
    tree = ast.parse("a + b")
    # IPython does this for each traceback. All trees share the node of an operator.
    plus = cast("ast.BinOp", cast("ast.Expr", tree.body[0]).value).op
    vars(plus)["parent"] = tree
    try:
        assert [type(node).__name__ for node in descendants(ast.parse("c + d"))] == [
            "Module", "Expr", "BinOp", "Name", "Add", "Name",
        ]  # fmt: skip
    finally:
        del vars(plus)["parent"]
