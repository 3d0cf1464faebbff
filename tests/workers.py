"""Which of pytest-xdist's workers runs which tests: what is expensive is made once, and the longest comes first."""

from __future__ import annotations

from pathlib import Path

from xdist.scheduler import LoadScopeScheduling
from xdist.workermanage import WorkerController

#: The tests of each of these folders share something that is expensive to make: a chapter that has run, a whole site.
TOGETHER = ("audit", "check", "feedback", "graph", "handout", "interfaces", "site")

#: In each of these files the tests take long and share little, so that several workers can take part.
APART = ("build/test_execution.py", "marking/test_class_run.py", "new/test_kinds.py")

#: What takes longest, in that order. It is begun first: begun last, it would leave the other workers without work.
LONGEST = ("site", "handout", "audit")


def piece_of(nodeid: str) -> str:
    """The piece of work that a test belongs to: its folder, its file, or the test alone."""
    file = Path(nodeid.partition("::")[0])
    folder, inside = file.parts[-2], "/".join(file.parts[-2:])
    if folder in TOGETHER:
        return folder
    return nodeid if inside in APART else inside


class ByPiece(LoadScopeScheduling):
    """Hands out whole pieces, the longest first, then those with the most tests."""

    def _split_scope(self, nodeid: str) -> str:
        return piece_of(nodeid)

    def _assign_work_unit(self, node: WorkerController) -> None:
        self.workqueue.move_to_end(min(self.workqueue, key=_rank), last=False)
        super()._assign_work_unit(node)


def _rank(piece: str) -> int:
    """Small for what takes long; pieces of the same rank stay in their order."""
    name = piece.partition("::")[0]
    return LONGEST.index(name) if name in LONGEST else len(LONGEST)
