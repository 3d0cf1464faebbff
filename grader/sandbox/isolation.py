"""How well a student's program is isolated from this machine, and which levels this machine offers."""

from __future__ import annotations

import os
import subprocess
import sys
from enum import Enum
from functools import cache

from grader.sandbox import filesystem, trials
from grader.sandbox.program import SandboxUnavailable

_TRIAL_S = 30.0


class Isolation(str, Enum):
    """The levels, strongest first. docs/sandbox.md says what each of them keeps apart."""

    BUBBLEWRAP = "bubblewrap"
    """Namespaces of its own, made by bubblewrap."""
    NAMESPACES = "namespaces"
    """The same namespaces, made by our own system calls."""
    LANDLOCK = "landlock"
    """No namespaces: the kernel's Landlock for files, seccomp for the network (over Fast DDS only a ROS domain)."""
    NONE = "none"
    """A plain process of the same user, with limits. For code that you trust."""

    def __str__(self) -> str:
        """Return the word that is used on the command line and in a grade."""
        return self.value


def available() -> dict[Isolation, str | None]:
    """Return None for each level that works here, otherwise the reason in words. Tries them by starting programs."""
    return {level: _tried(level) for level in Isolation}


def choose(wanted: Isolation | None = None) -> Isolation:
    """Return the level to use: the wanted one, or the strongest that works here. Never NONE unless it is wanted.

    Raises:
        SandboxUnavailable: if the wanted level, or without a wish every level, does not work here.
    """
    if wanted is not None:
        reason = _reason_against(wanted)
        if reason is not None:
            raise SandboxUnavailable(f"The sandbox '{wanted}' does not work on this machine: {reason}.")
        return wanted
    reasons = []
    for level in (Isolation.BUBBLEWRAP, Isolation.NAMESPACES, Isolation.LANDLOCK):
        reason = _reason_against(level)
        if reason is None:
            return level
        reasons.append(f"\n  {level}: {reason}")
    raise SandboxUnavailable(
        "No sandbox works on this machine, so students' code will not be run." + "".join(reasons) + "\n"
        "Allow user namespaces, or use a kernel with Landlock (5.13 or newer). If you trust the code, --isolation none "
        "runs it without a sandbox."
    )


def _reason_against(level: Isolation) -> str | None:
    """None where the level works, or has worked under the same circumstances; else the reason in words."""
    if trials.has_worked(level.value):
        return None
    reason = _tried(level)
    if reason is None:
        trials.keep(level.value)
    return reason


@cache
def _tried(level: Isolation) -> str | None:
    if not sys.platform.startswith("linux"):
        return None if level is Isolation.NONE else "it needs Linux"
    environment = {name: os.environ[name] for name in filesystem.RUNTIME_VARIABLES if name in os.environ}
    try:
        trial = subprocess.run(
            [sys.executable, "-m", "grader.sandbox.trial", level.value],
            env=environment,
            capture_output=True,
            text=True,
            timeout=_TRIAL_S,
            check=False,
        )
    except (OSError, subprocess.TimeoutExpired) as fault:
        return f"trying it failed: {fault}"
    if trial.returncode == 0:
        return None
    lines = (trial.stdout.strip() or trial.stderr.strip()).splitlines()
    return lines[-1] if lines else f"trying it ended with {trial.returncode}"
