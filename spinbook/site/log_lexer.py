"""Highlights the logs of nodes: warnings and errors stand out, times and names are muted."""

from __future__ import annotations

from typing import ClassVar

from pygments.lexer import RegexLexer, bygroups
from pygments.token import Comment, Generic, Text


class LogLexer(RegexLexer):  # type: ignore[misc]
    """Highlights rcl's console output, `[SEVERITY] [node]: message`; other lines are unchanged."""

    name = "ROS log"
    aliases: ClassVar[list[str]] = ["ros-log"]
    tokens: ClassVar[dict[str, list[tuple[str, object]]]] = {
        "root": [
            (r"^(\[WARN\] )(\[[^\]\n]+\]:)(.*\n)", bygroups(Generic.Strong, Generic.Strong, Generic.Strong)),
            (r"^(\[(?:ERROR|FATAL)\] )(\[[^\]\n]+\]:)(.*\n)", bygroups(Generic.Error, Generic.Error, Generic.Error)),
            (r"^(\[(?:INFO|DEBUG)\] )(\[[^\]\n]+\]:)", bygroups(Comment, Comment)),
            (r"^—.*—\n", Generic.Emph),
            (r"^(?:Traceback .*|\w*(?:Error|Exception|Interrupt): .*|\w+Error)\n", Generic.Error),
            (r"^-+> \d+ .*\n", Generic.Strong),
            (r".*\n", Text),
        ]
    }
