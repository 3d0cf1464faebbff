"""What a beginner reads first about a mistake: it is true, and says what to change.

Each mistake was written from a task, as a beginner would make it, and what is said about it was judged by reading it.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import cache
from pathlib import Path

import pytest

from grader.exercise import load
from grader.grading import Grade, Options, grading_of
from grader.grading.grading import Grading
from grader.report.checks import first_hints
from grader.submission.reader import of_source
from grader.workers import WorkerPool

ROOT = Path(__file__).parents[3]

#: The exercise, what a beginner writes in place of what, and what is read first.
MISTAKES: list[tuple[str, dict[str, str], str]] = [
    (
        "heartbeat",
        {"create_timer(0.25": "create_timer(4.0"},
        "It publishes every 4 s: a timer takes the period in seconds",
    ),
    ("heartbeat", {"create_timer(0.25, self.beat)": "create_timer(0.25, self.beat())"}, "Give the method itself"),
    ("heartbeat", {"now().to_msg()": "now()"}, "A Time is not yet a stamp: its to_msg() is one."),
    ("heartbeat", {"'/heartbeat', 10": "'/heart_beat', 10"}, "Is /heart_beat a misspelling of /heartbeat?"),
    ("heartbeat", {"message = Header()": "message = Header"}, "publish() takes a whole Header"),
    ("heartbeat", {"rclpy.spin(node)": "pass"}, "does it call rclpy.spin()?"),
    ("heartbeat", {"self.publisher.publish": "self.publiser.publish"}, "Did you mean: 'publisher'?"),
    ("heartbeat", {"import rclpy\n": "import rclpy, tkinter\n"}, "A node that is graded has no screen."),
    (
        "motor_switch",
        {"def on_request(self, request, response):": "def on_request(self, request):"},
        "The arguments of a",
    ),
    ("motor_switch", {"Bool(data=on)": "Bool(data=int(on))"}, "data on /motors_on is false in all 3 messages."),
    ("motor_switch", {"publish(Bool(data=on))": "publish(on)"}, "publish() takes a whole Bool"),
    ("motor_switch", {"'motors on' if": "'Motors on' if"}, "Only capital letters, spaces or punctuation differ."),
    ("motor_switch", {"'/switch_motors'": "'/switch_motor'"}, "Is /switch_motor a misspelling of /switch_motors?"),
    ("motor_switch", {"# END SOLUTION\n        return response": "# END SOLUTION"}, "end each way through it with"),
    ("calibration", {"position=[answer.offset]": "position=answer.offset"}, "A list belongs here: write [value]"),
    ("calibration", {"name=[joint]": "name=joint"}, "is one letter: a text stands where a list of texts belongs."),
    ("calibration", {"append(message.data)": "append(message)"}, "A text field of it needs a str"),
    (
        "calibration",
        {"call_async(CalibrateJoint.Request(joint=joint))": "call_async(joint)"},
        "A request is a whole message",
    ),
    (
        "joint_operator",
        {"MoveJoint.Goal(position=self.waiting.pop(0))": "self.waiting.pop(0)"},
        "A goal is a whole message",
    ),
    (
        "joint_operator",
        {"OUTCOMES[future.result().status]": "str(future.result().status)"},
        "The task has no such text.",
    ),
    ("joint_mover", {"Feedback(position=self.position)": "Feedback(position=int(self.position))"}, "needs a float"),
    (
        "joint_mover",
        {"publish_feedback(MoveJoint.Feedback(position=self.position))": "publish_feedback(self.position)"},
        "(self.position)`. publish_feedback() takes a whole message: MoveJoint.Feedback(…)",
    ),
    (
        "joint_mover",
        {"goal_handle.succeed()": "pass"},
        "returned without goal_handle.succeed(), so rclpy aborted the goal",
    ),
    (
        "joint_mover",
        {"goal_handle.succeed()": "goal_handle.abort()"},
        "called goal_handle.abort(), which is for a goal",
    ),
    (
        "joint_mover",
        {"rclpy.spin(node, MultiThreadedExecutor())": "rclpy.spin(node)"},
        "run the node in a MultiThreaded",
    ),
    ("joint_mover", {"return GoalResponse.ACCEPT": "return True"}, "has to return GoalResponse.ACCEPT or"),
    (
        "joint_mover",
        {"goal_callback=": "handle_accepted_callback=lambda goal: None, goal_callback="},
        "has to call goal_handle.execute()",
    ),
    ("joint_mover", {"goal_handle.request.position": "goal_handle.position"}, "has no attribute 'position' in line"),
    (
        "joint_velocity",
        {" * NANOSECONDS + message.header.stamp.nanosec": " * NANOSECONDS"},
        "has another sec than the message",
    ),
    (
        "joint_velocity",
        {"self.stamp_before = None": "self.handle = self.stamp_before = None"},
        "already has an attribute `handle`",
    ),
    (
        "joint_velocity",
        {"def on_joints": "def timers(self):\n        pass\n\n    def on_joints"},
        "attribute `timers`: the list",
    ),
    (
        "joint_velocity",
        {"answer.name.append(name)": "pass", "if answer.name": "if answer.velocity"},
        "name is empty in every message",
    ),
    ("joint_velocity", {"zip(message.name, message.position) if": "message if"}, "A JointState is not a list."),
    ("robot_description", {"String(data=text)": "text"}, "publish() takes a whole String"),
    (
        "robot_description",
        {"'/robot_description', latched": "'/robot_description', 1"},
        "A volatile publisher keeps nothing",
    ),
    (
        "joint_filter",
        {"self.get_parameter('gain').value": "self.get_parameter('gain')"},
        "get_parameter() returns a Parameter",
    ),
    ("joint_filter", {"return SetParametersResult(successful=True)": "pass"}, "Your on-set callback has to return a"),
    (
        "go_to_goal",
        {"= min(distance, FASTEST) * max(math.cos(turn), 0.0)": "= 1"},
        "your node put an int into a float field",
    ),
    ("go_to_goal", {"command.linear.x = min": "command.linear = min"}, "set linear.x."),
    ("go_to_goal", {"self.goal.y - pose.y": "self.goal.y - pose.position.y"}, "The fields of a Pose are: x, y, theta"),
]

#: Its scenarios take longest. What is said is tested in test_how_a_program_ended.py and test_observed_causes.py, too.
LONG = "go_to_goal"


@pytest.fixture(scope="module")
def grading_by_exercise(workers_with_interfaces: WorkerPool) -> Callable[[str], Grading]:
    """Return how to get the self-check of an exercise, each of which is prepared once."""

    @cache
    def prepared(exercise: str) -> Grading:
        return grading_of(load(ROOT / "exercises" / exercise).public(), Options(), workers_with_interfaces)

    return prepared


def first_said(grade: Grade) -> str:
    """Return what a student reads first."""
    failed = [verdict.finding.text for verdict in grade.verdicts if verdict.status == "failed" and verdict.finding]
    return grade.message if grade.outcome != "graded" else next(iter(failed), "")


@pytest.mark.parametrize(
    ("name", "edits", "says"),
    [pytest.param(*mistake, marks=[pytest.mark.soak] * (mistake[0] == LONG)) for mistake in MISTAKES],
)
def test_what_is_said_first_is_true_and_enough(
    grading_by_exercise: Callable[[str], Grading], name: str, edits: dict[str, str], says: str
) -> None:
    grading = grading_by_exercise(name)
    source = (ROOT / "solutions" / name / "solution.py").read_text(encoding="utf-8")
    for old, new in edits.items():
        assert old in source
        source = source.replace(old, new)

    grade = grading.grade(of_source("mine.py", source.encode(), grading.runner.exercise))

    assert says in first_said(grade)
    assert len(first_hints(grade)[1]) == 2, "where to look, and what to do"
