"""A scenario: what happens around a student's program, and when."""

from __future__ import annotations

import hashlib
import json
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass, field, fields, is_dataclass
from functools import cached_property
from typing import TYPE_CHECKING, Any, Literal, TypeAlias

from grader.exercise.exercise import Qos
from grader.recording.arrays import LongArray
from grader.recording.events import Fields
from grader.scenario.code import AuthorCode, line_of_the_author
from grader.scenario.servers import ActionServer, Server
from grader.scenario.times import BEFORE_START as BEFORE_START
from grader.scenario.times import SECOND as SECOND
from grader.scenario.times import START as START
from grader.scenario.world import World

#: How often /clock is published between steps, unless the author says otherwise (Hz).
RATE = 100.0

#: What the computer's own clock shows while simulated time passes: see `grader.runner.grader_side`.
ComputerTime = Literal["apart", "simulated"]


@dataclass(frozen=True)
class Message:
    """One message of a scenario, published at `at` ns of simulated time.

    `publisher` distinguishes publishers on one topic: when it changes, the previous one disappears. Without a `type` it
    is the one that exercise.toml gives for the topic. `line` is where in scenarios.py it was made.
    """

    at: int
    topic: str
    type: str
    fields: Fields
    publisher: int = 1
    line: int = field(default_factory=line_of_the_author, compare=False, repr=False)


@dataclass(frozen=True)
class Step:
    """Something that happens at `at` ns of simulated time. `line` is where in scenarios.py it was made."""

    at: int
    line: int = field(default_factory=line_of_the_author, compare=False, repr=False, kw_only=True)


@dataclass(frozen=True)
class Request(Step):
    """The grader calls a service of the student's."""

    service: str
    type: str
    fields: Fields


@dataclass(frozen=True)
class SendGoal(Step):
    """The grader sends a goal to an action server of the student's."""

    action: str
    type: str
    fields: Fields


@dataclass(frozen=True)
class CancelGoal(Step):
    """The grader requests to cancel a goal; goals count from 1, in the order of the steps."""

    number: int


@dataclass(frozen=True)
class CancelAll(Step):
    """The grader requests to cancel every goal of an action."""

    action: str


@dataclass(frozen=True)
class SetParameter(Step):
    """The grader sets a parameter of a node. Without a `node` it is the one of exercise.toml."""

    name: str
    value: Any
    node: str = ""


@dataclass(frozen=True)
class GetParameter(Step):
    """The grader reads a parameter of a node."""

    name: str
    node: str = ""


@dataclass(frozen=True)
class Transition(Step):
    """The grader asks a node with a life cycle for a transition. Without a `node` it is the one of exercise.toml."""

    name: str
    node: str = ""


@dataclass(frozen=True)
class Subscribe(Step):
    """One of the grader's subscribers joins; what it receives is recorded under its `name`."""

    topic: str
    type: str
    name: str
    qos: Qos = field(default_factory=Qos)


@dataclass(frozen=True)
class Leave(Step):
    """A peer disappears: the server or the subscriber of this name, or the publisher on this topic."""

    name: str


@dataclass(frozen=True)
class ComeBack(Step):
    """A server that left comes back."""

    name: str


@dataclass(frozen=True)
class Kill(Step):
    """One of the submission's programs is killed."""

    program: str


@dataclass(frozen=True)
class ToWorld(Step):
    """Something happens to the world: its method of this name is called with these arguments."""

    method: str
    arguments: dict[str, Any]


@dataclass(frozen=True)
class StartProgram(Step):
    """One of the submission's programs is started."""

    program: str


@dataclass(frozen=True)
class Program:
    """One of a submission's programs, by its file: when it starts and when it is killed (s after the start).

    The same file can run several times, each time with its own `name`. `namespace`, `remappings` and `parameters` are
    for this program alone; without them, it gets those of the scenario.
    """

    file: str
    starts: float = 0.0
    killed: float | None = None
    arguments: tuple[str, ...] = ()
    name: str = ""
    namespace: str = ""
    remappings: dict[str, str] = field(default_factory=dict)
    parameters: dict[str, Any] = field(default_factory=dict)

    @property
    def id(self) -> str:
        """The name by which steps and recordings call it: its own, or its file's."""
        return self.name or self.file


@dataclass(frozen=True)
class Companion:
    """A program of the author's that runs next to the student's: a file in the exercise's folder.

    `text` is what is in the file, and `modules` the texts of the files next to it that it imports, by their names; both
    are read together with the scenarios.
    """

    file: str
    arguments: tuple[str, ...] = ()
    text: str = field(default="", repr=False)
    modules: dict[str, str] = field(default_factory=dict, repr=False)


Content: TypeAlias = Message | Step

#: Messages and steps, in tuples of tuples as deep as an author likes.
Nested: TypeAlias = Content | Iterable["Nested"]


