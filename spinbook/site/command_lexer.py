"""Highlights commands by what their words mean in ROS: command, option, topic, type and value."""

from __future__ import annotations

import re
from collections.abc import Iterator

from pygments.lexers.shell import BashLexer
from pygments.token import Keyword, Name, Number, Text

_MEANINGS = (
    (re.compile(r"--?[a-zA-Z][\w-]*"), Name.Attribute),
    (re.compile(r"-?[\d.]+"), Number),
    (re.compile(r"\w+/(?:msg|srv|action)/\w+"), Name.Class),
    (re.compile(r"/[\w/]*|~/\w+"), Name.Variable),
    (re.compile(r"\w+:"), Name.Attribute),
)
#: How many words say what a command does: `ros2 topic list`, `ros2 run`, `colcon build`.
_WORDS_OF = {"ros2": 3, "colcon": 2}


class CommandLexer(BashLexer):  # type: ignore[misc]
    """Highlights a shell's commands as Bash's lexer does, and in addition the words that have a meaning in ROS."""

    def get_tokens_unprocessed(self, text: str) -> Iterator[tuple[int, object, str]]:
        """Yield the place, kind and text of each part."""
        left = 0
        for index, token, value in super().get_tokens_unprocessed(text):
            line_before = text[text.rfind("\n", 0, index) + 1 : index]
            if token not in (Text, Name.Builtin):
                yield index, token, value
                continue
            if not line_before.strip():
                left = _WORDS_OF.get(value, 1)
            meaning = next((kind for pattern, kind in _MEANINGS if pattern.fullmatch(value)), Text)
            yield index, Keyword if left > 0 and meaning is Text else meaning, value
            left = 0 if value in ("run", "launch") else left - 1
