"""`spinbook try`: what surrounds a student's node in an exercise, in real time, while the node runs."""

from __future__ import annotations

import signal
from pathlib import Path

import click

from grader.exercise.exercise import Exercise
from grader.grading.public import playable
from grader.recording.recording import Recording, to_json
from grader.runner.program import CannotContinue
from grader.scenario.scenario import Scenario
from groundwork.files import write_if_changed
from spinbook.kernel.surroundings import SEVERAL, play
from spinbook.submit.hand_in import exercise_named


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
        play(loaded, chosen, click.echo, lambda recording: _keep(record, recording))
    except CannotContinue as stopped:
        click.echo(stopped.message)
    except KeyboardInterrupt:
        click.echo("Stopped.")


def scenario_named(exercise: Exercise, name: str) -> Scenario:
    """Return this scenario, or the first one. Raises `UsageError` and `ExerciseError`."""
    scenarios = playable(exercise)
    chosen = scenarios.get(name) if name else next(iter(scenarios.values()))
    if chosen is None:
        raise click.UsageError(f"{exercise.name} has no scenario {name!r}. There are: {', '.join(scenarios)}.")
    if exercise.nodes:
        raise click.UsageError(
            f"{exercise.name} asks for a launch file. Try yours with: ros2 launch {exercise.file_name}"
        )
    if chosen.programs or chosen.companions:
        raise click.UsageError(SEVERAL.format(chosen.name))
    return chosen


def _keep(file: Path | None, recording: Recording) -> None:
    if file:
        write_if_changed(file, to_json({recording.scenario: recording}))
