"""Being stopped from outside: Ctrl-C, or a notebook that ends a bounded command."""

from __future__ import annotations

import signal
import threading
from types import FrameType

#: What the real command exits with after Ctrl-C (it passes on the number of the signal).
EXIT_AFTER_SIGINT = int(signal.SIGINT)


class Stopped(KeyboardInterrupt):
    """Raised in the main thread when SIGINT or SIGTERM came."""

    def __init__(self, number: int) -> None:
        super().__init__()
        #: Exit status: 2 after SIGINT as the real command's, 0 after SIGTERM.
        self.exit_code = EXIT_AFTER_SIGINT if number == signal.SIGINT else 0


def listen() -> None:
    """Make SIGINT and SIGTERM raise `Stopped`, for the rest of this process's life.

    SIGINT is set even where it was ignored (a shell ignores it for what it starts in the background), because a
    notebook stops its commands with it. Only the first signal is raised: cleaning up is not interrupted by the
    second, and a SIGTERM during it ends the process at once.
    """
    if threading.current_thread() is not threading.main_thread():
        return
    signal.signal(signal.SIGINT, _stop)
    signal.signal(signal.SIGTERM, _stop)


def _stop(number: int, frame: FrameType | None) -> None:
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    signal.signal(signal.SIGTERM, signal.SIG_DFL)
    raise Stopped(number)
