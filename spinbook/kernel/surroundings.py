"""What surrounds a student's node in an exercise, in real time while the node runs: in notebook, terminal and page."""

from __future__ import annotations

import contextlib
from collections import Counter
from collections.abc import Callable, Iterator
from typing import Any

import rclpy
from rclpy.signals import SignalHandlerOptions

from grader.exercise.exercise import Exercise
from grader.recording.events import Call, Feedback, Goal, GoalState
from grader.recording.recording import ReceivedMessage, Recording, SentMessage
from grader.runner.real_time import RealTimeRun
from grader.scenario.command_line import arguments
from grader.scenario.scenario import SECOND, Scenario
from ros_in_python.robot import urdf
from ros_in_python.robot.urdf import RobotDescription
from spinbook.kernel.timeline import RecordedEvents, TimelineEvent

#: How many lines there are for each topic, service and goal; what comes after that is only counted.
_LINES = 4
#: What happens to a message -> what a student reads.
_KINDS = {"sent": "to your node:", "received": "from your node:"}
#: How long a message is in a line (characters).
_LONGEST = 100
#: Why some scenarios can't be tried out.
SEVERAL = "{0} starts and stops several programs, so it can only be checked."


def play(exercise: Exercise, scenario: Scenario, say: Callable[[str], None], show: Callable[[Recording], None]) -> None:
    """Play a scenario around the node that runs, to its end or until interrupted.

    `say` gets lines for the student, `show` what has happened so far, each now and then. Raises `ExerciseError` and
    `CannotContinue`.
    """
    say(f"Scenario {scenario.name}: {scenario.title} ({scenario.seconds:g} s).")
    if words := arguments(scenario, always=("--ros-args",))[1:]:
        say(f"Your node is started with: --ros-args {' '.join(words)}")
    rclpy.init(args=[], signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node(exercise.reference_node, start_parameter_services=False)
    said = Narration()

    def report(recording: Recording) -> None:
        for line in said.lines(recording):
            say(line)
        show(recording)

    try:
        run = RealTimeRun(node, exercise, scenario)
        say(f"Waiting for a node called {exercise.node_name} ...")
        if missing := run.wait_for_program():
            say(missing)
        try:
            run.play(report)
        finally:
            report(recording := run.recording())
            say(said.summary())
            for topic in exercise.outputs:
                if not any(message.topic.endswith(topic.name) for message in recording.received):
                    say(f"Your node has published nothing on {topic.name}.")
    finally:
        node.destroy_node()
        rclpy.try_shutdown()


class Narration:
    """Says in lines what has happened since the last time."""

    def __init__(self) -> None:
        self._counts: Counter[str] = Counter()

    def lines(self, recording: Recording) -> Iterator[str]:
        """Yield a line for each new event, except for those of which there are many."""
        seen: Counter[str] = Counter()
        for event in recording.timeline:
            seen[event.what] += 1
            if self._counts[event.what] < seen[event.what] <= _LINES:
                at = event.at
                yield f"{at:7.2f} s  {_in_words(event.what)}  {_content(event.what, event.item)}".rstrip()
        self._counts = seen

    def summary(self) -> str:
        """Return how often each thing happened."""
        counts = ", ".join(f"{_in_words(what)}: {count}" for what, count in self._counts.items())
        return f"Over. {counts or 'Nothing happened'}."


def _in_words(what: str) -> str:
    kind, _, name = what.partition(" ")
    return f"{_KINDS.get(kind, kind)} {name}"


def _content(what: str, value: Any) -> str:
    if isinstance(value, (SentMessage, ReceivedMessage, Feedback)):
        return _short(value.fields)
    if isinstance(value, Call):
        return _short(value.request if what.startswith("request") else value.response or {})
    if isinstance(value, Goal):
        return _short(value.goal) if what.startswith("goal") else f"{value.status} {_short(value.result or {})}"
    return value.state if isinstance(value, GoalState) else ""


def _short(fields: dict[str, Any]) -> str:
    text = ", ".join(f"{name}: {_value(value)}" for name, value in fields.items())
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}…"


def _value(value: Any) -> str:
    if isinstance(value, dict):
        return f"({_short(value)})"
    if isinstance(value, (list, tuple)):
        return f"[{', '.join(map(_value, value))}]"
    return f"{value:.4g}" if isinstance(value, float) else str(value)


def robot_of(recording: Recording) -> RobotDescription | None:
    """Return the robot that a node published last as URDF; None if it published none."""
    texts = [item.fields["data"] for item in recording.received if item.topic.endswith("/robot_description")]
    for text in reversed(texts):
        with contextlib.suppress(urdf.InvalidUrdf):
            return urdf.read(str(text))
    return None


def events_of(recording: Recording) -> RecordedEvents:
    """Return the calls and goals of a recording, otherwise its messages, as a timeline's events, with times in s."""
    recorded = RecordedEvents()
    for call in recording.calls:
        recorded.kinds[call.service] = "service"
        answers = [call.answered_ns] if call.answered_ns is not None else []
        recorded.events.append(TimelineEvent(call.at_ns / SECOND, call.service, "request"))
        recorded.events += [TimelineEvent(at / SECOND, call.service, "response") for at in answers]
    for goal in recording.goals:
        recorded.kinds[goal.action] = "action"
        recorded.events += _of_goal(goal)
    for message in () if recorded.kinds else (*recording.sent, *recording.received):
        recorded.kinds[message.topic] = "topic"
        recorded.events.append(TimelineEvent(message.at_ns / SECOND, message.topic, "message"))
    return recorded


def _of_goal(goal: Goal) -> list[TimelineEvent]:
    asked = ", ".join(f"{name} {value}" for name, value in goal.goal.items())
    steps: list[tuple[int | None, str]] = [(state.at_ns, state.state.upper()) for state in goal.states]
    steps += [(feedback.at_ns, "feedback") for feedback in goal.feedback]
    steps += [(goal.answered_ns, "rejected")] if goal.accepted is False else []
    for cancel in goal.cancels:
        steps += [(cancel.at_ns, "cancel"), (cancel.answered_ns, "cancel answered")]
    return [
        TimelineEvent(goal.at_ns / SECOND, goal.action, "goal", str(goal.number), asked),
        *(TimelineEvent(at / SECOND, goal.action, step, str(goal.number)) for at, step in steps if at is not None),
    ]
