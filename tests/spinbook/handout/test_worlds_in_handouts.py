"""An author's own worlds and modules are given to students if a public check needs them, and only then."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path

import pytest

from grader.exercise import Exercise, ExerciseError, load
from grader.grading import Options, grading_of
from grader.submission.reader import of_source
from grader.workers import WorkerPool
from spinbook.handout.leaks import authors_code, leaks, secrets
from spinbook.handout.student_copy import exercise_files

TOML = """\
title = "Valve"
points = 4
file = "valve.py"
node = "valve"

[[subscribe]]
topic = "/level"
type = "std_msgs/msg/Float64"

[[publish]]
topic = "/valve"
type = "std_msgs/msg/Float64"
"""

TANK = """\
from dataclasses import dataclass

from tubes import Pipe


@dataclass
class Tank:
    reads, publishes = {"/valve": "std_msgs/msg/Float64"}, {"/level": "std_msgs/msg/Float64"}

    def __init__(self, level):
        self.level, self.flow = level, Pipe().flow

    def hear(self, topic, message):
        self.flow = message.data

    def step(self, seconds):
        self.level = max(0.0, self.level + (self.flow - 0.25) * seconds)

    def state(self):
        return {"/level": {"data": self.level}}
"""

SCENARIOS = """\
from leaking import LeakingTank
from tank import Tank

from grader.scenario import Scenario, World


def scenarios(seed):
    return (
        Scenario("tank", "a tank", world=World(Tank, level=1.0, period=0.1), duration=2.0, rate=10.0),
        Scenario("leak", "a leak", world=World(LeakingTank, level=1.0, period=0.1), duration=2.0, rate=10.0),
    )
"""

#: A file next to the world, which imports it.
TUBES = """\
class Pipe:
    flow = 0.0
"""

CHECK = """\
from limits import must_fill

from grader.checking import Run, check


@check(points=2, hint="Open the valve.", rule="Keep the tank full.")
def test_NAME(NAME: Run) -> None:
    \"\"\"It keeps the NAME full.\"\"\"
    must_fill(NAME)
"""

LIMITS = """\
def must_fill(run):
    assert run.seed == 1
    run.must_reach("/level", {"data": 2.0}, tolerance=0.3, within=1.9, stay=False)
"""

VALVE = """\
import rclpy
from std_msgs.msg import Float64

rclpy.init()
node = rclpy.create_node("valve")
publisher = node.create_publisher(Float64, "/valve", 10)


def on_level(message):
    # TODO: open the valve.
    # BEGIN SOLUTION
    publisher.publish(Float64(data=2.0 if message.data < 2.0 else 0.0))
    # END SOLUTION


node.create_subscription(Float64, "/level", on_level, 10)
rclpy.spin(node)
"""


@pytest.fixture(scope="module")
def workers() -> Iterator[WorkerPool]:
    with WorkerPool() as workers:
        yield workers


@pytest.fixture(scope="module")
def exercise(tmp_path_factory: pytest.TempPathFactory) -> Iterator[Exercise]:
    root = tmp_path_factory.mktemp("worlds")
    leaking = TANK.replace("Tank", "LeakingTank").replace("(self.flow - 0.25)", "(self.flow - 0.25 - 0.125)")
    for name, text in {
        "exercises/valve/exercise.toml": TOML,
        "exercises/valve/task.md": "# Valve\n\nKeep the tank full.\n",
        "exercises/valve/tank.py": TANK,
        "exercises/valve/leaking.py": leaking,
        "exercises/valve/scenarios.py": SCENARIOS,
        "exercises/valve/checks.py": CHECK.replace("NAME", "tank"),
        "exercises/valve/hidden_checks.py": CHECK.replace("NAME", "leak").replace("from limits", "from checks"),
        "exercises/valve/limits.py": LIMITS,
        "exercises/valve/tubes.py": TUBES,
        "exercises/valve/unused.py": "",
        "solutions/valve/solution.py": VALVE,
    }.items():
        (root / name).parent.mkdir(parents=True, exist_ok=True)
        (root / name).write_text(text)
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("SPINBOOK_CACHE", str(root / "cache"))
        yield load(root / "exercises" / "valve")


@pytest.fixture(scope="module")
def copy(exercise: Exercise, workers: WorkerPool) -> dict[str, bytes]:
    """A student's copy of the exercise."""
    return exercise_files(exercise, workers)


