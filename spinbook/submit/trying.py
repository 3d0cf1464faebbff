"""`spinbook try`: what surrounds a student's node in an exercise, in real time, while the node runs."""

from __future__ import annotations

import signal
from collections import Counter
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import click
import rclpy
from rclpy.signals import SignalHandlerOptions

from grader.exercise.exercise import Exercise, ExerciseError
from grader.grading.public import playable
from grader.recording.events import Call, Feedback, Goal, GoalState
from grader.recording.recording import ReceivedMessage, Recording, SentMessage, to_json
from grader.runner.program import CannotContinue
from grader.runner.real_time import RealTimeRun
from grader.scenario.command_line import arguments
from grader.scenario.scenario import SECOND, START, Scenario
from groundwork.files import write_if_changed
from spinbook.problem import SpinbookError
from spinbook.submit.hand_in import exercise_named

#: How many lines there are for each topic, service and goal; what comes after that is only counted.
_LINES = 4
#: What happens to a message -> what a student reads.
_KINDS = {"sent": "to your node:", "received": "from your node:"}
#: How long a message is in a line (characters).
_LONGEST = 100


@click.command("try", context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("exercise")
@click.argument("scenario", required=False, default="")
@click.option("--record", type=click.Path(path_type=Path), hidden=True, help="Where to write what has happened so far.")
def try_out(exercise: str, scenario: str, record: Path | None) -> None:
    """Play what surrounds your node in EXERCISE, in real time: its publishers, servers, clients or world.

    \b
      spinbook try go_to_goal          plays the first scenario; start your node in a second terminal
      spinbook try go_to_goal behind   plays another one

    It prints what your node gets and what it does, judges nothing, and ends by itself or with Ctrl-C. In a notebook,
    %try starts your node, too, and draws what happens.

    Exit codes: 0 played, 1 the exercise can't be played, 2 wrong usage.
    """
    signal.signal(signal.SIGTERM, signal.default_int_handler)
    loaded = exercise_named(exercise)
    try:
        chosen = scenario_named(loaded, scenario)
        _play(loaded, chosen, record)
    except ExerciseError as error:
        raise SpinbookError(error.problem) from None
    except CannotContinue as stopped:
        click.echo(stopped.message)
    except KeyboardInterrupt:
        click.echo("Stopped.")


def scenario_named(exercise: Exercise, name: str) -> Scenario:
    """Return this scenario, or the first one. Raises `UsageError` and `ExerciseError`."""
    scenarios = {one.name: one for one in playable(exercise, seed=1)}
    chosen = scenarios.get(name) if name else next(iter(scenarios.values()))
    if chosen is None:
        raise click.UsageError(f"{exercise.name} has no scenario {name!r}. There are: {', '.join(scenarios)}.")
    if exercise.nodes:
        raise click.UsageError(
            f"{exercise.name} asks for a launch file. Try yours with: ros2 launch {exercise.file_name}"
        )
    if chosen.programs or chosen.companions:
        raise click.UsageError(f"{chosen.name} starts and stops several programs, so it can only be checked.")
    return chosen


def _play(exercise: Exercise, scenario: Scenario, record: Path | None) -> None:
    click.echo(f"Scenario {scenario.name}: {scenario.title} ({scenario.seconds:g} s).")
    if words := arguments(scenario, always=("--ros-args",))[1:]:
        click.echo(f"Your node is started with: --ros-args {' '.join(words)}")
    rclpy.init(signal_handler_options=SignalHandlerOptions.NO)
    node = rclpy.create_node(exercise.reference_node, start_parameter_services=False)
    said = Narration()

    def report(recording: Recording) -> None:
        for line in said.lines(recording):
            click.echo(line)
        if record:
            write_if_changed(record, to_json({scenario.name: recording}))

    try:
        run = RealTimeRun(node, exercise, scenario)
        click.echo(f"Waiting for a node called {exercise.node_name} ...")
        if missing := run.wait_for_program():
            click.echo(missing)
        try:
            run.play(report)
        finally:
            report(recording := run.recording())
            click.echo(said.summary())
            for topic in exercise.outputs:
                if not any(message.topic.endswith(topic.name) for message in recording.received):
                    click.echo(f"Your node has published nothing on {topic.name}.")
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
                at = (event.at - START) / SECOND
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
