"""`spinbook new --kind` makes an exercise of each kind that works: right solutions pass, mistakes are caught."""

from __future__ import annotations

import itertools
import re
import subprocess
import sys
from collections import Counter
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from grader.checking.proofreader import faults
from grader.exercise import load, starter
from grader.exercise.mistakes import Mistake, mistakes_of
from grader.exercise.rules import named_by, rules_of
from grader.grading import Options, grading_of
from grader.grading.grading import Grading
from grader.submission import read
from grader.submission.reader import of_source
from grader.workers import WorkerPool
from spinbook.new.command import new
from spinbook.new.kind import ExerciseKind
from spinbook.new.templates import BY_NAME, KINDS, write_course, write_exercise
from spinbook.problem import SpinbookError


def made(*words: str) -> Result:
    return CliRunner().invoke(new, words)


def exercise_of(kind: str) -> str:
    return f"my_{kind.replace('-', '_')}"


@pytest.fixture(scope="module")
def course(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A new course with one exercise of each kind."""
    folder = tmp_path_factory.mktemp("kinds") / "robots"
    write_course(folder, "Robots", "robots")
    with pytest.MonkeyPatch.context() as patch:
        patch.chdir(folder)
        for kind in KINDS:
            done = made("--exercise", exercise_of(kind.name), "--kind", kind.name)
            assert done.exit_code == 0, done.output
    return folder


@pytest.fixture(scope="module")
def workers() -> Iterator[WorkerPool]:
    with WorkerPool() as workers:
        yield workers


#: Graded by every `make test`; `make soak` grades all kinds.
ALWAYS = ("filter", "action-server")


@pytest.fixture(
    scope="module",
    params=[pytest.param(kind, marks=() if kind in ALWAYS else pytest.mark.soak) for kind in BY_NAME],
)
def grading(request: pytest.FixtureRequest, course: Path, workers: WorkerPool) -> Grading:
    """A grading for the exercise of a kind: its solution has passed every check."""
    return grading_of(load(course / "exercises" / exercise_of(request.param)), Options(), workers)


def folder_of(grading: Grading) -> Path:
    exercise = grading.runner.exercise
    return exercise.folder.parents[1] / "solutions" / exercise.name


def caught(grading: Grading, mistake: Mistake) -> set[str]:
    """Return the checks that a mistake fails."""
    grade = grading.grade(of_source(mistake.name, mistake.source.encode(), grading.runner.exercise))
    return {verdict.name for verdict in grade.verdicts if verdict.status == "failed"}


def test_the_starter_gets_nothing_and_a_usual_mistake_loses_what_it_names(grading: Grading) -> None:
    source = starter((folder_of(grading) / "solution.py").read_text(encoding="utf-8"))
    assert grading.grade(of_source("starter", source.encode(), grading.runner.exercise)).score == 0
    mistake = mistakes_of(grading.runner.exercise)[-1]
    assert caught(grading, mistake) == set(mistake.caught_by)


@pytest.mark.soak
def test_every_right_solution_gets_full_marks(grading: Grading) -> None:
    files = sorted((folder_of(grading) / "right").glob("*.py"))
    assert files
    for file in files:
        grade = grading.grade(read(str(file), grading.runner.exercise))
        assert grade.full_marks, (file.name, [v for v in grade.verdicts if v.status != "passed"])


@pytest.mark.soak
def test_its_audit_finds_nothing_to_fix(grading: Grading) -> None:
    """Each mistake fails the checks that it names and costs about what its rule is worth; no work is worth nothing."""
    exercise = grading.runner.exercise
    command = [sys.executable, "-m", "spinbook", "audit", exercise.name, "--mutants", "0", "--seeds", "1"]
    done = subprocess.run(command, cwd=exercise.folder.parents[1], capture_output=True, text=True, check=False)
    assert "nothing to fix" in done.stdout, done.stdout + done.stderr


@pytest.mark.soak
def test_a_class_of_six_gets_its_grades_side_by_side(grading: Grading) -> None:
    folder, exercise = folder_of(grading), grading.runner.exercise
    solution = folder / "solution.py"
    right = [read(str(file), exercise) for file in (solution, *[*(folder / "right").glob("*.py")][:1])]
    mistakes = mistakes_of(exercise)[:3]
    wrong = [of_source(mistake.name, mistake.source.encode(), exercise) for mistake in mistakes]
    empty = of_source("starter", starter(solution.read_text(encoding="utf-8")).encode(), exercise)
    with ThreadPoolExecutor(3) as desk:
        grades = list(desk.map(grading.grade, [*right, *wrong, empty]))
    assert [grade.full_marks for grade in grades] == [True] * 2 + [False] * 4
    assert grades[-1].score == 0
    for mistake, grade in zip(mistakes, grades[2:5], strict=True):
        assert {verdict.name for verdict in grade.verdicts if verdict.status == "failed"} == set(mistake.caught_by)


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_an_exercise_of_each_kind_is_about_its_name_and_short(kind: ExerciseKind) -> None:
    files = kind.files("gripper_force", "A gentle grip")
    text = "".join(files.values())
    assert f'"{kind.source.stem}"' not in text
    assert files[Path("exercises/gripper_force/task.md")].startswith("# A gentle grip\n")
    assert "gripper force" in files[Path("exercises/gripper_force/task.md")]
    names = {name for name in re.findall(r'"/([\w/]+)"', text) if name not in OF_ROS}
    assert {name.split("/")[0].removesuffix("_gain").removesuffix("_limit") for name in names} == {"gripper_force"}
    assert len(files) <= 9
    assert sum(len(text.splitlines()) for text in files.values()) <= 670


#: What every node publishes or subscribes to.
OF_ROS = ("clock", "map", "parameter_events", "rosout")


def test_an_exercise_of_each_kind_works_by_any_name(tmp_path: Path) -> None:
    names = itertools.cycle(["node", "float64", "scenario", "check", "x", "arm_7", "to_be_or_not_to_be_that_is_it"])
    for kind, name in zip(KINDS, names, strict=False):
        write_exercise(tmp_path / kind.name, name, "Any title", kind)
        folder = tmp_path / kind.name / "exercises" / name
        assert [*faults(folder)] == []
        assert mistakes_of(load(folder))
        for file in folder.parents[1].rglob("*.py"):
            compile(file.read_text(encoding="utf-8"), file, "exec")


@pytest.mark.parametrize("kind", KINDS, ids=lambda kind: kind.name)
def test_each_rule_of_a_kind_has_a_check_and_two_mistakes_that_break_it(kind: ExerciseKind, course: Path) -> None:
    exercise = load(course / "exercises" / exercise_of(kind.name))
    rules = rules_of(exercise.task)
    assert len(rules) >= 5
    checks = "".join(file.read_text(encoding="utf-8") for file in exercise.check_files)
    broken = Counter(
        rule for mistake in mistakes_of(exercise) for name in mistake.breaks for rule in named_by(name, rules)
    )
    for rule in rules:
        assert re.search(rf'rule=[^\n]*"{rule.id}"', checks), rule
        assert broken[rule.id] >= 2, rule


def test_a_class_never_hides_what_the_program_imports(tmp_path: Path) -> None:
    write_exercise(tmp_path, "float64", "Any title", BY_NAME["filter"])
    assert load(tmp_path / "exercises" / "float64").class_name == "Float64Node"


def test_the_command_says_what_it_made_and_how_to_grade_it(course: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(course)
    done = made("--exercise", "front_door", "--kind", "service-server", "--title", "A door")
    assert 'Made the exercise "A door" (service-server)' in done.output
    assert "spinbook grade front_door solutions/front_door/solution.py" in done.output
    made_files = [file for part in ("exercises", "solutions") for file in (course / part / "front_door").rglob("*.*")]
    assert all(file.name in done.output for file in made_files)


def test_an_unknown_kind_is_answered_with_the_kinds_that_there_are(
    course: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.chdir(course)
    done = made("--exercise", "front_gate", "--kind", "service")
    assert done.exit_code == 2
    assert all(f"{kind.name:<15} {kind.summary}" in done.output for kind in KINDS)
    assert not (course / "exercises" / "front_gate").exists()


def test_help_says_what_each_kind_is() -> None:
    done = made("--help")
    assert all(f"{kind.name:<15} {kind.summary}" in done.output for kind in KINDS)


def test_a_kind_needs_the_name_of_an_exercise() -> None:
    done = made("robots", "--kind", "filter")
    assert done.exit_code == 2
    assert "give --exercise NAME, too" in done.output


def test_an_exercise_that_exists_is_refused_whatever_its_kind(course: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(course)
    done = made("--exercise", exercise_of("filter"), "--kind", "publisher")
    assert isinstance(done.exception, SpinbookError)
    assert "already" in str(done.exception)