def test_a_students_copy_has_the_world_of_a_public_check_and_no_other(copy: dict[str, bytes]) -> None:
    assert copy["tank.py"].decode() == TANK
    assert (copy["tubes.py"].decode(), copy["limits.py"].decode()) == (TUBES, LIMITS)
    assert not {"leaking.py", "unused.py", "scenarios.py", "hidden_checks.py"} & copy.keys()
    assert not [name for name, content in copy.items() if b"LeakingTank" in content or b"0.125" in content]


def test_the_public_check_runs_at_the_students(copy: dict[str, bytes], workers: WorkerPool, tmp_path: Path) -> None:
    folder = tmp_path / "exercises" / "valve"
    folder.mkdir(parents=True)
    for name, content in copy.items():
        (folder / name).write_bytes(content)
    grading = grading_of(load(folder), Options(), workers)
    grade = grading.grade(of_source("valve", VALVE.encode(), grading.runner.exercise))
    assert [(verdict.name, verdict.status) for verdict in grade.verdicts] == [("test_tank", "passed")]
    starter = grading.grade(of_source("starter", copy["valve.py"], grading.runner.exercise))
    assert starter.score == 0


def test_a_line_of_a_world_that_stays_hidden_is_found_in_a_handout(exercise: Exercise, copy: dict[str, bytes]) -> None:
    files = {f"exercises/valve/{name}": content for name, content in copy.items()}
    known = secrets(exercise, authors_code(files))
    assert list(leaks(files, known)) == []
    line = "self.level = max(0.0, self.level + (self.flow - 0.25 - 0.125) * seconds)"
    assert [what for _, what in leaks({"chapter.md": line.encode()}, known)] == ["a line of leaking.py of valve"]


@pytest.mark.parametrize(
    ("file", "old", "new", "place", "message"),
    [
        ("limits.py", "def must", "import scenarios\n\n\ndef must", "limits.py:1", "imports scenarios.py, which"),
        ("tank.py", "from tubes", "from queue", "tank.py:3", "queue.py has the name of an installed module"),
        ("checks.py", "from limits", "from valve", "checks.py:1", "the file that students hand in"),
        ("checks.py", "from limits", "from parts", "checks.py:1", "parts is a folder"),
        ("limits.py", "    assert", "    open(__file__.replace('limits', 'scenarios'))\n    assert", "checks.py",
         "in the students' copy, test_tank breaks: limits.py:2: FileNotFoundError"),
    ],
)  # fmt: skip
def test_a_copy_that_lacks_something_is_not_written(
    exercise: Exercise, workers: WorkerPool, file: str, old: str, new: str, place: str, message: str
) -> None:
    changed = exercise.folder / file
    text = changed.read_text()
    (exercise.folder / "parts").mkdir(exist_ok=True)
    for name in ("queue", "valve"):
        (exercise.folder / f"{name}.py").write_text("must_fill = print\nPipe = object\n")
    changed.write_text(text.replace(old, new, 1))
    try:
        with pytest.raises(ExerciseError) as caught:
            exercise_files(exercise, workers)
    finally:
        changed.write_text(text)
    assert caught.value.problem.place.endswith(place), str(caught.value)
    assert message in caught.value.problem.problem


def test_a_students_own_file_is_not_imported_by_the_checks(
    copy: dict[str, bytes], workers: WorkerPool, tmp_path: Path
) -> None:
    folder = tmp_path / "exercises" / "valve"
    folder.mkdir(parents=True)
    for name, content in {**copy, "dataclasses.py": b"1 / 0"}.items():
        (folder / name).write_bytes(content)
    assert grading_of(load(folder), Options(), workers).references
