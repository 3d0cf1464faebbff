"""What runs beneath a process. A process may end at any moment, also while it is asked about itself."""

from __future__ import annotations

import psutil


def runs(process: psutil.Process | int) -> bool:
    """Return whether a process, or the one of this number, has not ended yet, whether or not its parent noticed."""
    try:
        process = psutil.Process(process) if isinstance(process, int) else process
        return process.is_running() and process.status() != psutil.STATUS_ZOMBIE
    except psutil.Error:
        return False


def command_of(process: psutil.Process) -> list[str]:
    """Return the command of a process; one that has ended has none."""
    try:
        return process.cmdline()
    except psutil.Error:
        return []


def beneath(process: psutil.Process) -> list[psutil.Process]:
    """Return the processes that a process has started, and those that they have; one that has ended has none."""
    try:
        return process.children(recursive=True)
    except psutil.Error:
        return []


def workers_of(process: psutil.Process) -> list[psutil.Process]:
    """Return the grader's worker processes that run, of those that a process has started itself."""
    found = [child for child in process.children() if "grader.workers.worker" in " ".join(command_of(child))]
    return [child for child in found if child.name() != "fork server"]


def new_worker(others: list[psutil.Process]) -> psutil.Process:
    """Return the one worker process that this process has started besides the others."""
    [found] = [worker for worker in workers_of(psutil.Process()) if worker not in others]
    return found
