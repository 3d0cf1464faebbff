"""`spinbook new`: a course or an exercise to go on from."""

from __future__ import annotations

from pathlib import Path

import click

from spinbook.course.course import find_course
from spinbook.new.kind import BY_NAME, KINDS, Kind
from spinbook.new.writing import EXERCISE, exercise_name, package_name, title_of, words, write_course, write_exercise

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

  exercises/{name}/task.md             what students read: every rule that a check relies on
  exercises/{name}/exercise.toml       points, names, topics, services, actions, parameters
  solutions/{name}/{solution:<19} your solution; the starter is made from it
  exercises/{name}/scenarios.py        what the node is run against
  exercises/{name}/checks.py           checks that students may read
  exercises/{name}/hidden_checks.py    checks that they may not
  solutions/{name}/right, mistakes     other right solutions, and usual mistakes with the checks that catch them

  spinbook grade {name} {path}

To show it in a chapter, write this line there:  <!-- exercise: {name} -->"""


def _listed() -> str:
    return "\n".join(f"  {kind.name:<15} {kind.summary}" for kind in KINDS)


def _kind(context: click.Context, parameter: click.Parameter, name: str | None) -> Kind | None:
    if name is not None and name not in BY_NAME:
        raise click.BadParameter(f"There is no kind {name!r}. These are the kinds:\n{_listed()}")
    return BY_NAME[name] if name is not None else None


@click.command(context_settings={"help_option_names": ["-h", "--help"]}, epilog=f"\b\nKinds of exercises:\n{_listed()}")
@click.argument("course", required=False, type=click.Path(path_type=Path))
@click.option("--exercise", metavar="NAME", help="Make one more exercise, in the course in which you are.")
@click.option(
    "--kind", metavar="KIND", callback=_kind, help="What kind of node students write, see below.  [default: filter]"
)
@click.option("--title", help="What the course or the exercise is called.  [default: its name, in words]")
def new(course: Path | None, exercise: str | None, kind: Kind | None, title: str | None) -> None:
    """Make a small course of your own, or one more exercise, that builds, checks and grades at once.

    \b
      spinbook new my-robots                   a course, in the new folder my-robots
      spinbook new my-robots --title "Robots"  the same, with a title
      spinbook new --exercise gripper_force    an exercise, in the course in which you are
      spinbook new --exercise door --kind service-server

    A course has a chapter with a publisher and a subscriber, an exercise with checks, its solution and usual mistakes,
    tests that prove it, and a workflow for CI. An exercise has a task, scenarios, checks, a solution, other right
    solutions and usual mistakes. Go on from there. Nothing that exists is ever overwritten.
    """
    if (course is None) == (exercise is None):
        raise click.UsageError("Name a folder for a course, or give --exercise NAME: one of the two.")
    if kind is not None and exercise is None:
        raise click.UsageError("--kind says what kind of exercise to make: give --exercise NAME, too.")
    if course is not None:
        package = package_name(course)
        title = title_of(title or words(course.name), course)
        write_course(course, title, package)
        click.echo(_COURSE.format(title=title, folder=course, exercise=EXERCISE))
        return
    assert exercise is not None
    _new_exercise(exercise, kind or KINDS[0], title)


def _new_exercise(exercise: str, kind: Kind, title: str | None) -> None:
    root = find_course(Path.cwd()).root
    name = exercise_name(exercise, root)
    title = title_of(title or words(name), root / "exercises" / name)
    write_exercise(root, name, title, kind)
    folder = root / "solutions" / name
    solution = next(file for file in (folder / "solution.py", folder / "solution") if file.exists())
    shown = solution.relative_to(Path.cwd()) if solution.is_relative_to(Path.cwd()) else solution
    click.echo(_EXERCISE.format(title=title, kind=kind.name, name=name, solution=solution.name, path=shown))
