"""Every run gives a grade, even one that could not start; its message says what the student can do."""

from __future__ import annotations

from dataclasses import replace

import pytest
from few_scenarios import in_scenarios

from grader.checking import ending_message
from grader.exercise import Exercise
from grader.grading import Grade
from grader.grading.grading import Grading
from grader.grading.public import PublicPart
from grader.submission.reader import of_source

NODE = """
import rclpy
from rclpy.node import Node
from sensor_msgs.msg import JointState
import time


class JointVelocity(Node):
    def __init__(self):
        super().__init__('joint_velocity')
        self.publisher = self.create_publisher(JointState, '/joint_velocities', 10)
        self.create_subscription(JointState, '/joint_commands', self.on_joints, 10)
        self.count = 0

    def on_joints(self, message):
        self.count += 1
        {body}


rclpy.init()
rclpy.spin(JointVelocity())
"""


def grade_of(grading: Grading, source: str) -> Grade:
    exercise: Exercise = grading.runner.exercise
    return grading.grade(of_source("test.py", source.encode(), exercise))


@pytest.mark.parametrize(
    ("source", "outcome", "words"),
    [
        ("import rclpy\ndef main(:\n", "did-not-start", ["SyntaxError", "line 2"]),
        ("import rclpy\nimport tensorflow\n", "did-not-start", ["tensorflow", "line 2", "numpy"]),
        ("from sensor_msgs.msg import JointStates\n", "did-not-start", ["JointStates", "sensor_msgs.msg"]),
        ("if __name__ == 'main':\n    main()\n", "did-not-start", ["`if __name__ == 'main':` is never true"]),
        ("x = 1\n", "did-not-start", ["created no node", "main()"]),
        ("", "did-not-start", ["empty"]),
        ("import time\ntime.sleep(3600)\n", "timed-out", ["waits", "creates no node"]),
        (NODE.format(body="if self.count == 37: self.no_such_method()"), "crashed", ["message 37", "no_such_method"]),
        (NODE.format(body="if self.count == 5: import os; os._exit(0)"), "crashed", ["message 5", "by itself"]),
        (NODE.format(body="while self.count == 5: pass"), "timed-out", ["endless loop"]),
        (NODE.format(body="time.sleep(3600)"), "timed-out", ["sleep"]),
        (NODE.format(body="for i in range(100_000): self.publisher.publish(message)"), "over-limit", ["1,500", "loop"]),
    ],
    ids=lambda value: value if isinstance(value, str) and len(value) < 15 else None,
)
def test_a_broken_submission_is_told_what_is_wrong(
    grading: Grading, source: str, outcome: str, words: list[str]
) -> None:
    grade = grade_of(grading, source)
    assert grade.outcome == outcome, grade.message
    assert all(word in grade.message for word in words), grade.message
    assert grade.score == 0
    assert all(verdict.status in ("failed", "blocked") for verdict in grade.verdicts)
    assert len(grade.verdicts) > 20


def test_a_module_that_only_notebooks_have_costs_nobody_a_point(
    grading: Grading, monkeypatch: pytest.MonkeyPatch
) -> None:
    pretends = "raise ModuleNotFoundError(\"No module named 'matplotlib'\")\n"
    imports = f"{pretends}from matplotlib import pyplot\n"
    assert grade_of(grading, imports).outcome == "did-not-start", "it is installed here"

    monkeypatch.setattr(ending_message, "find_spec", lambda name: None)
    grade = grade_of(grading, imports)

    assert (grade.outcome, grade.has_score) == ("host-error", False)
    assert "matplotlib, which notebooks may have, is missing here. Instructors: pip install" in grade.message
    assert not grade.recordings, "to judge them again, once it is installed, would give a zero"
    assert grade_of(grading, pretends).has_score, "a zero, as for any error that a program raises itself"

    self_check = replace(grading, public=PublicPart((), {}, 0, 0.0))
    advised = grade_of(self_check, imports)
    assert (advised.outcome, advised.has_score) == ("did-not-start", True)
    assert "It is not installed here: pip install matplotlib," in advised.message
    assert "Available are" not in advised.message


def test_a_crash_in_one_scenario_costs_only_its_checks(grading: Grading) -> None:
    solution = grading.runner.exercise.solution_file
    assert solution
    source = solution.read_text(encoding="utf-8").replace(
        "        positions = {\n",
        "        assert message.name, 'nobody expects an empty message'\n        positions = {\n",
        1,
    )
    grade = grade_of(in_scenarios(grading, "chapter", "empty"), source)
    assert grade.outcome == "graded"
    failed = {verdict.name: verdict.finding for verdict in grade.verdicts if verdict.status == "failed"}
    assert set(failed) == {"test_empty_message"}
    assert failed["test_empty_message"]
    assert "message 10" in failed["test_empty_message"].text
    assert "nobody expects an empty message" in failed["test_empty_message"].text


#: The race itself happens once in a hundred Ctrl-C. Its error is raised each time if one context is shut down twice.
TWICE = "rclpy.get_default_context().shutdown() or rclpy.get_default_context().shutdown()"


@pytest.mark.parametrize(
    "ending",
    ["try_shutdown()", f"if rclpy.ok() or True:\n            {TWICE}"],
    ids=["in try_shutdown", "after asking ok()"],
)
def test_a_race_between_ctrl_c_and_a_shutdown_that_asks_first_costs_nothing(grading: Grading, ending: str) -> None:
    twice = f"def try_shutdown():\n    {TWICE}\n\n\ndef main"
    solution = grading.runner.exercise.solution_file
    assert solution
    source = solution.read_text(encoding="utf-8").replace("rclpy.try_shutdown()", ending)
    grade = grade_of(in_scenarios(grading, "chapter"), source.replace("def main", twice, 1))
    [verdict] = [verdict for verdict in grade.verdicts if "Ctrl-C" in verdict.title]
    assert verdict.status == "passed", verdict
