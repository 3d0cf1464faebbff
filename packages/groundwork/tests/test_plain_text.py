"""Every text can be printed, whatever the encoding of a terminal or a pipe is."""

from __future__ import annotations

import os
import subprocess
import sys

import pytest

PRINT = (
    "import sys; from groundwork.plain_text import print_in_any_encoding; print_in_any_encoding()\n"
    "print('\\u2713 1 \\u2014 2 \\u2026 \\u65e5 \\udc80', file=sys.{stream})"
)


@pytest.mark.parametrize("stream", ["stdout", "stderr"])
@pytest.mark.parametrize("encoding", ["ascii", "latin-1", "cp1252", "koi8-r", "utf-8"])
def test_what_an_encoding_lacks_is_written_with_other_characters(encoding: str, stream: str) -> None:
    environment = {**os.environ, "PYTHONIOENCODING": encoding}
    command = [sys.executable, "-c", PRINT.format(stream=stream)]
    done = subprocess.run(command, env=environment, capture_output=True, check=False)
    assert done.returncode == 0, done.stderr
    printed = (done.stdout or done.stderr).decode(encoding)
    expected = {"utf-8": "✓ 1 — 2 … 日 ?\n", "cp1252": "+ 1 — 2 … ? ?\n"}
    assert printed == expected.get(encoding, "+ 1 - 2 ... ? ?\n")
