"""An exercise as plain data."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path

from grader.exercise.interface import Endpoint, Parameter, ProgramFile, Topic

#: What the grader's own node is called, on which the reference publishers, servers and clients are.
REFERENCE_NODE = "reference"


@dataclass(frozen=True)
class Exercise:
    """One folder of `exercises/`, read.

    `task` is the text for the student, in Markdown. `points` is what all checks give together.
    `solution_folder` holds the author's solution, and is None in a student's copy of the course. With `public_only` the
    hidden checks are left out, as in a student's copy. `programs` are the several programs in one submission, if it
    has any; `class_name` and `node_name` are then those of the first.
    """

    name: str
    folder: Path
    title: str
    points: float
    file_name: str
    class_name: str
    node_name: str
    task: str
    topics: tuple[Topic, ...]
    solution_folder: Path | None
    public_only: bool = False
    endpoints: tuple[Endpoint, ...] = ()
    parameters: tuple[Parameter, ...] = ()
    programs: tuple[ProgramFile, ...] = ()
    reference_node: str = REFERENCE_NODE

    @property
    def scenarios_file(self) -> Path:
        """The file that declares what the node is spun against."""
        return self.folder / "scenarios.py"

    @property
    def check_files(self) -> tuple[Path, ...]:
        """The public checks, then the hidden ones where they are present and count."""
        names = ("checks.py",) if self.public_only else ("checks.py", "hidden_checks.py")
        return tuple(file for file in (self.folder / name for name in names) if file.exists())

    @property
    def public_file(self) -> Path:
        """What a student's copy has in place of scenarios and a solution: see `grader.grading.public`."""
        return self.folder / "public.json"

    def public(self) -> Exercise:
        """The same exercise with the public checks only."""
        return replace(self, public_only=True)

    @property
    def solution_file(self) -> Path | None:
        """The author's solution, from which the starter is made and which every check must pass."""
        return self.solution_folder / "solution.py" if self.solution_folder else None

    @property
    def inputs(self) -> tuple[Topic, ...]:
        """The topics that the node subscribes."""
        return tuple(topic for topic in self.topics if topic.direction == "subscribe")

    @property
    def outputs(self) -> tuple[Topic, ...]:
        """The topics that the node publishes."""
        return tuple(topic for topic in self.topics if topic.direction == "publish")

    @property
    def services(self) -> tuple[Endpoint, ...]:
        """The services that the program serves."""
        return tuple(one for one in self.endpoints if one.role == "service")

    @property
    def clients(self) -> tuple[Endpoint, ...]:
        """The services that the program calls."""
        return tuple(one for one in self.endpoints if one.role == "client")

    @property
    def actions(self) -> tuple[Endpoint, ...]:
        """The actions that the program serves."""
        return tuple(one for one in self.endpoints if one.role == "action")

    @property
    def action_clients(self) -> tuple[Endpoint, ...]:
        """The actions that the program sends goals to."""
        return tuple(one for one in self.endpoints if one.role == "action_client")
