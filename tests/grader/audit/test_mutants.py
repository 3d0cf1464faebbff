"""Mutants: which changes there are, each a small diff that keeps the rest of the program as it is."""

from __future__ import annotations

import ast
from dataclasses import replace
from pathlib import Path

import pytest
from small_exercise import SmallExercise

from grader.audit.audit import sample
from grader.audit.mutants import Mutant, mutants_of
from grader.audit.result import MutantResult, RecordingDifference, Trial, score_of
from grader.audit.survivors import listed, problems_of_survivors, result_of, stale
from grader.checking.verdict import Finding
from grader.exercise import ExerciseError, load

ROOT = Path(__file__).parents[3]
SOURCE = (ROOT / "solutions" / "joint_velocity" / "solution.py").read_text(encoding="utf-8")

TIMER = """import rclpy
from rclpy.node import Node
from std_msgs.msg import Float64


class Ticker(Node):
    def __init__(self):
        super().__init__('ticker')
        self.publisher = self.create_publisher(Float64, '/joint_velocities', 10)
        self.timer = self.create_timer(0.1, self.tick)

    def tick(self):
        self.publisher.publish(Float64(data=float(1.0)))
"""


PEERS = """import rclpy
from rclpy.action import ActionServer, CancelResponse
from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import MultiThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import String
from std_srvs.srv import SetBool
from test_msgs.action import Fibonacci


class Counter(Node):
    def __init__(self):
        super().__init__('counter')
        self.declare_parameter('gain', 2.0)
        self.client = self.create_client(SetBool, '/light', callback_group=ReentrantCallbackGroup())
        self.create_publisher(String, '/map', QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL))
        self.create_service(SetBool, '/power', self.on_power)
        self.create_timer(0.1, self.tick)
        ActionServer(self, Fibonacci, '/count', self.execute, cancel_callback=lambda _: CancelResponse.ACCEPT)

    def tick(self):
        if self.client.service_is_ready():
            self.client.call_async(SetBool.Request())

    def on_power(self, request, response):
        response.success = request.data
        return response

    def execute(self, goal_handle):
        stop = goal_handle.is_cancel_requested
        if stop:
            goal_handle.canceled()
            return Fibonacci.Result()
        goal_handle.publish_feedback(Fibonacci.Feedback())
        goal_handle.succeed()
        return Fibonacci.Result()


executor = MultiThreadedExecutor()
"""


@pytest.fixture(scope="module")
def mutants() -> tuple[Mutant, ...]:
    """All mutants of joint_velocity's solution."""
    return mutants_of(SOURCE, load(ROOT / "exercises" / "joint_velocity"))


@pytest.fixture(scope="module")
def peers() -> tuple[Mutant, ...]:
    """All mutants of a node with a service, a client, an action, a parameter and a timer."""
    return mutants_of(PEERS, load(ROOT / "exercises" / "joint_velocity"))


def added(mutants: tuple[Mutant, ...], operator: str) -> str:
    """Return the lines that the mutants of one operator add."""
    rows = [row for m in mutants if m.operator == operator for row in m.diff.splitlines()]
    return "\n".join(row for row in rows if row.startswith("+"))


