"""An exercise as plain data."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, Literal

from groundwork.problem import AuthorError, Problem

Direction = Literal["subscribe", "publish"]
Reliability = Literal["reliable", "best_effort"]
Durability = Literal["volatile", "transient_local"]

#: What the program does with a service or an action.
Role = Literal["service", "client", "action", "action_client"]


@dataclass(frozen=True)
class Qos:
    """Quality of service of one endpoint of a topic: keep the last `depth` messages."""

    reliability: Reliability = "reliable"
    durability: Durability = "volatile"
    depth: int = 10


@dataclass(frozen=True)
class Elements:
    """What one element of a message's lists is `called`, such as a wheel; the list `named_by` contains their names."""

    called: str
    named_by: str


@dataclass(frozen=True)
class Topic:
    """One topic of the student's program, as the program sees it.

    `name` begins with a slash, `type` is written `package/msg/Name`. `units` gives the unit of a field, such as `{"x":
    "m"}`. `depth`, `reliability` and `durability` are what the task asks for.
    """

    name: str
    type: str
    direction: Direction
    depth: int = 10
    units: dict[str, str] = field(default_factory=dict)
    reliability: Reliability = "reliable"
    durability: Durability = "volatile"
    elements: Elements | None = None

    @property
    def qos(self) -> Qos:
        """Return the QoS that the task asks for."""
        return Qos(self.reliability, self.durability, self.depth)


@dataclass(frozen=True)
class ServiceOrAction:
    """A service or an action that the student's program serves (`role` "service", "action") or calls."""

    name: str
    type: str
    role: Role
    units: dict[str, str] = field(default_factory=dict)


@dataclass(frozen=True)
class Parameter:
    """A parameter of the student's node.

    `type` is one of rclpy's, in lower case, such as "double" or "string_array". `range` is the lowest and the highest
    value that the task allows.
    """

    name: str
    type: str
    default: Any = None
    unit: str = ""
    range: tuple[float, float] | None = None


@dataclass(frozen=True)
class ProgramFile:
    """One of several programs of a submission: a file, and the node that it creates."""

    file: str
    node: str
    class_name: str = ""


#: The file that a student's copy has instead of scenarios and a solution: see `grader.grading.public`.
PUBLIC_FILE = "public.json"

#: The files of an exercise's folder that a submission may not be called: a student's copy has both.
OWN_FILES = ("checks.py", "hidden_checks.py", "scenarios.py")

#: The name of the grader's own node, which has the reference publishers, servers and clients.
REFERENCE_NODE = "reference"


@dataclass(frozen=True)
class Exercise:
    """One folder of `exercises/`, as data.

    `task` is the text for the student, in Markdown. `points` is the sum of all checks' points. `solution_folder` holds
    the author's solution, and is None in a student's copy of the course. With `public_only` the hidden checks are left
    out, as in a student's copy. `programs` are the programs of a submission with several; `class_name` and `node_name`
    are then those of the first. `packages` are packages from PyPI that programs may use, such as "scipy==1.16.3".
    `advice` maps the name of an exception, such as "KeyError", to a sentence for students whose program ended with it.
    `nodes` are the full names of the nodes that a launch file must start, if the submission is one: then `node_name` is
    the first of them. With `count_hints`, the upload says how many further hints a student took. With `many_answers`,
    checks judge by properties that other answers than the solution's have, too.
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
    endpoints: tuple[ServiceOrAction, ...] = ()
    parameters: tuple[Parameter, ...] = ()
    programs: tuple[ProgramFile, ...] = ()
    reference_node: str = REFERENCE_NODE
    advice: dict[str, str] = field(default_factory=dict)
    count_hints: bool = False
    packages: tuple[str, ...] = ()
    many_answers: bool = False
    nodes: tuple[str, ...] = ()

    @property
    def scenarios_file(self) -> Path:
        """Return the file that declares the scenarios."""
        return self.folder / "scenarios.py"

    @property
    def check_files(self) -> tuple[Path, ...]:
        """Return the public checks, then the hidden ones if they are present and count."""
        names = ("checks.py",) if self.public_only else ("checks.py", "hidden_checks.py")
        return tuple(file for file in (self.folder / name for name in names) if file.exists())

    @property
    def public_file(self) -> Path:
        """Return the file that a student's copy has instead of scenarios and a solution."""
        return self.folder / PUBLIC_FILE

    def public(self) -> Exercise:
        """Return the same exercise with the public checks only."""
        return replace(self, public_only=True)

    @property
    def solution_file(self) -> Path | None:
        """Return the author's solution, from which the starter is made and which must pass every check."""
        return self.solution_folder / "solution.py" if self.solution_folder else None

    @property
    def inputs(self) -> tuple[Topic, ...]:
        """Return the topics that the node subscribes to."""
        return tuple(topic for topic in self.topics if topic.direction == "subscribe")

    @property
    def outputs(self) -> tuple[Topic, ...]:
        """Return the topics that the node publishes."""
        return tuple(topic for topic in self.topics if topic.direction == "publish")

    @property
    def element_name(self) -> str:
        """Return the name of one element of the published lists."""
        return next((topic.elements.called for topic in self.outputs if topic.elements), "element")

    def of_role(self, role: Role) -> tuple[ServiceOrAction, ...]:
        """Return the services and actions with which the program does this."""
        return tuple(endpoint for endpoint in self.endpoints if endpoint.role == role)


class ExerciseError(AuthorError):
    """Raised before any student is graded, when an exercise can't be used as its author wrote it.

    `problem` says what is in the file, `fix` what was expected and what to do. `line` counts from 1, and is None if the
    problem is about the whole file.
    """

    def __init__(self, file: Path, problem: str, fix: str, line: int | None = None) -> None:
        self.problem = Problem(file, line, problem, fix)
        super().__init__(self.problem)

    def __str__(self) -> str:
        return f"{self.problem.place}: {self.problem.problem}\n    {self.problem.fix}"

    def __reduce__(self) -> tuple[type[ExerciseError], tuple[Path, str, str, int | None]]:
        """Keep the problem when the error crosses from one process to another."""
        return ExerciseError, (self.problem.file, self.problem.problem, self.problem.fix, self.problem.line)
