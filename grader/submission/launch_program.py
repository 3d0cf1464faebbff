"""Makes a launch file the program: the grader starts what it describes, with the packages that were handed in with it.

Nothing of a submission is run here: executables are read from the packages' setup files.
"""

from __future__ import annotations

import posixpath
import re
from collections.abc import Iterator, Mapping

from grader.exercise.data_files import DATA, data_files
from grader.exercise.exercise import Exercise
from grader.recording.places import LAUNCHER
from grader.submission import packages
from grader.submission.entry_points import entry_points_of, is_below, package_name, roots
from grader.submission.file_kinds import original_name
from grader.submission.launch_files import LAUNCH_FILE
from grader.submission.problems import AmbiguousProgram, Unreadable
from grader.submission.unreadable import not_python, text_of

#: The file that starts the launch.
MAIN = "start_launch_file.py"

_START = """\
{note}
import sys
from pathlib import Path

from ros_in_python.launch.unbuilt import UnbuiltExecutable, UnbuiltPackage, launch_unbuilt

sys.exit(launch_unbuilt({file!r}, {packages}, Path(__file__).parent, sys.argv[1:]))
"""


def launch_file_in(files: Mapping[str, bytes], exercise: Exercise) -> str:
    """Return the path of the launch file among the files: of the exercise's name, or the only one that none includes.

    Raises `Unreadable` and `AmbiguousProgram`.
    """
    every = [name for name in sorted(files) if LAUNCH_FILE.search(original_name(name))]
    own = [name for name in every if is_called(name, exercise)]
    texts = {name: files[name].decode(errors="replace") for name in every}
    included = {name for name in every for other in every if posixpath.basename(name) in texts[other]}
    fitting = own or [name for name in every if name not in included] or every
    if not fitting:
        there = ", ".join(sorted(files)[:5])
        raise Unreadable(
            f"None of the files that were handed in is a launch file: {there}. Name yours {exercise.file_name}."
        )
    if len({files[name] for name in fitting}) > 1:
        names = ", ".join(fitting)
        raise AmbiguousProgram(f"There are {len(fitting)} launch files in it, and they differ: {names}. Which counts?")
    return fitting[0]


def is_called(name: str, exercise: Exercise) -> bool:
    """Return whether a file has the name of the exercise's launch file, in Python, XML or YAML."""
    return LAUNCH_FILE.search(original_name(name)) is not None and _stem(name) == _stem(exercise.file_name)


def launch_file_name(name: str, content: bytes, exercise: Exercise) -> str:
    """Return the name under which a lone launch file in XML or YAML runs. Raises `Unreadable`.

    Its content decides which of the two it is: `ros2 launch` goes by the name, which may have been changed on the way.
    """
    if problem := not_python(content) if content.strip() else "Your file is empty.":
        raise Unreadable(problem)
    is_xml = text_of(content).lstrip().startswith("<")
    return f"{_stem(exercise.file_name)}.launch.{'xml' if is_xml else 'yaml'}"


def _stem(name: str) -> str:
    """Return a launch file's name without its ending: both of two_arms_launch.py and two_arms.launch.xml."""
    return re.sub(r"[._]?launch(?:\.(?:py|xml|ya?ml))?$", "", original_name(name).lower())


def program_files(file: str, files: Mapping[str, bytes], exercise: Exercise) -> dict[str, bytes]:
    """Return all files of a program that launches `file`, with the one that starts it."""
    ours = data_files(exercise)
    found = {**_packages(files, exercise.name), **_packages(ours, DATA)}
    start = _START.format(
        note=LAUNCHER, file=file, packages=f"{{{', '.join(f'{k!r}: {v}' for k, v in found.items())}}}"
    )
    return {**files, MAIN: start.encode()}


def _packages(files: Mapping[str, bytes], otherwise: str) -> dict[str, str]:
    """Return the source of each package's `UnbuiltPackage`, by its name.

    Python files that are in no package are executables of the folder that they are in, or at the top of `otherwise`.
    """
    folders = {package_name(files, root) or otherwise: root for root in roots(files)}
    executables = {name: dict(_of_package(root, files)) for name, root in folders.items()}
    for file in packages.programs(files):
        if not any(is_below(file, root) for root in folders.values()):
            folder = posixpath.dirname(file)
            name = posixpath.basename(folder) or otherwise
            folders.setdefault(name, folder)
            stem = posixpath.basename(file).removesuffix(".py")
            executables.setdefault(name, {}).setdefault(stem, f"UnbuiltExecutable({file!r}, {folder!r})")
    return {
        name: f"UnbuiltPackage({folder!r}, {{{', '.join(f'{k!r}: {v}' for k, v in executables[name].items())}}})"
        for name, folder in folders.items()
    }


def _of_package(root: str, files: Mapping[str, bytes]) -> Iterator[tuple[str, str]]:
    for entry in entry_points_of(files, root):
        path = entry.module.replace(".", "/")
        inside = next((end for end in (f"{path}.py", f"{path}/__init__.py") if entry.file.endswith(end)), entry.file)
        folder = entry.file.removesuffix(inside).rstrip("/") if entry.module else posixpath.dirname(entry.file)
        words = (entry.file, folder, *([entry.module, entry.function] if entry.module else []))
        if "/" not in entry.name:
            yield entry.name, f"UnbuiltExecutable{words!r}"
