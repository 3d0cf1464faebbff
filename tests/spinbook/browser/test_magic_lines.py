"""The magics of a page take the words and options of a notebook's, and say the same about wrong ones."""

from __future__ import annotations

import re
from pathlib import Path

import pytest

import spinbook.browser
from spinbook.kernel.magics import SpinbookMagics
from spinbook.package.cell_line import CellFailed

SCRIPT = Path(spinbook.browser.__file__).with_name("static") / "magic_line.js"
USAGES = dict(re.findall(r'^  (\w+): "(.*)",$', SCRIPT.read_text(encoding="utf-8"), re.MULTILINE))


@pytest.mark.parametrize("name", ["nodes", "stop", "log", "plot", "timeline", "turtle", "robot", "graph"])
def test_a_magic_has_the_same_usage_in_page_and_notebook(name: str) -> None:
    with pytest.raises(CellFailed) as refused:
        getattr(SpinbookMagics(None, None), name)("word --no-such-option")  # type: ignore[arg-type]
    usage = " ".join(str(refused.value).partition("usage: ")[2].split())
    assert usage == f"%{name} {USAGES[name]}"