@pytest.mark.parametrize(
    ("operator", "line"),
    [
        ("comparison", "stamp >= self.stamp_before"),
        ("arithmetic", "position + self.positions_before[name]"),
        ("operand", "self.positions_before[name] - position"),
        ("condition", "if not (answer.name):"),
        ("part of condition", "if stamp > self.stamp_before:"),
        ("constant", "NANOSECONDS = 1000000001"),
        ("time unit", "NANOSECONDS = 1_000_000\n"),
        ("loop", "for name, position in list(positions.items())[:-1]:"),
        ("result", "        return"),
        ("topic name", "'/joint_commands', 10)"),
        ("message type", "create_publisher(std_msgs.msg.String, "),
        ("quality of service", "QoSProfile(depth=10, reliability=rclpy.qos.ReliabilityPolicy.BEST_EFFORT)"),
        ("quality of service", "'/joint_velocities', 1)"),
        ("node name", "super().__init__('joint_velocity_node')"),
        ("callback left out", "lambda *_: None"),
        ("one publisher a message", "+        self.publisher = self.create_publisher("),
        ("publisher on other topic", "self.create_publisher(rosgraph_msgs.msg.Clock, '/clock', 10)"),
        ("header", "answer.header.frame_id = message.header.frame_id"),
        ("header", "answer.header.stamp = message.header.stamp"),
        ("other clock", "self.get_clock().now().to_msg().sec"),
        ("other clock", "rclpy.clock.Clock().now().to_msg().sec"),
        ("part of stamp", "message.header.stamp.sec * NANOSECONDS + message.header.stamp.sec"),
        ("unit", "math.degrees((position"),
        ("before publishing", "answer.name.reverse()"),
        ("publishing", "self.turn = not"),
        ("remembered", "getattr(self, 'positions_before_older', self.positions_before)"),
        ("guard removed", "            pass"),
        ("handler", "    except ExternalShutdownException:"),
        ("spinning", "rclpy.shutdown()"),
    ],
)  # fmt: skip
def test_each_operator_makes_what_students_get_wrong(mutants: tuple[Mutant, ...], operator: str, line: str) -> None:
    assert line in added(mutants, operator) + "\n"


def test_a_timer_has_another_period() -> None:
    made = mutants_of(TIMER, load(ROOT / "exercises" / "joint_velocity"))
    assert "self.create_timer((0.1) * 2, self.tick)" in added(made, "timer period")
    assert "self.create_timer((0.1) / 2, self.tick)" in added(made, "timer period")
    assert "Float64(data=1.0)" in added(made, "without call")


def test_of_nothing_there_is_no_double() -> None:
    made = mutants_of(TIMER.replace("1.0", "0.0"), load(ROOT / "exercises" / "joint_velocity"))
    assert "Float64(data=float((1.0)))" in added(made, "constant")
    assert "0.0 * 2" not in added(made, "constant")


@pytest.mark.parametrize(
    ("operator", "line"),
    [
        ("outcome", "goal_handle.abort()"),
        ("outcome", "            goal_handle.succeed()"),
        ("choice", "CancelResponse.REJECT"),
        ("choice", "DurabilityPolicy.VOLATILE"),
        ("not asked", "stop = False"),
        ("blocking", "self.client.call(SetBool.Request())"),
        ("blocking", "rclpy.callback_groups.MutuallyExclusiveCallbackGroup()"),
        ("blocking", "executor = rclpy.executors.SingleThreadedExecutor()"),
        ("slow callback", "time.sleep(1.0)"),
        ("slow callback", "raise RuntimeError('broken')"),
        ("empty result", "return type(response)()"),
        ("result", "return None"),
        ("declared type", "self.declare_parameter('gain', 2)"),
        ("timer clock", "clock=rclpy.clock.Clock("),
        ("topic name", "'/powers'"),
        ("message type", "std_srvs.srv.Empty, '/power'"),
        ("message type", "test_msgs.action.NestedMessage, '/count'"),
        ("callback left out", "'/power', lambda *_: None"),
        ("argument", "create_client(SetBool, '/light', )"),
    ],
)
def test_services_actions_and_parameters_have_operators_of_their_own(
    peers: tuple[Mutant, ...], operator: str, line: str
) -> None:
    assert line in added(peers, operator)


def test_a_node_is_not_made_twice(mutants: tuple[Mutant, ...]) -> None:
    assert "self.publisher.publish(answer)" in added(mutants, "statement twice")
    assert "super().__init__" not in added(mutants, "statement twice")


def test_there_are_more_than_enough_of_them_and_no_two_are_the_same(mutants: tuple[Mutant, ...]) -> None:
    assert len(mutants) >= 200
    assert len({mutant.id for mutant in mutants}) == len(mutants)
    assert len({ast.dump(ast.parse(m.source)) for m in mutants} - {ast.dump(ast.parse(SOURCE))}) == len(mutants)


