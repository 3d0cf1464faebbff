"""Tests a level of isolation by starting a program in it. Exits with 0, or prints the reason and exits with 1.

python -m grader.sandbox.trial LEVEL
"""

from __future__ import annotations

import sys

from grader.sandbox import landlock
from grader.sandbox.fork_server import ForkServer
from grader.sandbox.program import Isolation, ProgramSpec, SandboxError

_WORD = "works"
_PROGRAM = f"import rclpy.exceptions, sys\nprint({_WORD!r})\n"


def main() -> None:
    """Try the level that the command line names."""
    reason = reason_against(Isolation(sys.argv[1]))
    if reason is not None:
        print(reason.replace("\n", " "))
        sys.exit(1)


def reason_against(level: Isolation) -> str | None:
    """Return why a level does not work here; None if it does."""
    if level is Isolation.LANDLOCK and not landlock.version():
        return "the kernel has no Landlock (Linux 5.13 and newer have it, unless it is switched off)"
    try:
        # Not preloaded, to test that Python itself can be started there.
        program = ProgramSpec("trial.py", {"trial.py": _PROGRAM.encode()}, preloaded=False)
        with ForkServer(preload=()) as fork_server, fork_server.start(program, level) as student:
            end = student.wait(20.0)
            last = student.output().splitlines()[-1:]  # a module of this Python may print at each start
    except (OSError, SandboxError) as fault:
        return str(fault)
    return None if last == [_WORD] else f"a program started in it ended with {end} and printed: {last}"


if __name__ == "__main__":
    main()
