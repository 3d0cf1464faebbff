"""Programs of every kind run through scenarios of every kind: what happens is recorded, with its simulated time."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

import pytest
from scripted_programs import (
    ACTION_CLIENT,
    ACTION_SERVER,
    BLOCKING_CLIENT,
    EXERCISE,
    FILTER_WITH_GAIN,
    FLOAT,
    GO_TO_GOAL,
    LATCHED_PUBLISHER,
    LATCHED_SUBSCRIBER,
    PUBLISHER,
    SERVICE_CLIENT,
    SERVICE_SERVER,
    program,
    ready,
)

from grader.exercise import ExerciseError
from grader.recording import Call, Recording
from grader.runner.program import Task
from grader.runner.run import run
from grader.sandbox import ForkServer, Limits, ProgramSpec, SandboxedProgram, choose
from grader.scenario import (
    ActionServer,
    JointChain,
    Qos,
    Scenario,
    Server,
    Turtle,
    World,
    aborts,
    at,
    before_start,
    never_ends,
    no_reply,
    rejects,
    reply,
    succeeds,
)
from grader.scenario.command_line import arguments
from grader.workers.pool import STUDENT_ENVIRONMENT
from interface_compiler.near import use_near

Scripted: TypeAlias = Callable[..., Recording]


@pytest.fixture(scope="module", autouse=True)
def compiled_interfaces() -> None:
    use_near(Path(__file__).parent)


@pytest.fixture
def scripted(fork_server: ForkServer) -> Scripted:
    """Run a program's source through a scenario, as its author wrote it."""
    level = choose(None)

    def run_it(source: str, scenario: Scenario, outcome: str = "completed") -> Recording:
        complete = ready(scenario)

        def start(hub: int) -> SandboxedProgram:
            given = ProgramSpec(
                "node.py", {"node.py": source.encode()}, arguments(complete), STUDENT_ENVIRONMENT, hub=hub
            )
            return fork_server.start(given, level, Limits())

        found = run(Task(EXERCISE, complete, "node.py", source), start)
        assert found.ending.outcome == outcome, found.ending.message + found.log
        return found

    return run_it


def received(recording: Recording, topic: str = "/out") -> list[tuple[float | None, object]]:
    return [(one.at, one.fields["data"]) for one in recording.received if one.topic == topic]


def answers(calls: tuple[Call, ...]) -> list[tuple[float | None, float | None, object]]:
    return [(one.at, one.answered, (one.response or {}).get("success")) for one in calls]


def test_a_timer_fires_at_exact_times_for_as_long_as_the_scenario_says(scripted: Scripted) -> None:
    recording = scripted(program(PUBLISHER), Scenario("s", "t", duration=1.0))
    assert received(recording) == [(tick / 10, tick + 1.0) for tick in range(11)]


def test_parameters_are_given_at_the_start_set_and_refused(scripted: Scripted) -> None:
    recording = scripted(
        program(FILTER_WITH_GAIN),
        Scenario(
            "s",
            "t",
            (
                at(0.5, 1.5, 2.5).publish("/in", data=2.0),
                at(1.0).set_parameter("gain", 3.0),
                at(2.0).set_parameter("gain", -1.0),
                at(2.0).set_parameter("gain", 4),
                at(2.1).get_parameter("gain"),
                at(2.1).get_parameter("gain", node="/nobody"),
            ),
            parameters={"gain": 2.0},
        ),
    )
    assert received(recording) == [(0.5, 4.0), (1.5, 6.0), (2.5, 6.0)]
    changes = [(one.value, one.taken) for one in recording.parameters]
    assert changes == [(3.0, True), (-1.0, False), (4, False)]
    assert recording.parameters[1].reason == "gain must be positive"
    assert [one.value for one in recording.readings] == [3.0, None]
    assert recording.readings[1].answered is None


def test_names_are_remapped_and_moved_into_a_namespace(scripted: Scripted) -> None:
    recording = scripted(
        program(FILTER_WITH_GAIN),
        Scenario(
            "s", "t", at(0.5).publish("/left/in", FLOAT, data=2.0), namespace="/left", remappings={"out": "/louder"}
        ),
    )
    assert recording.nodes == ("/left/student",)
    assert "/louder" in {one.topic for one in recording.end_points}


