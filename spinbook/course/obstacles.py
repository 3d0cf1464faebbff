"""What keeps a course's cells from running. Each cause is listed once, the most frequent first."""

from __future__ import annotations

from collections.abc import Iterable, Iterator, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

from groundwork.problem import Problem, Severity

#: The words for each kind of cause: group -> singular and plural. Any other group is a package.
_WORDS = {
    "a real shell": (
        "shell fence needs a real shell (a pipe, or a command that is not ROS's)",
        "shell fences need a real shell",
    ),
    "a definition": (
        "chapter has snippets that use undefined names",
        "chapters have snippets that use undefined names",
    ),
    "a file name": ("chapter has nodes without a file name", "chapters have nodes without a file name"),
    "files that are not there": ("link leads to a file that is not there", "links lead to files that are not there"),
    "headings that no chapter has": (
        "link leads to a heading that is not there",
        "links lead to headings that are not there",
    ),
    "macros": ("macro of a book's tool is shown as it is", "macros of a book's tool are shown as they are"),
    "files to include": ("file to include is not there", "files to include are not there"),
    "labels that no chapter has": (
        "reference leads to a label that no chapter has",
        "references lead to labels that no chapter has",
    ),
    "relative imports": ("node imports relative to a package", "nodes import relative to a package"),
    "programs that no fence shows": (
        "command starts a program that no fence shows",
        "commands start programs that no fence shows",
    ),
    "the name of a program": (
        "command starts a program by a name that no fence gives it",
        "commands start programs by names that no fence gives them",
    ),
    "packages that no fence shows": ("command builds what no cell makes", "commands build what no cell makes"),
    "names that nothing makes": (
        "command asks for a name that nothing makes",
        "commands ask for names that nothing makes",
    ),
    "launch files": ("command launches a file that no fence shows", "commands launch files that no fence shows"),
    "files of parameters": ("command reads a file of parameters", "commands read files of parameters"),
    "keys from a terminal": ("command reads keys from a terminal", "commands read keys from a terminal"),
    "C++ packages": ("command makes a package for C++", "commands make packages for C++"),
}


@dataclass(frozen=True)
class Obstacle:
    """One cause. `problems` are the places where it occurs."""

    group: str
    problems: tuple[Problem, ...]

    @property
    def blocks(self) -> bool:
        """Whether something is not run because of it."""
        return any(problem.severity is Severity.NOT_RUN for problem in self.problems)

    @property
    def chapters(self) -> tuple[Path, ...]:
        """The chapters in which it occurs."""
        return tuple(dict.fromkeys(problem.file for problem in self.problems))

    @property
    def unlocks(self) -> int:
        """The number of places with no other cause."""
        return len({(problem.file, problem.line) for problem in self.problems if problem.alone})

    @property
    def in_words(self) -> str:
        """One line: how often it occurs, and what to do."""
        places = {(problem.file, problem.line) for problem in self.problems}
        one, many = _WORDS.get(self.group, (f"fence needs {self.group}", f"fences need {self.group}"))
        count = len(places)
        only = f", {self.unlocks} of them nothing else," if self.unlocks < count else ""
        where = f" in {len(self.chapters)} chapters" if len(self.chapters) > 1 else f" in {self.chapters[0]}"
        where = "" if many.startswith("chapters") and count > 1 else where
        return f"{count:4} {one if count == 1 else many}{only}{where}. {self.problems[0].fix}"


def obstacles(problems: Iterable[Problem]) -> list[Obstacle]:
    """Return the shared causes: first those that keep most cells from running, last those that block nothing."""
    groups: dict[str, list[Problem]] = {}
    for problem in problems:
        if problem.group:
            groups.setdefault(problem.group, []).append(problem)
    causes = [Obstacle(group, tuple(of)) for group, of in groups.items()]
    return sorted(causes, key=lambda item: (not item.blocks, -item.unlocks, -len(item.problems), item.group))


def by_itself(problems: Iterable[Problem]) -> Iterator[Problem]:
    """Return the problems that are listed one by one, because each has its own cause."""
    return (problem for problem in problems if not problem.group)


def ranked(problems: Sequence[Problem]) -> list[str]:
    """Return the lines of a report of all causes; none if there are none."""
    causes = obstacles(problems)
    blocking = [item.in_words for item in causes if item.blocks]
    others = [item.in_words for item in causes if not item.blocks]
    lines = ["Shown but not run, with the cause that would unlock most first:", *blocking] if blocking else []
    return [*lines, *(["To look at:", *others] if others else [])]


def strict(problem: Problem) -> Problem:
    """Return the problem as `--strict` treats it: code that is not run is an error."""
    return replace(problem, severity=Severity.ERROR) if problem.severity is Severity.NOT_RUN else problem
