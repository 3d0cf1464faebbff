"""`spinbook gradebook`: one page and one table for all exercises of a course."""

from __future__ import annotations

import contextlib
import sys
from pathlib import Path

import click

from grader.classroom.course_gradebook import course_csv, course_page, course_rows, graded_exercises, may_be_same
from grader.classroom.tables import BYTE_ORDER_MARK
from grader.exercise.exercise import ExerciseError
from grader.exercise.loading import load
from groundwork.files import write_if_changed
from groundwork.words import counted
from spinbook.chapters import read_all
from spinbook.course.course import Course, find_course

NOTHING_GRADED = 1


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("results", type=click.Path(path_type=Path, exists=True, file_okay=False))
@click.option("--course", "start", type=click.Path(path_type=Path), default=".", help="The course's folder.")
def gradebook(results: Path, start: Path) -> None:
    """Write one page and one table for all exercises that a class was graded for.

    RESULTS has a folder for each exercise, which `spinbook grade` has written:

    \b
      spinbook grade joint_velocity submissions/joint_velocity --out results/joint_velocity
      spinbook grade heartbeat      submissions/heartbeat      --out results/heartbeat
      spinbook gradebook results/

    It writes RESULTS/index.html (points so far, what the class struggles with, a row for each student and a column for
    each exercise) and RESULTS/gradebook.csv. The exercises are in the order of the chapters.

    Exit codes: 0 written, 1 there are no grades in RESULTS, 2 wrong usage.
    """
    course = find_course(start)
    order = exercises_in_order(course)
    exercises = graded_exercises(results, order, _titles(course))
    if not exercises:
        message = f"{results}: no grades. Grade an exercise first: spinbook grade EXERCISE SUBMISSIONS --out"
        click.echo(f"{message} {results / 'EXERCISE'}", err=True)
        sys.exit(NOTHING_GRADED)
    rows = course_rows(exercises)
    for unreadable in (folder for exercise in exercises for folder in exercise.unreadable):
        click.echo(f"{unreadable}: this grade can't be read, and counts as not handed in. Grade it again.", err=True)
    for names in may_be_same(rows):
        advice = "If they are one student, grade each exercise with the same --roster."
        click.echo(f"counted as {len(names)} students: {', '.join(names)}. {advice}", err=True)
    write_if_changed(results / "index.html", course_page(course.title, exercises, rows), durable=True)
    write_if_changed(results / "gradebook.csv", BYTE_ORDER_MARK + course_csv(exercises, rows), durable=True)
    click.echo(f"{counted(len(rows), 'student')}, exercises: {', '.join(exercise.name for exercise in exercises)}.")
    click.echo(f"Open {results / 'index.html'}.")


def exercises_in_order(course: Course) -> tuple[str, ...]:
    """Return the course's exercises in the order in which its chapters have them, then those that no chapter has."""
    chapters = [reading.chapter for reading in read_all(course) if reading.chapter]
    named = [cell.name for chapter in chapters for cell in chapter.exercises if cell.name]
    return tuple(dict.fromkeys([*named, *sorted(course.exercises)]))


def _titles(course: Course) -> dict[str, str]:
    titles = {}
    for name in course.exercises:
        with contextlib.suppress(ExerciseError):  # the page uses its name
            titles[name] = load(course.root / "exercises" / name).title
    return titles
