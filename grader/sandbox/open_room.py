"""The place of a student's program where there are no namespaces: a temporary folder, and a list of its processes."""

from __future__ import annotations

import contextlib
import os
import shutil
import signal
import tempfile
import time
from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path

from .processes import descendants
from .program import Place


@dataclass(frozen=True)
class OpenRoom:
    """What `Room` is with namespaces. The keeper itself adopts the student's orphans (see PR_SET_CHILD_SUBREAPER)."""

    folder: Path
    init: int = field(default_factory=os.getpid)
    holders: frozenset[int] = frozenset()

    def kill(self) -> None:
        """Kills what the student has started. What it starts meanwhile is found by `bury`."""
        alive = descendants(self.init)
        for order in (signal.SIGSTOP, signal.SIGKILL):  # first nobody forks any more
            for process in alive:
                with contextlib.suppress(ProcessLookupError):
                    os.kill(process, order)

    def bury(self) -> None:
        """Returns when all is dead, and removes the folder."""
        while descendants(self.init):
            self.kill()
            with contextlib.suppress(ChildProcessError):
                while os.waitpid(-1, os.WNOHANG)[0]:
                    pass
            time.sleep(0.001)
        shutil.rmtree(self.folder, ignore_errors=True)


def make_place(files: Mapping[str, bytes], owner: int | None, hub: Path | None) -> Place:
    """Makes a folder in the machine's temporary folder, with the submission's files and a home.

    Args:
        files: name to content.
        owner: the user that the home is given to; None for the present one.
        hub: the hub's socket, which the program sees where it is.
    """
    top = Path(tempfile.mkdtemp(prefix="spinbook-student-"))
    top.chmod(0o755)
    submission, home, temporary = top / "submission", top / "home", top / "tmp"
    for folder in (submission, home, temporary):
        folder.mkdir(mode=0o755)
        if owner is not None and folder is not submission:
            os.chown(folder, owner, owner)
    for name, content in files.items():
        (submission / name).write_bytes(content)
        (submission / name).chmod(0o444)
    return Place(str(submission), str(home), str(temporary), str(hub) if hub else None)
