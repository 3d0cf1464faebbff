"""Which of pytest-xdist's workers runs which tests: expensive set-up is done once, and the longest tests come first."""

from __future__ import annotations

from pathlib import Path

from xdist.scheduler import LoadScopeScheduling
from xdist.workermanage import WorkerController

#: All tests of one file run in one worker. So do those of each of these folders, whose files share something that is
#: expensive to make: a chapter that has run, a whole site, a class that was graded, a sandbox at each level.
TOGETHER = (
    *("audit", "classroom", "graph", "handout", "hostile", "interface_compiler", "interfaces"),
    *("report", "sandbox", "site", "submit"),
)

#: What takes longest, in this order: pieces, and folders whose files are pieces. It is started first: started last, it
#: would leave the other workers idle.
LONGEST = (
    *("audit", "classroom", "site", "handout", "interface_compiler", "interfaces", "sandbox", "submit"),
    "kernel/test_commands.py",
    *("build/test_execution.py", "grading/test_solutions.py", "gradescope", "grading/test_course_solutions.py"),
    *(
        "hostile",
        "kernel",
        "report",
        "grading",
        "ros_in_python",
        "runner",
        "new",
    ),
    *("style", "graph", "chapters", "browser", "doctor", "package", "setup", "build", "rcl_python"),
)


def piece_of(nodeid: str) -> str:
    """Return the piece of work that a test belongs to: a folder or package of `TOGETHER`, or its file."""
    *folders, file = Path(nodeid.partition("::")[0]).parts
    folder = folders[1] if folders[0] == "packages" else folders[-1]
    return folder if folder in TOGETHER else f"{folder}/{file}"


class ByPiece(LoadScopeScheduling):
    """Hands out whole pieces, the longest first, then those with the most tests."""

    def _split_scope(self, nodeid: str) -> str:
        return piece_of(nodeid)

    def _assign_work_unit(self, node: WorkerController) -> None:
        self.workqueue.move_to_end(min(self.workqueue, key=_rank), last=False)
        super()._assign_work_unit(node)


def _rank(piece: str) -> int:
    """Return a small number for what takes long; pieces of the same rank keep their order."""
    folder = piece.partition("/")[0]
    found = [LONGEST.index(name) for name in (piece, folder) if name in LONGEST]
    return min(found, default=len(LONGEST))
