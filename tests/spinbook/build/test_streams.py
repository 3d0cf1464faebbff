"""What cells print is joined to what a terminal would show, in a time that grows with its length only."""

from __future__ import annotations

from typing import Any

from nbformat.v4 import new_output

from spinbook.build.streams import as_in_a_terminal, joined


def stream(name: str, text: str) -> Any:
    return new_output("stream", name=name, text=text)


def test_pieces_of_a_stream_are_joined_and_stdout_comes_first() -> None:
    picture = new_output("display_data", data={"text/plain": "a picture"})
    pieces = [stream("stderr", "w1 "), stream("stdout", "a"), picture, stream("stdout", "b"), stream("stderr", "w2")]

    assert joined(pieces) == [stream("stdout", "ab"), stream("stderr", "w1 w2"), picture]


def test_progress_bars_and_backspaces_end_as_in_a_terminal() -> None:
    assert as_in_a_terminal("10 %\r20 %\nab\bc\nend\r\n") == "20 %\nac\nend\n"


def test_a_line_of_a_megabyte_is_joined_piece_by_piece() -> None:
    pieces = [stream("stdout", "x" * 1000) for _ in range(1000)]

    assert joined(pieces) == [stream("stdout", "x" * 1_000_000)]