def test_who_joins_late_gets_what_was_latched_by_its_own_durability(scripted: Scripted) -> None:
    recording = scripted(
        program(LATCHED_PUBLISHER),
        Scenario(
            "s",
            "t",
            (
                at(1.0).subscribe("/text", name="late", durability="transient_local"),
                at(1.0).subscribe("/text", name="volatile"),
            ),
            duration=1.5,
        ),
    )
    assert [(one.subscriber, one.at) for one in recording.received] == [("", 0.0), ("late", 1.0)]
    (latched,) = [one for one in recording.end_points if one.topic == "/text"]
    assert (latched.durability, latched.depth) == ("transient_local", 1)


def test_what_was_published_before_the_start_reaches_only_who_asks_for_it(scripted: Scripted) -> None:
    before = Scenario("s", "t", (before_start.publish("/in", data=7.0), at(0.5).publish("/in", data=8.0)))
    assert received(scripted(program(LATCHED_SUBSCRIBER), before)) == [(0.0, 7.0), (0.5, 8.0)]
    volatile = LATCHED_SUBSCRIBER.replace("qos)", "10)")
    assert received(scripted(program(volatile), before)) == [(0.5, 8.0)]


def test_a_publisher_that_offers_less_than_the_node_asks_for_is_not_heard(scripted: Scripted) -> None:
    offered = Scenario("s", "t", at(0.5).publish("/in", data=1.0), qos={"/in": Qos(durability="volatile")})
    assert not received(scripted(program(LATCHED_SUBSCRIBER), offered))


def test_calls_are_answered_also_several_at_once(scripted: Scripted) -> None:
    recording = scripted(
        program(SERVICE_SERVER),
        Scenario("s", "t", (at(0.5).call("/switch", data=True), at(1.0, 1.0).call("/switch", data=False))),
    )
    assert answers(recording.calls) == [(0.5, 0.5, True), (1.0, 1.0, True), (1.0, 1.0, False)]
    assert [one.what for one in recording.timeline[:2]] == ["request /switch", "response /switch"]


def test_a_reference_server_appears_answers_late_and_never(scripted: Scripted) -> None:
    recording = scripted(
        program(SERVICE_CLIENT),
        Scenario(
            "s",
            "t",
            servers=Server("/lamp", replies=(reply(success=True), reply(0.3, success=False), no_reply()), appears=0.7),
            duration=2.2,
        ),
    )
    assert answers(recording.calls) == [(1.0, 1.0, True), (1.5, 1.8, False), (2.0, None, None)]
    assert [when for when, value in received(recording) if value != -1.0] == [1.0, 1.8]
    assert recording.calls[0].node == "/student"


def brighter(request: object) -> dict[str, object]:
    return {"success": not request.data, "message": "by code"}  # type: ignore[attr-defined]


def test_replies_may_be_made_by_the_authors_own_function(scripted: Scripted) -> None:
    recording = scripted(
        program(SERVICE_CLIENT), Scenario("s", "t", servers=Server("/lamp", replies=brighter), duration=0.6)
    )
    assert recording.calls[0].response == {"success": False, "message": "by code"}


def test_a_node_that_blocks_in_a_callback_is_recorded_and_not_timed_out(scripted: Scripted) -> None:
    recording = scripted(
        program(BLOCKING_CLIENT),
        Scenario("s", "t", servers=Server("/lamp", replies=reply(success=True)), duration=1.0),
    )
    assert len(recording.calls) == 1
    assert not received(recording)


def test_a_server_that_is_gone_answers_nobody_until_it_is_back(scripted: Scripted) -> None:
    recording = scripted(
        program(SERVICE_CLIENT),
        Scenario(
            "s",
            "t",
            (at(0.7).leave("/lamp"), at(1.2).come_back("/lamp")),
            servers=Server("/lamp", replies=reply(success=True)),
            duration=1.6,
        ),
    )
    assert [one.at for one in recording.calls] == [0.0, 0.5, 1.5]


@pytest.fixture
def goals() -> Scenario:
    return Scenario(
        "goals",
        "a goal, a bad one, and one that is cancelled",
        (
            at(0.5).send_goal("/count", order=2),
            at(0.7).send_goal("/count", order=0),
            at(2.0).send_goal("/count", order=9),
            at(2.7).cancel(3),
        ),
        duration=3.5,
    )