def test_a_mutant_leaves_everything_else_as_it_stands(mutants: tuple[Mutant, ...]) -> None:
    assert all(mutant.source != SOURCE and mutant.diff for mutant in mutants)
    rows = set(SOURCE.splitlines())
    for mutant in mutants:
        kept = [row for row in mutant.source.splitlines() if row in rows]
        assert len(kept) >= len(SOURCE.splitlines()) - 8, mutant.diff


def test_a_mutants_id_outlives_changes_in_other_places(mutants: tuple[Mutant, ...]) -> None:
    longer = SOURCE.replace("import rclpy\n", "# A line more.\nimport rclpy\n", 1)
    again = mutants_of(longer, load(ROOT / "exercises" / "joint_velocity"))
    assert {mutant.id for mutant in again} == {mutant.id for mutant in mutants}


def test_a_mutants_id_does_not_depend_on_what_the_exercise_is_called(mutants: tuple[Mutant, ...]) -> None:
    exercise = replace(load(ROOT / "exercises" / "joint_velocity"), name="goal", class_name="Goal", node_name="goal")
    source = SOURCE.replace("JointVelocity", "Goal").replace("'joint_velocity'", "'goal'")
    assert source != SOURCE
    assert [mutant.id for mutant in mutants_of(source, exercise)] == [mutant.id for mutant in mutants]


def test_a_sample_is_always_the_same_and_of_all_kinds(mutants: tuple[Mutant, ...]) -> None:
    chosen = sample(mutants, 12)
    assert chosen == sample(tuple(reversed(mutants)), 12)
    assert len({mutant.operator for mutant in chosen}) == 12
    assert len(sample(mutants, 10_000)) == len(mutants)


def trial(failed: bool = False, different: bool = False) -> Trial:
    """Return the trial of a program that fails a check, or that publishes something else and fails none."""
    return Trial(
        message="",
        statuses={"test_a": "failed" if failed else "passed"},
        findings={"test_a": Finding("1 was expected")} if failed else {},
        run_in=("positive", "any"),
        messages=7,
        differences=(RecordingDifference("any", "3 of 3 messages differ in data"),) if different else (),
    )


def test_what_becomes_of_a_mutant(small: SmallExercise, mutants: tuple[Mutant, ...]) -> None:
    mutant = mutants[0]
    caught = result_of(mutant, trial(failed=True, different=True), {})
    same = result_of(mutant, trial(), {})
    survived = result_of(mutant, trial(different=True), {})
    judged = result_of(mutant, trial(different=True), {mutant.id: "It is right."})
    assert [r.fate for r in (caught, same, survived, judged)] == ["caught", "equivalent", "survived", "listed"]
    assert "all 7 messages of 2 scenarios" in same.evidence
    assert "3 of 3 messages differ in data (in any)" in survived.evidence
    results: tuple[MutantResult, ...] = (caught, same, survived, judged)
    (problem,) = problems_of_survivors(load(small.folder), results)
    assert problem.about == mutant.id
    assert problem.diff == mutant.diff
    assert score_of(results) == pytest.approx(1 / 3), "what does not differ does not count"


def test_survivors_that_the_author_has_judged_are_reported_when_they_hold_no_longer(small: SmallExercise) -> None:
    file = small.folder / "survivors.toml"
    ids = ("holds", "caught", "equal", "gone")
    file.write_text("".join(f'[[survivor]]\nmutant = "{id_}"\nreason = "It is right."\n\n' for id_ in ids))
    exercise = load(small.folder)
    reasons = listed(exercise)
    assert set(reasons) == set(ids)
    problems = stale(exercise, reasons, {"holds": "listed", "caught": "caught", "equal": "equivalent"})
    assert [problem.about for problem in problems] == ["caught", "equal", "gone"]
    assert problems[0].place.endswith("survivors.toml:6")


def test_a_survivor_needs_a_reason(small: SmallExercise) -> None:
    (small.folder / "survivors.toml").write_text('[[survivor]]\nmutant = "1234567890"\n')
    with pytest.raises(ExerciseError, match="reason"):
        listed(load(small.folder))
