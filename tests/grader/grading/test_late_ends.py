"""A node may create its endpoints late: a publisher when it has something to publish, a subscription after a while."""

from __future__ import annotations

import pytest
from few_scenarios import in_scenarios

from grader.exercise.mistakes import mistake_of
from grader.grading import Grade
from grader.grading.grading import Grading
from grader.submission.reader import of_source

PUBLISHER = "        self.publisher = self.create_publisher(JointState, '/joint_velocities', 10)\n"
SUBSCRIPTION = (
    "        self.subscription = self.create_subscription(JointState, '/joint_commands', self.on_joints, 10)\n"
)
CALLBACK = "    def on_joints(self, message):\n"


def in_chapter(grading: Grading, source: str) -> Grade:
    """Return the grade of a program in the first scenario."""
    exercise = grading.runner.exercise
    return in_scenarios(grading, "chapter").grade(of_source("test.py", source.encode(), exercise))


def grade_with(grading: Grading, *changes: tuple[str, str]) -> Grade:
    """Return the grade of the solution with pieces of it replaced."""
    solution = grading.runner.exercise.solution_file
    assert solution
    source = solution.read_text(encoding="utf-8")
    for old, new in changes:
        assert source.count(old) == 1
        source = source.replace(old, new)
    return in_chapter(grading, source)


@pytest.mark.parametrize(
    "place",
    ["    def publish_velocities(self, message, positions, dt):\n", pytest.param(CALLBACK, marks=pytest.mark.soak)],
    ids=["with the first answer", "before the first answer"],
)
def test_a_publisher_made_in_the_callback_is_heard_from_its_first_message_on(grading: Grading, place: str) -> None:
    made = f"{place}        if not hasattr(self, 'publisher'):\n    {PUBLISHER}"
    grade = grade_with(grading, (PUBLISHER, ""), (place, made))
    assert grade.full_marks, [v for v in grade.verdicts if v.status != "passed"]


def test_a_subscription_made_after_a_while_is_reported_as_that(grading: Grading) -> None:
    begin = (
        "    def begin(self):\n        self.ticks += 1\n        if self.ticks == 3:\n"
        f"    {SUBSCRIPTION}            self.timer.cancel()\n\n"
    )
    timer = "        self.ticks = 0\n        self.timer = self.create_timer(1.0, self.begin)\n"
    grade = grade_with(grading, (SUBSCRIPTION, timer), (CALLBACK, begin + CALLBACK))
    findings = {verdict.name: verdict.finding.text for verdict in grade.verdicts if verdict.finding}
    assert "Message 2 of 100" in findings["test_answers_each_message_once"]
    assert "did not subscribe to /joint_commands yet" in findings["test_answers_each_message_once"]


def test_however_many_answers_come_at_once_each_is_filed_under_its_message(grading: Grading) -> None:
    answers = (
        "        self.count = getattr(self, 'count', 0) + 1\n"
        "        for _ in range(12):\n"
        "            self.publisher.publish(JointState(effort=[float(self.count)]))\n"
        "        return\n"
    )
    grade = grade_with(grading, (CALLBACK, CALLBACK + answers))
    received = grade.recordings["chapter"].received
    assert len(received) == 1200
    assert all(message.fields["effort"] == [message.after] for message in received)


#: rclpy's thread that shuts ROS 2 down on Ctrl-C gets a CPU only while nothing else in the program wants it.
LATE_THREAD = """    rclpy.init()
    import os

    for thread in os.listdir('/proc/self/task'):
        with open(f'/proc/self/task/{thread}/comm') as name:
            if int(thread) != os.getpid() and name.read().strip() != 'lockstep':
                os.sched_setscheduler(int(thread), os.SCHED_IDLE, os.sched_param(0))
"""


def test_a_second_shutdown_after_ctrl_c_is_found_however_late_rclpys_own_thread_gets_a_cpu(grading: Grading) -> None:
    source = mistake_of(grading.runner.exercise, "traceback_on_ctrl_c").source
    late = source.replace("    rclpy.init()\n", LATE_THREAD)
    assert late != source
    grade = in_chapter(grading, late)
    assert [verdict.name for verdict in grade.verdicts if verdict.status != "passed"] == ["test_ends_on_ctrl_c"]
