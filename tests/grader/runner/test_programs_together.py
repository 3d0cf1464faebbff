"""Several programs of one submission, and an author's program next to a student's, in one run."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TypeAlias

import pytest
from scripted_programs import EXERCISE, program

from grader.exercise.exercise import ExerciseError, ProgramFile
from grader.recording import Recording
from grader.runner.program import Task
from grader.runner.run import run
from grader.sandbox import ForkServer, Limits, SandboxedProgram, choose
from grader.sandbox import ProgramSpec as Sandboxed
from grader.scenario import Companion, Program, Scenario, at
from grader.scenario.command_line import arguments
from grader.scenario.resolver import resolved
from grader.workers.pool import STUDENT_ENVIRONMENT
from interface_compiler.near import use_near

PAIR = replace(EXERCISE, programs=(ProgramFile("talker.py", "talker"), ProgramFile("listener.py", "listener")))

TALKER = program("""
        self.talk = self.create_publisher(Float64, '/in', 10)
        self.create_timer(0.1, lambda: self.talk.publish(Float64(data=1.0)))
""").replace("'student'", "'talker'")

LISTENER = program("""
        self.out = self.create_publisher(Float64, '/out', 10)
        self.create_subscription(Float64, '/in', self.out.publish, 10)
""").replace("'student'", "'listener'")

Together: TypeAlias = Callable[..., Recording]


@pytest.fixture
def together(fork_server: ForkServer) -> Together:
    """Run talker.py and listener.py; the talker is the author's own with `companion`."""
    use_near(Path(__file__).parent)
    level = choose(None)

    def run_it(scenario: Scenario, talker: str = TALKER, *, companion: bool = False) -> Recording:
        files = {"talker.py": talker.encode(), "listener.py": LISTENER.encode()}
        exercise = EXERCISE if companion else PAIR
        complete = resolved(exercise, scenario)

        def start(name: str, hub: int) -> SandboxedProgram:
            given = Sandboxed(name, files, arguments(complete), STUDENT_ENVIRONMENT, hub=hub)
            return fork_server.start(given, level, Limits())

        starts = {name: partial(start, name) for name in files}
        task = Task(exercise, complete, "listener.py", LISTENER)
        if companion:
            task = replace(task, scenario=replace(complete, companions=(Companion("talker.py", text=talker),)))
            return run(task, starts["listener.py"], companions=[starts["talker.py"]])
        return run(task, starts["listener.py"], programs=starts)

    return run_it


def heard(recording: Recording) -> list[float]:
    return [one.at for one in recording.received]


def test_two_programs_talk_to_one_another_until_one_is_killed(together: Together) -> None:
    recording = together(Scenario("s", "t", at(0.25).kill("talker.py"), duration=0.5, interrupt=True))
    assert heard(recording) == [0.0, 0.1, 0.2]
    assert [(one.program, one.by) for one in recording.exits] == [("talker.py", "grader")]
    assert recording.nodes == ("/listener", "/talker")
    assert recording.ending.outcome == "completed"
    assert recording.ending.ended_in_time


def test_a_program_may_start_later_and_again(together: Together) -> None:
    steps = (at(0.35).kill("talker.py"), at(0.45).start("talker.py"))
    recording = together(Scenario("s", "t", steps, programs=Program("talker.py", starts=0.2), duration=0.6))
    assert heard(recording) == [0.21, 0.3, 0.46, 0.5, 0.6]


def test_which_program_crashed_is_reported(together: Together) -> None:
    crashes = TALKER.replace("lambda: self.talk.publish(Float64(data=1.0))", "lambda: 1 / 0")
    ending = together(Scenario("s", "t", duration=0.5), crashes).ending
    assert ending.outcome == "crashed"
    assert "0.00 s after the start: ZeroDivisionError" in ending.message


def test_the_authors_own_program_is_heard_and_not_recorded_as_the_students(together: Together) -> None:
    recording = together(Scenario("s", "t", duration=0.2), companion=True)
    assert heard(recording) == [0.0, 0.1, 0.2]
    assert recording.nodes == ("/listener",)
    assert {one.node for one in recording.end_points} == {"/listener"}


def test_an_authors_program_that_ends_is_the_authors_error(together: Together) -> None:
    with pytest.raises(ExerciseError, match=r"talker\.py:1: it ended in the scenario s: NameError"):
        together(Scenario("s", "t", duration=0.2), "no_such_name", companion=True)
