"""Keeps the machine busy beside a test, or a benchmark."""

from __future__ import annotations

import os
import subprocess
import sys
from collections.abc import Iterator
from contextlib import contextmanager


@contextmanager
def busy(loops: int, nice: int = 0) -> Iterator[None]:
    """Run that many processes that compute without an end, or until this process is killed."""
    code = f"import os; os.nice({nice})\nwhile os.getppid() == {os.getpid()}: sum(range(100_000))"
    command = [sys.executable, "-c", code]
    # Linux shares its cores by session: eight loops of one session would get no more than one program.
    processes = [subprocess.Popen(command, start_new_session=True) for _ in range(loops)]
    try:
        yield
    finally:
        for process in processes:
            process.kill()
            process.wait()
