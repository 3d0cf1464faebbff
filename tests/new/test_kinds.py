"""`spinbook new --kind` makes an exercise of each kind that works: right solutions pass, mistakes are caught."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

import pytest
from click.testing import CliRunner, Result

from grader.audit.mutants.making import mutants_of
from grader.audit.survivors import listed
from grader.exercise import load, starter
from grader.grading import Options, grading_of
from grader.grading.grading import Grading
from grader.submission import read
from grader.submission.reading import of_source
from grader.workers import WorkerPool
from spinbook.new.command import new
from spinbook.new.writing import BY_NAME, KINDS, write_course
from spinbook.problem import SpinbookError

#: For each kind, a usual mistake that the default suite grades. The soak grades all of them.
MISTAKES = {
    "filter": "one_message_late",
    "publisher": "computers_clock",
    "latched-topic": "volatile_board",
    "parameters": "reads_once",
    "service-server": "returns_nothing",
    "service-client": "waits_in_the_callback",
    "action-server": "forgets_succeed",
    "action-client": "ignores_status",
    "closed-loop": "wraps_the_angle",
    "several-nodes": "never_closes",
}


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


#: Their scenarios last longest, so that only the soak grades them.
LONG = ("publisher", "action-client", "closed-loop", "several-nodes")


@pytest.fixture(
    scope="module",
    params=[pytest.param(kind, marks=pytest.mark.soak if kind in LONG else ()) for kind in MISTAKES],
)
def grading(request: pytest.FixtureRequest, course: Path, workers: WorkerPool) -> Grading:
    """A grading for the exercise of a kind: its solution has passed every check."""
    return grading_of(load(course / "exercises" / exercise_of(request.param)), Options(), workers)


def folder_of(grading: Grading) -> Path:
    exercise = grading.runner.exercise
    return exercise.folder.parents[1] / "solutions" / exercise.name


def caught_and_named(grading: Grading, mistake: Path) -> tuple[set[str], set[str]]:
    """Return the checks that a mistake fails, and those that its docstring says it fails."""
    grade = grading.grade(read(str(mistake), grading.runner.exercise))
    return {verdict.name for verdict in grade.verdicts if verdict.status == "failed"}, named_by(mistake)


def named_by(mistake: Path) -> set[str]:
    """Return the checks that a mistake's docstring says it fails."""
    header = ast.get_docstring(ast.parse(mistake.read_text(encoding="utf-8"))) or ""
    return set(re.findall(r"^- (test_\w+)$", header, re.MULTILINE))


def test_the_starter_gets_nothing_and_a_usual_mistake_loses_what_it_names(
    grading: Grading, request: pytest.FixtureRequest
) -> None:
    source = starter((folder_of(grading) / "solution.py").read_text(encoding="utf-8"))
    assert grading.grade(of_source("starter", source.encode(), grading.runner.exercise)).score == 0
    kind = next(kind for kind in MISTAKES if exercise_of(kind) == grading.runner.exercise.name)
    failed, named = caught_and_named(grading, folder_of(grading) / "mistakes" / f"{MISTAKES[kind]}.py")
    assert failed == named


@pytest.mark.soak
def test_every_right_solution_gets_full_marks(grading: Grading) -> None:
    files = sorted((folder_of(grading) / "right").glob("*.py"))
    assert len(files) >= 3
    for file in files:
        grade = grading.grade(read(str(file), grading.runner.exercise))
        assert grade.full_marks, (file.name, [v for v in grade.verdicts if v.status != "passed"])


@pytest.mark.soak
def test_every_mistake_loses_exactly_the_checks_that_it_names(grading: Grading) -> None:
    files = sorted((folder_of(grading) / "mistakes").glob("*.py"))
    assert len(files) >= 8
    for file in files:
        failed, named = caught_and_named(grading, file)
        assert failed == named, file.name


@pytest.mark.soak
def test_a_class_of_six_gets_its_grades_side_by_side(grading: Grading) -> None:
    folder, exercise = folder_of(grading), grading.runner.exercise
    right = [folder / "solution.py", *sorted((folder / "right").glob("*.py"))[:2]]
    wrong = sorted((folder / "mistakes").glob("*.py"))[:2]
    empty = of_source("starter", starter(right[0].read_text(encoding="utf-8")).encode(), exercise)
    with ThreadPoolExecutor(3) as desk:
        grades = list(desk.map(grading.grade, [*(read(str(file), exercise) for file in (*right, *wrong)), empty]))
    assert [grade.full_marks for grade in grades] == [True] * 3 + [False] * 3
    assert [grade.score for grade in grades if grade.submission == "starter"] == [0]
    for file, grade in zip(wrong, grades[3:5], strict=True):
        assert {verdict.name for verdict in grade.verdicts if verdict.status == "failed"} == named_by(file)


def test_the_exercise_has_its_own_names(course: Path) -> None:
    for kind in KINDS:
        name = exercise_of(kind.name)
        files = [file for part in ("exercises", "solutions") for file in (course / part / name).rglob("*.*")]
        text = "".join(file.read_text(encoding="utf-8") for file in files)
        assert kind.exercise not in text
        assert f'title = "{name.replace("_", " ").capitalize()}"' in text


def test_the_listed_survivors_are_mutants_of_the_exercise_whatever_it_is_called(course: Path) -> None:
    found = 0
    for kind in KINDS:
        exercise = load(course / "exercises" / exercise_of(kind.name))
        if survivors := set(listed(exercise)):
            source = (course / "solutions" / exercise.name / "solution.py").read_text(encoding="utf-8")
            assert survivors <= {mutant.id for mutant in mutants_of(source, exercise)}, kind.name
            found += len(survivors)
    assert found


def test_the_command_says_what_it_made_and_how_to_grade_it(course: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(course)
    done = made("--exercise", "front_door", "--kind", "service-server", "--title", "A door")
    assert 'Made the exercise "A door" (service-server)' in done.output
    assert "spinbook grade front_door solutions/front_door/solution.py" in done.output


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
    assert set(BY_NAME) == set(MISTAKES)
