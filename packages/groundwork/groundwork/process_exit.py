"""How a process ended."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class ProcessExit:
    """How a program ended.

    `code` is the exit code, None if the signal of the number `signal` ended it. `limit` is the limit that it hit: cpu,
    memory, processes, file-size, output, wall.
    """

    code: int | None
    signal: int | None = None
    limit: str | None = None