@dataclass(frozen=True)
class Scenario:
    """What one run of a program consists of.

    `name` is the fixture by which checks ask for its recording, `title` says in words what happens. `messages` takes
    messages and steps, in nested tuples and in any order; the scenario moves the steps to `steps`.

    `duration` is how long simulated time lasts (s), and `rate` how often /clock is published meanwhile (Hz). Without
    both, a scenario that only publishes has its clock set for each message.

    `parameters`, `remappings`, `namespace` and `arguments` are given to the program when it starts. `servers` and
    `world` are its surroundings; `qos` says what the reference publisher on a topic offers. `programs` says when
    each of several programs starts, and `companions` are the author's own.

    With `interrupt` the program is asked to end by Ctrl-C at the end.

    `computer_time` says what the computer's clock shows to the program, and what `time.sleep` and wall timers take:
    "simulated" is the same as simulated time; "apart" is more, 1.25 s for each simulated second, so a node that
    measures with the wrong clock gets a different value.
    """

    name: str
    title: str
    messages: tuple[Message, ...] = ()
    interrupt: bool = False
    computer_time: ComputerTime = "apart"
    duration: float = 0.0
    rate: float | None = None
    parameters: dict[str, Any] = field(default_factory=dict)
    remappings: dict[str, str] = field(default_factory=dict)
    namespace: str = ""
    arguments: tuple[str, ...] = ()
    servers: tuple[Server | ActionServer, ...] = ()
    world: World | None = None
    qos: dict[str, Qos] = field(default_factory=dict)
    programs: tuple[Program, ...] = ()
    companions: tuple[Companion, ...] = ()
    steps: tuple[Step, ...] = ()
    line: int = field(default_factory=line_of_the_author, compare=False, repr=False)

    if TYPE_CHECKING:
        # The constructor accepts more than the fields store: single values for tuples, and nested tuples.
        def __init__(
            self,
            name: str,
            title: str,
            messages: Nested = (),
            interrupt: bool = False,
            computer_time: ComputerTime = "apart",
            duration: float = 0.0,
            rate: float | None = None,
            parameters: dict[str, Any] = ...,
            remappings: dict[str, str] = ...,
            namespace: str = "",
            arguments: tuple[str, ...] = (),
            servers: Server | ActionServer | Iterable[Server | ActionServer] = (),
            world: World | None = None,
            qos: dict[str, Qos] = ...,
            programs: Program | Iterable[Program] = (),
            companions: Companion | Iterable[Companion] = (),
            steps: tuple[Step, ...] = (),
            line: int = 0,
        ) -> None: ...

    def __post_init__(self) -> None:
        """Separate messages from steps, and sort both."""
        entries = tuple(_flat(self.messages))
        steps = (*self.steps, *(one for one in entries if not isinstance(one, Message)))
        messages = tuple(one for one in entries if isinstance(one, Message))
        object.__setattr__(self, "messages", tuple(sorted(messages, key=_at)))
        object.__setattr__(self, "steps", tuple(sorted(steps, key=_at)))
        for name in ("arguments", "servers", "programs", "companions"):
            object.__setattr__(self, name, tuple(_flat(getattr(self, name))))

    @property
    def seconds(self) -> float:
        """The scenario's length in simulated seconds."""
        last = max((one.at for one in self.content), default=START)
        return max(self.duration, (last - START) / SECOND)

    @property
    def content(self) -> tuple[Content, ...]:
        """Messages and steps in the order in which they happen; those of one moment in the author's order."""
        if not self.steps:
            return self.messages
        both: tuple[Content, ...] = (*self.messages, *self.steps)
        return tuple(sorted(both, key=_at))

    @property
    def is_filter(self) -> bool:
        """Whether messages go in and come out, and nothing else happens: the clock is then set for each message."""
        more = self.steps or self.servers or self.world or self.programs or self.companions or self.qos
        if more or self.duration or self.rate is not None:
            return False
        return bool(self.messages) and min(message.at for message in self.messages) >= START

    @property
    def clock_rate(self) -> float:
        """How often /clock is published between messages and steps (Hz); 0 for a filter's scenario."""
        return 0.0 if self.is_filter else self.rate or RATE

    @property
    def size(self) -> float:
        """The amount of work, in messages: the largest scenarios run first."""
        return len(self.messages) + self.seconds * self.clock_rate

    @cached_property
    def digest(self) -> str:
        """A digest of everything in the scenario."""
        return hashlib.sha256(json.dumps(entries_of(self, _digestible), sort_keys=True).encode()).hexdigest()


def _at(one: Content) -> int:
    return one.at


def _flat(content: Any) -> Iterator[Any]:
    if isinstance(content, Iterable) and not isinstance(content, (str, bytes, dict)):
        for one in content:
            yield from _flat(one)
    else:
        yield content


def entries_of(value: Any, converted: Callable[[Any], Any]) -> Any:
    """Return a scenario, or a part of one, as dictionaries and lists, without the lines where authors wrote it.

    Each part is first `converted`. A dictionary has the name of its class as "is".
    """
    value = converted(value)
    if isinstance(value, (list, tuple)):
        return [entries_of(item, converted) for item in value]
    if isinstance(value, dict):
        return {key: entries_of(item, converted) for key, item in value.items()}
    if not is_dataclass(value):
        return value
    entries = {part.name: entries_of(getattr(value, part.name), converted) for part in fields(value)}
    entries.pop("line", None)
    return {"is": type(value).__name__, **entries}


def _digestible(value: Any) -> Any:
    """Replace long arrays by their digests, and leave out where the author's course is."""
    if isinstance(value, LongArray):
        return [value.typecode, hashlib.sha256(value).hexdigest()]
    if isinstance(value, dict):
        return {str(key): item for key, item in value.items()}
    return value.without_folder() if isinstance(value, AuthorCode) else value
