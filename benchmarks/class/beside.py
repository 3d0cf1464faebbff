"""Runs a command of low priority beside steps that run one after another, and shows what it prints after theirs.

    python benchmarks/class/beside.py 'COMMAND ...' 'STEP ...' 'STEP ...'

A step that fails ends everything at once, and its exit code is ours; otherwise COMMAND's is. Ctrl-C and SIGTERM end
everything, too.
"""

from __future__ import annotations

import contextlib
import os
import shlex
import signal
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import Any

#: Nodes that run in real time get the cores when they need them, and COMMAND what they leave, which is most.
NICENESS = 10
#: How often COMMAND's output is shown once the steps are done (s).
EVERY_S = 0.3


def main(command: str, *steps: str) -> int:
    """Run all; return the exit code."""
    signal.signal(signal.SIGTERM, lambda *_: sys.exit(128 + signal.SIGTERM))
    with tempfile.NamedTemporaryFile() as log, contextlib.suppress(KeyboardInterrupt):
        into_log: Any = {"stdout": log, "stderr": subprocess.STDOUT, "preexec_fn": lambda: os.nice(NICENESS)}
        with started(command, **into_log) as beside:
            for step in steps:
                print(step, flush=True)
                if code := run(step):
                    print(f"`{step}` ended with {code}, so the rest was stopped: {command}", flush=True)
                    return code
            print(command, flush=True)
            return show(Path(log.name), beside)
    return 128 + signal.SIGINT


def run(step: str) -> int:
    """Run a command; return its exit code."""
    with started(step) as process:
        return process.wait()


def show(log: Path, process: subprocess.Popen[bytes]) -> int:
    """Show what a process has printed into a file, and what it prints until it ends; return its exit code."""
    with log.open("rb") as printed:
        while True:
            code = process.poll()
            sys.stdout.buffer.write(printed.read())
            sys.stdout.flush()
            if code is not None:
                return code
            with contextlib.suppress(subprocess.TimeoutExpired):
                process.wait(EVERY_S)


@contextlib.contextmanager
def started(command: str, **options: Any) -> Iterator[subprocess.Popen[bytes]]:
    """Start a command; it has ended when the block is left. Ctrl-C reaches it as well, so that it can tidy up."""
    process = subprocess.Popen(shlex.split(command), **options)
    try:
        yield process
    except KeyboardInterrupt:
        process.wait()
        raise
    finally:
        process.terminate()
        process.wait()


if __name__ == "__main__":
    sys.exit(main(*sys.argv[1:]))
