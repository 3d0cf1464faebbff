"""The command `spinbook gradescope`: writes the zip to upload to Gradescope as an autograder."""

from __future__ import annotations

import io
import shlex
import sys
import zipfile
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import metadata
from pathlib import Path

import click

from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.loading import COURSE, NoExercise, find, load
from grader.gradescope.pins import NAME, hashed_pins, pins
from grader.grading.reference import solution_file
from grader.sandbox.middleware import MiddlewareUnavailable
from grader.sandbox.program import Isolation
from grader.wheels import compiled_wheels
from interface_compiler.wheel_file import record, zipped

#: The root of this software's source: the folder with pyproject.toml.
SOURCE = Path(__file__).parents[2]

#: The parts of it that the container needs.
NEEDED = ("pyproject.toml", "README.md", "LICENSE")
LOCKS = ("constraints.txt", "constraints-ros.txt")

PACKAGES = (
    *("grader", "spinbook", "packages/groundwork", "packages/rmw_lockstep"),
    *("packages/interface_compiler", "packages/ros_in_python"),
)

#: The same content gives the same bytes: every entry has the earliest date that a zip can name.
DATE = (1980, 1, 1, 0, 0, 0)


class NoSource(Exception):
    """Raised if there is neither a checkout nor a wheel of what the container must install."""


def bundle(exercise: Exercise, isolation: Isolation | None = None) -> bytes:
    """Return the zip's bytes, the same each time for the same content.

    Of the solutions it contains only `solution.py`, which a student could read only by breaking out of the sandbox.
    `isolation` is the level at which students' programs run, None for the strongest that works in the container. Raises
    `NoSource`, and `ExerciseError` if there is no solution.
    """
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w", zipfile.ZIP_DEFLATED) as archive:
        for name, (content, mode) in autograder_files(exercise, isolation).items():
            _add(archive, name, content, mode)
    return out.getvalue()


def autograder_files(exercise: Exercise, isolation: Isolation | None = None) -> dict[str, tuple[bytes, int]]:
    """Return the content and mode of each file of an autograder, by name. Raises as `bundle` does."""
    files = {
        name: (_script(script, exercise, isolation).encode(), 0o755)
        for name, script in (("setup.sh", "setup.sh"), ("run_autograder", "run_autograder.sh"))
    }
    software = _source() if (SOURCE / "pyproject.toml").exists() else _installed()
    packages = "".join(f"{package}\n" for package in exercise.packages).encode()
    for name, content in {**software, **_compiled(), **({"packages.txt": packages} if packages else {})}.items():
        files[f"course/{name}"] = (content, 0o644)
    for name, file in _files(exercise):
        files[f"course/{name}"] = (file.read_bytes(), 0o644)
    return files


def _source() -> dict[str, bytes]:
    """Return the files of a checkout that the container needs."""
    files = {name: (SOURCE / name).read_bytes() for name in NEEDED}
    files["pins.txt"] = hashed_pins(*(SOURCE / name for name in LOCKS)).encode()
    for package in PACKAGES:
        for file in _within(SOURCE / package, but="tests"):
            files[f"{package}/{file.relative_to(SOURCE / package)}"] = file.read_bytes()
    return files


def _installed() -> dict[str, bytes]:
    """Return the wheel that is installed here, and the versions of its dependencies."""
    try:
        name, content = installed_wheel()
    except NotInstalled as error:
        raise NoSource(str(error)) from None
    return {name: content, "pins.txt": "".join(f"{pin}\n" for pin in pins()).encode()}


def _compiled() -> dict[str, bytes]:
    """Return the wheels of what is compiled: they fit every container that PyPI's ROS 2 fits."""
    try:
        return {f"wheels/{name}": content for name, content in compiled_wheels().items()}
    except MiddlewareUnavailable as error:
        raise NoSource(str(error)) from None


def _script(file: str, exercise: Exercise, isolation: Isolation | None) -> str:
    text = Path(__file__).with_name(file).read_text(encoding="utf-8")
    level = shlex.quote(isolation.value) if isolation else ""
    return text.replace("@EXERCISE@", shlex.quote(exercise.name)).replace("@ISOLATION@", level)


def _files(exercise: Exercise) -> Iterator[tuple[str, Path]]:
    """Yield the files of the course itself, with their names in the container."""
    for file in _within(exercise.folder):
        yield f"exercises/{exercise.name}/{file.relative_to(exercise.folder)}", file
    yield f"solutions/{exercise.name}/solution.py", solution_file(exercise)
    course = exercise.folder.parent.parent / COURSE
    if course.is_file():
        yield course.name, course


def _within(folder: Path, but: str = "") -> list[Path]:
    """Return the files below `folder`, without caches, hidden files and the folder `but` in it."""
    files = [file for file in folder.rglob("*") if file.is_file() and file.suffix != ".pyc"]
    parts = {file: file.relative_to(folder).parts for file in files}
    kept = [file for file in files if parts[file][0] != but and not any(part.startswith(".") for part in parts[file])]
    return sorted(file for file in kept if "__pycache__" not in file.parts)


def _add(archive: zipfile.ZipFile, name: str, content: bytes, mode: int) -> None:
    entry = zipfile.ZipInfo(name, DATE)
    entry.external_attr = (0o100000 | mode) << 16
    entry.compress_type = zipfile.ZIP_DEFLATED
    archive.writestr(entry, content)


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
    except (NoExercise, NoSource) as error:
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


#: The files that the installer adds to a wheel's own files.
_INSTALLERS = ("INSTALLER", "REQUESTED", "direct_url.json", "RECORD")


class NotInstalled(Exception):
    """Raised if this software is not installed from a wheel; says what to do."""


def installed_wheel() -> tuple[str, bytes]:
    """Return the name and the content of the wheel that this software was installed from, rebuilt from its files.

    A wheel is a zip whose RECORD lists every file with its hash (PEP 427, and "Recording installed projects"). Raises
    `NotInstalled`.
    """
    try:
        distribution = metadata.distribution(NAME)
    except metadata.PackageNotFoundError:
        raise NotInstalled(f"{NAME} is not installed here: pip install {NAME}") from None
    files = {}
    for file in distribution.files or ():
        name = file.as_posix()
        if not name.startswith("..") and "__pycache__" not in name and name.rpartition("/")[2] not in _INSTALLERS:
            files[name] = Path(str(distribution.locate_file(file))).read_bytes()
    if "grader/__init__.py" not in files:
        raise NotInstalled(f"{NAME} is installed neither from a wheel nor in a checkout: pip install it from a wheel.")
    listing = f"{NAME}-{distribution.version}.dist-info/RECORD"
    files[listing] = record(files, listing)
    return f"{NAME}-{distribution.version}-py3-none-any.whl", zipped(files, last=listing)