def test_goals_are_recorded_from_the_raw_topics(scripted: Scripted, goals: Scenario) -> None:
    done, bad, cancelled = scripted(program(ACTION_SERVER, threads=4), goals).goals
    assert [one.state for one in done.states] == ["accepted", "executing", "succeeded"]
    assert [(one.at, one.fields["sequence"]) for one in done.feedback] == [(0.5, [0]), (1.0, [0, 1])]
    assert (done.status, done.result, done.finished) == ("succeeded", {"sequence": [0, 1]}, 1.5)
    assert (bad.accepted, bad.states, bad.status) == (False, (), "")
    assert [one.state for one in cancelled.states] == ["accepted", "executing", "canceling", "canceled"]
    assert [(one.at, one.accepted) for one in cancelled.cancels] == [(2.7, True)]
    assert (cancelled.status, cancelled.finished) == ("canceled", 3.0)


def test_without_a_cancel_callback_the_request_is_refused(scripted: Scripted, goals: Scenario) -> None:
    source = ACTION_SERVER.replace(", cancel_callback=lambda goal: CancelResponse.ACCEPT", "")
    cancelled = scripted(program(source, threads=4), goals).goals[2]
    assert [(one.accepted, one.code) for one in cancelled.cancels] == [(False, 0)], "as rclpy has it"
    assert [one.state for one in cancelled.states] == ["accepted", "executing"]


@pytest.mark.parametrize(
    ("script", "texts", "states"),
    [
        (
            succeeds(after=2.0, result={"sequence": [1, 2]}, feedback={0.5: {"sequence": [1]}}),
            [(0.0, "accepted True"), (0.5, "feedback [1]"), (2.0, "status 4 [1, 2]")],
            ["accepted", "executing", "succeeded"],
        ),
        (rejects(answers_after=0.4), [(0.4, "accepted False")], []),
        (
            aborts(after=0.3),
            [(0.0, "accepted True"), (0.3, "status 6 []")],
            ["accepted", "executing", "aborted"],
        ),
        (
            never_ends(feedback={0.5: {"sequence": [1, 2]}}, cancel_takes=0.3),
            [(0.0, "accepted True"), (0.5, "feedback [1, 2]"), (0.8, "status 5 []")],
            ["accepted", "executing", "canceling", "canceled"],
        ),
        (
            succeeds(after=1.0, feedback={0.5: {"sequence": [1, 2]}}, cancel="refuse"),
            [(0.0, "accepted True"), (0.5, "feedback [1, 2]"), (1.0, "status 4 []")],
            ["accepted", "executing", "succeeded"],
        ),
    ],
    ids=["succeeds", "rejects", "aborts", "is cancelled", "refuses to cancel"],
)
def test_a_scripted_action_server_does_with_a_goal_what_its_script_says(
    scripted: Scripted, script: object, texts: list[tuple[float, str]], states: list[str]
) -> None:
    servers = ActionServer("/climb", goals=script)  # type: ignore[arg-type]
    recording = scripted(program(ACTION_CLIENT), Scenario("s", "t", servers=servers, duration=2.5))
    assert received(recording, "/text") == texts
    (goal,) = recording.goals
    assert (goal.by, goal.node, goal.goal) == ("node", "/student", {"order": 3})
    assert [one.state for one in goal.states] == states
    assert len(goal.cancels) == ("feedback [1, 2]" in [text for _, text in texts])


def test_a_client_that_asks_for_the_result_of_a_rejected_goal_is_recorded(scripted: Scripted) -> None:
    scenario = Scenario("s", "t", servers=ActionServer("/climb", goals=rejects()), duration=1.5)
    (goal,) = scripted(program(ACTION_CLIENT), scenario).goals
    assert goal.asked_result is None
    asks = ACTION_CLIENT.replace("if self.goal.accepted:", "if True:")
    recording = scripted(program(asks), scenario)
    (goal,) = recording.goals
    assert goal.asked_result is not None
    assert received(recording, "/text")[-1][1] == "status 0 []"


def test_goals_without_end_are_not_kept(scripted: Scripted) -> None:
    asks = "sent = self.client.send_goal_async(Fibonacci.Goal(order=3), self.fed)"
    flood = ACTION_CLIENT.replace(asks, f"for _ in range(400): {asks}")
    scenario = Scenario("s", "t", servers=ActionServer("/climb", goals=rejects()), duration=1.5)
    ending = scripted(program(flood), scenario, "over-limit").ending
    assert ending.message == "Your node sent more than 300 goals to /climb."


