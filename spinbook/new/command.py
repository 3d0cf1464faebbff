"""`spinbook new`: a course or an exercise to start from."""

from __future__ import annotations

from pathlib import Path

import click

from grader.exercise.loading import load
from groundwork.files import from_here
from spinbook.course.course import find_course
from spinbook.new.kind import ExerciseKind
from spinbook.new.templates import (
    BY_NAME,
    EXERCISE,
    KINDS,
    default_kind,
    exercise_name,
    package_name,
    title_of,
    words,
    write_course,
    write_exercise,
    write_solution,
)

_COURSE = """\
Made the course "{title}" in {folder}. It works as it is. Go on with:

  cd {folder}
  spinbook lint                 what will not run in the chapters, and why
  spinbook build --execute      the notebook, run with real nodes
  spinbook grade {exercise} solutions/{exercise}/solution.py
  pytest tests                  right solutions pass, mistakes are caught

README.md says how to make it yours."""

_EXERCISE = """\
Made the exercise "{title}" ({kind}). It works as it is. Make it yours in this order, and grade the solution
after each step:

  exercises/{name}/task.md            what students read: every rule that a check relies on
  exercises/{name}/exercise.toml      points, names, topics, services, actions, parameters
  solutions/{name}/solution.py        your solution; the starter is made from it
  exercises/{name}/scenarios.py       what the node is run against
  exercises/{name}/checks.py          checks that students may read
  exercises/{name}/hidden_checks.py   checks that they may not
  solutions/{name}/right/             other right solutions: {right}
  solutions/{name}/mistakes.md        usual mistakes, as edits of the solution, with the checks that catch them

  spinbook grade {name} {path}

To show it in a chapter, write this line there:  <!-- exercise: {name} -->"""

_SOLUTION = """\
Made {path}: a program with every topic, service, action and parameter of exercises/{name}/exercise.toml.
Write what it does between its markers. The starter is this file without those parts: move a marker up if
students are to create an end themselves."""


def _listed() -> str:
    return "\n".join(f"  {kind.name:<15} {kind.summary}" for kind in KINDS)


def _kind(context: click.Context, parameter: click.Parameter, name: str | None) -> ExerciseKind | None:
    if name is not None and name not in BY_NAME:
        raise click.BadParameter(f"There is no kind {name!r}. These are the kinds:\n{_listed()}")
    return BY_NAME[name] if name is not None else None


@click.command(context_settings={"help_option_names": ["-h", "--help"]}, epilog=f"\b\nKinds of exercises:\n{_listed()}")
@click.argument("course", required=False, type=click.Path(path_type=Path))
@click.option("--exercise", metavar="NAME", help="Make one more exercise in the current course.")
@click.option(
    "--kind", metavar="KIND", callback=_kind, help="What kind of node students write, see below.  [default: filter]"
)
@click.option("--solution", metavar="NAME", help="Write a first solution.py for an exercise, from its exercise.toml.")
@click.option("--title", help="The title of the course or the exercise.  [default: its name, in words]")
def new(
    course: Path | None, exercise: str | None, kind: ExerciseKind | None, solution: str | None, title: str | None
) -> None:
    """Make a small course of your own, or one more exercise, that you can build, check and grade at once.

    \b
      spinbook new my-robots                   a course, in the new folder my-robots
      spinbook new my-robots --title "Robots"  the same, with a title
      spinbook new --exercise gripper_force    an exercise, in the course in which you are
      spinbook new --exercise door --kind service-server
      spinbook new --solution door             solutions/door/solution.py, from the interface in exercise.toml

    A course has a chapter with a publisher and a subscriber, an exercise with checks, its solution and common mistakes,
    tests, and a workflow for CI. An exercise has a task, scenarios, checks, a solution, other right solutions and
    common mistakes. Change them step by step. Existing files are never overwritten.
    """
    if sum(given is not None for given in (course, exercise, solution)) != 1:
        raise click.UsageError("Give one of these: a folder for a course, --exercise NAME, or --solution NAME.")
    if kind is not None and exercise is None:
        raise click.UsageError("--kind needs an exercise to make: give --exercise NAME, too.")
    if course is not None:
        package = package_name(course)
        title = title_of(title or words(course.name), course)
        write_course(course, title, package)
        click.echo(_COURSE.format(title=title, folder=course, exercise=EXERCISE))
        return
    if solution is not None:
        _new_solution(solution)
        return
    assert exercise is not None
    _new_exercise(exercise, kind or default_kind(), title)


def _new_exercise(exercise: str, kind: ExerciseKind, title: str | None) -> None:
    root = find_course(Path.cwd()).root
    name = exercise_name(exercise, root)
    title = title_of(title or words(name), root / "exercises" / name)
    write_exercise(root, name, title, kind)
    folder = root / "solutions" / name
    right = ", ".join(sorted(file.name for file in (folder / "right").glob("*.py")))
    path = from_here(folder / "solution.py")
    click.echo(_EXERCISE.format(title=title, kind=kind.name, name=name, right=right, path=path))


def _new_solution(name: str) -> None:
    root = find_course(Path.cwd()).root
    exercise = load(root / "exercises" / name)
    click.echo(_SOLUTION.format(name=name, path=from_here(write_solution(root, exercise))))
