"""The lines that a recorder process prints for the kernel: one JSON array per line, its kind first."""

from __future__ import annotations

import json
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from typing import Any

from ros_in_python.ros2.cli import CommandError


def write_line(kind: str, *values: Any) -> None:
    """Print one line, without buffering."""
    print(json.dumps((kind, *values)), flush=True)


def read_lines(lines: Iterable[str]) -> Iterator[tuple[str, list[Any]]]:
    """Yield the kind and the values of each line; skip whatever a library printed among them."""
    for line in lines:
        try:
            kind, *values = json.loads(line)
        except (ValueError, TypeError):
            continue
        yield kind, values


@contextmanager
def errors_written() -> Iterator[None]:
    """Write a CommandError as a line ["error", message], and end."""
    try:
        yield
    except CommandError as error:
        write_line("error", error.format_message())
