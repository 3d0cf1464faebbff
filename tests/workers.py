"""Which of pytest-xdist's workers runs which tests: what is dear to make is made once, and not once a worker."""

from __future__ import annotations

from pathlib import Path

from xdist.scheduler import LoadScopeScheduling

# In each of these folders the tests share something dear, a chapter that has run or a whole site.
TOGETHER = ("audit", "check", "course", "feedback", "graph", "handout", "new", "site")


class ByFolder(LoadScopeScheduling):
    """Hands out the tests of each folder of `TOGETHER` as one piece, and every other test by itself."""

    def _split_scope(self, nodeid: str) -> str:
        top, folder = Path(nodeid).parts[:2]
        if top != "tests":
            return nodeid
        return folder if folder in TOGETHER else nodeid
