"""Steps as an author writes them: `at(1.0).call("/add", a=1, b=2)` reads "at 1.0 s, call /add with a 1 and b 2"."""

from __future__ import annotations

from collections.abc import Callable
from numbers import Real
from typing import Any, TypeVar

from grader.exercise.exercise import Durability, Qos, Reliability
from grader.scenario.scenario import (
    CancelAll,
    CancelGoal,
    ComeBack,
    GetParameter,
    Kill,
    Leave,
    Message,
    Request,
    SendGoal,
    SetParameter,
    StartProgram,
    Subscribe,
    ToWorld,
    Transition,
)
from grader.scenario.times import BEFORE_START, SECOND, START

One = TypeVar("One")


class At:
    """Some instants (ns of simulated time). Each method makes a step for each of them."""

    def __init__(self, instants: tuple[int, ...]) -> None:
        self._instants = instants

    def _each(self, make: Callable[[int], One]) -> tuple[One, ...]:
        return tuple(make(instant) for instant in self._instants)

    def publish(self, topic: str, type: str = "", /, **fields: Any) -> tuple[Message, ...]:
        """Publish a message with these fields; the others have their defaults."""
        return self._each(lambda instant: Message(instant, topic, type, fields))

    def call(self, service: str, type: str = "", /, **fields: Any) -> tuple[Request, ...]:
        """Call a service of the student's."""
        return self._each(lambda instant: Request(instant, service, type, fields))

    def send_goal(self, action: str, type: str = "", /, **fields: Any) -> tuple[SendGoal, ...]:
        """Send a goal to an action server of the student's. Goals count from 1, in the order in which they are sent."""
        return self._each(lambda instant: SendGoal(instant, action, type, fields))

    def cancel(self, number: int) -> tuple[CancelGoal, ...]:
        """Request to cancel goal `number`."""
        return self._each(lambda instant: CancelGoal(instant, number))

    def cancel_all(self, action: str) -> tuple[CancelAll, ...]:
        """Request to cancel every goal of an action."""
        return self._each(lambda instant: CancelAll(instant, action))

    def set_parameter(self, name: str, value: Any, node: str = "") -> tuple[SetParameter, ...]:
        """Set a parameter, of the exercise's node or of another one by its full name."""
        return self._each(lambda instant: SetParameter(instant, name, value, node))

    def get_parameter(self, name: str, node: str = "") -> tuple[GetParameter, ...]:
        """Read a parameter."""
        return self._each(lambda instant: GetParameter(instant, name, node))

    def transition(self, name: str, node: str = "") -> tuple[Transition, ...]:
        """Ask a node with a life cycle to `configure`, `activate`, `deactivate`, `cleanup` or `shutdown`."""
        return self._each(lambda instant: Transition(instant, name, node))

    def subscribe(
        self,
        topic: str,
        type: str = "",
        /,
        *,
        name: str,
        reliability: Reliability = "reliable",
        durability: Durability = "volatile",
        depth: int = 10,
    ) -> tuple[Subscribe, ...]:
        """Join as a subscriber called `name`."""
        return self._each(lambda instant: Subscribe(instant, topic, type, name, Qos(reliability, durability, depth)))

    def leave(self, name: str) -> tuple[Leave, ...]:
        """Remove a publisher or a server by its topic or service, or a subscriber by its name."""
        return self._each(lambda instant: Leave(instant, name))

    def come_back(self, name: str) -> tuple[ComeBack, ...]:
        """Bring a server back."""
        return self._each(lambda instant: ComeBack(instant, name))

    def world(self, method: str, /, **arguments: Any) -> tuple[ToWorld, ...]:
        """Call a method of the world's, such as MuJoCo's `push`."""
        return self._each(lambda instant: ToWorld(instant, method, arguments))

    def kill(self, program: str) -> tuple[Kill, ...]:
        """Kill one of the submission's programs."""
        return self._each(lambda instant: Kill(instant, program))

    def start(self, program: str) -> tuple[StartProgram, ...]:
        """Start one of the submission's programs."""
        return self._each(lambda instant: StartProgram(instant, program))


def at(*seconds: float) -> At:
    """Return steps for these instants (s after the start). Raises ValueError for what is no such time."""
    for second in seconds:
        if isinstance(second, bool) or not isinstance(second, Real) or not second >= 0:
            raise ValueError(f"at({second!r}): give seconds after the start, such as at(1.5)")
    return At(tuple(START + round(second * SECOND) for second in seconds))


class _BeforeStart:
    """The time before the student's program starts."""

    def publish(self, topic: str, type: str = "", /, **fields: Any) -> tuple[Message, ...]:
        """Publish a message that only a subscription with transient local durability will get."""
        return At((BEFORE_START,)).publish(topic, type, **fields)


before_start = _BeforeStart()