def test_answers_without_end_are_not_kept(scripted: Scripted, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("grader.runner.service_servers.MOST_BYTES", 10_000)
    scenario = Scenario("s", "t", servers=Server("/lamp", replies=reply(message="x" * 4_000)), duration=3.0)
    ending = scripted(program(SERVICE_CLIENT), scenario, "over-limit").ending
    assert ending.message.startswith("Your node called /lamp so often that the answers take more than 10,000 bytes")


def test_a_turtle_goes_where_the_program_drives_it(scripted: Scripted) -> None:
    recording = scripted(program(GO_TO_GOAL), Scenario("s", "t", world=World(Turtle, x=5.0, y=7.0), duration=6.0))
    last = recording.sent[-1]
    assert (last.topic, last.at) == ("/turtle1/pose", 6.0)
    assert abs(last.fields["x"] - 9.0) < 0.1
    assert abs(last.fields["y"] - 8.0) < 0.1


def test_a_program_that_does_nothing_moves_nothing(scripted: Scripted) -> None:
    recording = scripted(program(PUBLISHER), Scenario("s", "t", world=World(Turtle, x=5.0, y=7.0), duration=0.5))
    assert {(one.fields["x"], one.fields["y"]) for one in recording.sent} == {(5.0, 7.0)}


def test_joints_go_to_where_they_are_reported_no_faster_than_they_can() -> None:
    chain = JointChain({"elbow": 0.0, "wrist": 1.0}, fastest=2.0)
    from sensor_msgs.msg import JointState

    chain.hear("/joint_commands", JointState(name=["elbow", "tail"], position=[0.3, 9.0]))
    positions = []
    for _ in range(3):
        chain.step(0.1)
        positions.append(chain.state()["/joint_states"]["position"])
    assert positions == [[0.2, 1.0], [pytest.approx(0.3), 1.0], [pytest.approx(0.3), 1.0]]


def too_many(request: object) -> dict[str, object]:
    return {"success": 2**70 if request.data else False}  # type: ignore[attr-defined]


def test_an_authors_function_that_breaks_is_named_with_the_request(scripted: Scripted) -> None:
    words = r"too_many\(\) for /lamp, with the request \{'data': True\}: .* is given for success"
    with pytest.raises(ExerciseError, match=words) as caught:
        scripted(program(SERVICE_CLIENT), Scenario("s", "t", servers=Server("/lamp", replies=too_many), duration=1.0))
    assert "a student's node may send it anything" in str(caught.value)


class Sour:
    """A world that breaks."""

    def __init__(self) -> None:
        self.reads: dict[str, str] = {}
        self.publishes = {"/in": FLOAT}
        self.time = 0.0

    def hear(self, topic: str, message: object) -> None: ...

    def step(self, seconds: float) -> None:
        self.time += seconds

    def state(self) -> dict[str, dict[str, object]]:
        return {"/in": {"data": 1.0 if self.time < 0.1 else 1}}


def test_a_world_that_breaks_is_the_authors_to_fix(scripted: Scripted) -> None:
    with pytest.raises(ExerciseError, match=r"Sour.state\(\), /in: 1 \(int\) is given for data, which is double"):
        scripted(program(PUBLISHER), Scenario("s", "t", world=World(Sour), duration=0.5))


LIFE_CYCLE = """
import rclpy
from rclpy.lifecycle import LifecycleNode, TransitionCallbackReturn
from std_msgs.msg import Float64

class Camera(LifecycleNode):
    def on_configure(self, state):
        self.out = self.create_lifecycle_publisher(Float64, "/out", 10)
        self.timer = self.create_timer(0.25, lambda: self.out.publish(Float64(data=1.0)))
        return TransitionCallbackReturn.SUCCESS

    def on_deactivate(self, state):
        return TransitionCallbackReturn.FAILURE

rclpy.init()
rclpy.spin(Camera("camera"))
"""


def test_a_node_with_a_life_cycle_is_configured_and_activated(scripted: Scripted) -> None:
    asked = ((0.5, "configure"), (1.1, "activate"), (2.1, "deactivate"))
    steps = tuple(at(second).transition(name, "/camera") for second, name in asked)
    found = scripted(LIFE_CYCLE, Scenario("up", "configured and activated", steps))
    assert [call.response["success"] for call in found.calls if call.response] == [True, True, False]
    assert [message.at for message in found.received] == [1.25, 1.5, 1.75, 2.0, 2.25, 2.5]
    assert not [end for end in found.end_points if end.kind == "server"]
