"""Where the course's files can be read and opened: its repository, at the commit that this build saw."""

from __future__ import annotations

import re
import subprocess
from dataclasses import dataclass
from pathlib import Path

from grader.child_process import run_program

_GITHUB = re.compile(r"https://github\.com/([\w.-]+)/([\w.-]+?)(?:\.git)?/?")
_GIT_LIMIT_S = 10


@dataclass(frozen=True)
class Repository:
    """A course's repository. `url` is empty where the course names none, `commit` where git knows none."""

    root: Path
    url: str
    commit: str = ""
    date: str = ""
    """The commit's day, as in 2026-01-31."""

    @property
    def github(self) -> tuple[str, str] | None:
        """Owner and name, where the repository is on GitHub."""
        match = _GITHUB.fullmatch(self.url)
        return (match.group(1), match.group(2)) if match else None

    def link(self, file: Path, line: int | None = None) -> str:
        """The address of a line of a file of the course, or "" where there is no repository.

        It names the commit that changed the file last, so that it still leads to the same line when the file has
        changed since, and stays the same when other files change. A file with changes of its own that are in no
        commit yet is linked where it will be, on the main branch.
        """
        if not self.url:
            return ""
        commit = self._last_commit_of(file) or "main"
        # Without plain=1 GitHub renders Markdown, which has no lines.
        plain = "?plain=1" if file.suffix == ".md" and line else ""
        return f"{self.url}/blob/{commit}/{file.as_posix()}{plain}{f'#L{line}' if line else ''}"

    def _last_commit_of(self, file: Path) -> str:
        if not self.commit or _git(self.root, "status", "--porcelain", "--", file.as_posix()):
            return ""
        return _git(self.root, "log", "-1", "--format=%H", "--", file.as_posix())


def repository_of(root: Path, url: str) -> Repository:
    """What git and course.toml say of the course in `root`."""
    known = _git(root, "log", "-1", "--format=%H %cs").split()
    return Repository(root, url.rstrip("/"), *known[:2])


def _git(root: Path, *words: str) -> str:
    """What git prints, or "" where there is no git or no repository."""
    try:
        ran = run_program(["git", *words], _GIT_LIMIT_S, cwd=root)
    except (OSError, subprocess.TimeoutExpired):
        return ""
    return ran.stdout.strip() if ran.returncode == 0 else ""
