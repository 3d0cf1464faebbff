"""Programs with several threads get the same recording each time, whatever the kind, even next to busy loops."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
from busy_loops import busy
from scripted_programs import (
    ACTION_CLIENT,
    ACTION_SERVER,
    EXERCISE,
    FILTER_WITH_GAIN,
    GO_TO_GOAL,
    LATCHED_PUBLISHER,
    PUBLISHER,
    SERVICE_CLIENT,
    SERVICE_SERVER,
    program,
    ready,
)

from grader.recording import Recording
from grader.runner.program import Task
from grader.runner.run import run
from grader.sandbox import ForkServer, Limits, ProgramSpec, SandboxedProgram, choose
from grader.scenario import ActionServer, Scenario, Server, Turtle, World, at, no_reply, reply, succeeds
from grader.scenario.command_line import arguments
from grader.workers.pool import STUDENT_ENVIRONMENT
from interface_compiler.near import use_near

RUNS, LOOPS = 10, 4

SCRIPT = succeeds(2.0, {"sequence": [1, 2]}, {0.5: {"sequence": [1]}, 1.0: {"sequence": [1, 2]}}, cancel_takes=0.3)

CASES = {
    "publisher": (PUBLISHER, Scenario("s", "t", duration=1.0)),
    "service server": (SERVICE_SERVER, Scenario("s", "t", at(0.5, 1.0, 1.0).call("/switch", data=True))),
    "service client": (
        SERVICE_CLIENT,
        Scenario(
            "s", "t", servers=Server("/lamp", replies=(reply(success=True), reply(0.3), no_reply())), duration=2.0
        ),
    ),
    "action server": (
        ACTION_SERVER,
        Scenario("s", "t", (at(0.5, 1.0).send_goal("/count", order=4), at(1.7).cancel(2)), duration=3.0),
    ),
    "action client": (ACTION_CLIENT, Scenario("s", "t", servers=ActionServer("/climb", goals=SCRIPT), duration=2.0)),
    "parameters": (
        FILTER_WITH_GAIN,
        Scenario("s", "t", (at(0.5, 1.5).publish("/in", data=2.0), at(1.0).set_parameter("gain", 3.0))),
    ),
    "closed loop": (GO_TO_GOAL, Scenario("s", "t", world=World(Turtle, x=5.0, y=7.0), duration=3.0)),
    "latched": (
        LATCHED_PUBLISHER,
        Scenario("s", "t", at(1.0).subscribe("/text", name="late", durability="transient_local"), duration=1.5),
    ),
}


def recorded(fork_server: ForkServer, name: str) -> Recording:
    use_near(Path(__file__).parent)
    body, scenario = CASES[name]
    source, complete, level = program(body, threads=4), ready(scenario), choose(None)

    def start(hub: int) -> SandboxedProgram:
        given = ProgramSpec("node.py", {"node.py": source.encode()}, arguments(complete), STUDENT_ENVIRONMENT, hub=hub)
        return fork_server.start(given, level, Limits())

    found = run(Task(EXERCISE, complete, "node.py", source), start)
    return replace(found, log="", seconds=0.0, lockstep_seconds=0.0)


@pytest.mark.soak
@pytest.mark.parametrize("name", CASES)
def test_a_program_with_threads_gets_the_same_recording_each_time(fork_server: ForkServer, name: str) -> None:
    found = [recorded(fork_server, name) for _ in range(RUNS // 2)]
    with busy(LOOPS):
        found += [recorded(fork_server, name) for _ in range(RUNS // 2)]
    assert all(one == found[0] for one in found)
