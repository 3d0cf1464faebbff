"""The command `spinbook gradescope`: writes the zip to upload to Gradescope as an autograder."""

from __future__ import annotations

import shlex
import sys
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path

import click

from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.loading import COURSE, find, load
from grader.gradescope.own_wheel import SOURCE, NoWheel, as_wheel, is_checkout, wheel_contents
from grader.gradescope.pins import LOCKS, PLOTS, PLOTS_PINS, hashed_pins, needed, pinned, pins
from grader.grading.reference import solution_file
from grader.sandbox.middleware import MiddlewareUnavailable
from grader.sandbox.program import Isolation
from grader.wheels import compiled_wheels
from interface_compiler.wheel_file import zipped

#: The files that Gradescope runs, and those that they are made from.
SCRIPTS = {"setup.sh": "setup.sh", "run_autograder": "run_autograder.sh"}


def bundle(exercise: Exercise, isolation: Isolation | None = None) -> bytes:
    """Return the zip's bytes, the same each time for the same content.

    Of the solutions it contains only `solution.py`, which a student could read only by breaking out of the sandbox.
    `isolation` is the level at which students' programs run, None for the strongest that works in the container. Raises
    `NoWheel`, `MiddlewareUnavailable`, and `ExerciseError` if there is no solution.
    """
    return zipped(autograder_files(exercise, isolation), modes=dict.fromkeys(SCRIPTS, 0o755))


def autograder_files(exercise: Exercise, isolation: Isolation | None) -> dict[str, bytes]:
    """Return the content of each file of an autograder, by name. Raises as `bundle` does."""
    name, wheel = as_wheel(wheel_contents())
    course = {name: wheel, **{file: text.encode() for file, text in _pins().items()}}
    # The wheels of what is compiled fit every container that PyPI's ROS 2 fits.
    course |= {f"wheels/{name}": content for name, content in compiled_wheels().items()}
    files = {name: file.read_bytes() for name, file in _files(exercise)}
    if packages := [*exercise.packages, *_test_messages(files)]:
        course["packages.txt"] = "".join(f"{package}\n" for package in packages).encode()
    course |= files
    scripts = {name: _script(script, exercise, isolation).encode() for name, script in SCRIPTS.items()}
    return {**scripts, **{f"course/{name}": content for name, content in course.items()}}


def _pins() -> dict[str, str]:
    """Return name -> content of the files of pins."""
    if not is_checkout():
        return {"pins.txt": pins()}
    always = needed()
    files = {file: hashed_pins(SOURCE / lock, always) for file, lock in LOCKS.items()}
    return files | {PLOTS_PINS: hashed_pins(SOURCE / LOCKS["pins.txt"], needed(PLOTS, "") - always)}


def _test_messages(files: Mapping[str, bytes]) -> list[str]:
    """Return the package test_msgs, with its version, if the exercise names it: few do, and it is large."""
    return [pinned("ros-jazzy-test-msgs")] if any(b"test_msgs" in content for content in files.values()) else []


def _script(file: str, exercise: Exercise, isolation: Isolation | None) -> str:
    text = Path(__file__).with_name(file).read_text(encoding="utf-8")
    level = shlex.quote(isolation.value) if isolation else ""
    return text.replace("@EXERCISE@", shlex.quote(exercise.name)).replace("@ISOLATION@", level)


def _files(exercise: Exercise) -> Iterator[tuple[str, Path]]:
    """Yield the files of the course itself, with their names in the container."""
    for file in sorted(exercise.folder.rglob("*")):
        parts = file.relative_to(exercise.folder).parts
        if file.is_file() and not any(part.startswith((".", "__pycache__")) for part in parts):
            yield f"exercises/{exercise.name}/{'/'.join(parts)}", file
    yield f"solutions/{exercise.name}/solution.py", solution_file(exercise)
    course = exercise.folder.parent.parent / COURSE
    if course.is_file():
        yield course.name, course


#: The options of every platform's autograder command.
isolation_option = click.option(
    "--isolation",
    type=click.Choice([level.value for level in Isolation]),
    callback=lambda context, option, value: Isolation(value) if value else None,
    help="How to isolate students' nodes on the machine that grades them.  [default: the strongest that works there]",
)


@contextmanager
def author_errors() -> Iterator[None]:
    """End the command with the right exit code if an exercise can't be bundled: 2 wrong usage, 3 the exercise."""
    try:
        yield
    except (NoWheel, MiddlewareUnavailable) as error:
        raise click.UsageError(str(error)) from None
    except ExerciseError as error:
        click.echo(str(error), err=True)
        sys.exit(3)


@click.command(context_settings={"help_option_names": ["-h", "--help"]})
@click.argument("exercise")
@click.option("--out", type=click.Path(path_type=Path), help="The zip to write.  [default: EXERCISE-gradescope.zip]")
@isolation_option
def gradescope(exercise: str, out: Path | None, isolation: Isolation | None) -> None:
    """Write the autograder that Gradescope runs for an EXERCISE, as one zip to upload.

    It holds setup.sh, which installs the grader and ROS 2 when Gradescope builds its container (Ubuntu 22.04 or newer),
    run_autograder, which grades each submission there, the exercise and its solution. Public checks are visible to
    students at once, hidden ones when you publish the grades.

    Exit codes: 0 written, 2 wrong usage, 3 the exercise is at fault.
    """
    with author_errors():
        content = bundle(load(find(exercise, Path.cwd())), isolation)
    file = out or Path(f"{exercise.rstrip('/').split('/')[-1]}-gradescope.zip")
    try:
        file.write_bytes(content)
    except OSError as error:
        raise click.UsageError(f"{file}: {error.strerror}") from None
    click.echo(f"{file}: upload it to Gradescope, under Configure Autograder.")
