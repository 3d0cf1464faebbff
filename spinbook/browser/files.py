"""The files a site needs so that its pages can run nodes: Pyodide, the archives, the exercises' public parts."""

from __future__ import annotations

import json
import os
import re
import sys
from collections.abc import Iterable, Mapping
from dataclasses import replace
from pathlib import Path

from grader.exercise.data_files import DATA, LACKS
from grader.exercise.exercise import Exercise
from grader.exercise.writing import to_toml
from grader.submission.code import STARTER
from grader.workers.pool import WorkerPool
from spinbook.browser.archives import check_archive, ros_archive, share_archive
from spinbook.browser.compiled import with_compiled_modules
from spinbook.build.digest import digest
from spinbook.handout.student_copy import exercise_files

# Pyodide (https://pyodide.org, Mozilla Public License 2.0) comes from npm; fetch-pyodide.sh pins the digest.


_STDLIB = "python_stdlib.zip"
#: The files of Pyodide that a page loads. Its list of packages is replaced by an empty one: none is ever fetched.
FILES = ("pyodide.mjs", "pyodide.asm.mjs", "pyodide.asm.wasm", _STDLIB)
_LOCK = "pyodide-lock.json"
_FOLDER = Path("share", "spinbook", "pyodide")


def pyodide_folder() -> Path | None:
    """Return Pyodide's folder, or None if set-up could not fetch it. SPINBOOK_PYODIDE names another folder."""
    folder = Path(os.environ.get("SPINBOOK_PYODIDE") or Path(sys.prefix) / _FOLDER)
    return folder if all((folder / name).is_file() for name in (*FILES, _LOCK)) else None


def pyodide_files(folder: Path) -> dict[str, bytes]:
    """Return Pyodide's files as a page gets them: name -> content."""
    files = {name: (folder / name).read_bytes() for name in FILES}
    lock = json.loads((folder / _LOCK).read_text(encoding="utf-8"))
    files[_LOCK] = json.dumps({"info": lock["info"], "packages": {}}).encode()
    return files


#: The folder of these files in the site.
FOLDER = "run"
_OFFLINE, _LIST = "offline.js", "files.json"
_STATIC = Path(__file__).with_name("static")
_SCRIPTS = frozenset(file.name for file in _STATIC.glob("*.js"))


def can_run() -> bool:
    """Return whether pages can run nodes, that is, whether Pyodide is there."""
    return pyodide_folder() is not None


def run_files(exercises: Mapping[str, bytes]) -> dict[str, str | bytes]:
    """Return the files: path in the site -> content; none if Pyodide is missing.

    `exercises` are the public parts of the course's exercises: path in the archive of checks -> content.
    """
    folder = pyodide_folder()
    if folder is None:
        return {}
    files: dict[str, bytes] = pyodide_files(folder)
    files |= {file.name: file.read_bytes() for file in sorted(_STATIC.iterdir())}
    # A service worker only serves its own folder and those below.
    at_the_top = {_OFFLINE: files.pop(_OFFLINE)}
    files |= {"share.zip": share_archive(), "check.zip": check_archive(exercises)}
    files |= with_compiled_modules(folder, {"ros.zip": ros_archive(), _STDLIB: files[_STDLIB]})
    version = digest(*(part for name in sorted(files) for part in (name, files[name])))[:16]
    files = {name: _with_version(name, data, version) for name, data in files.items()}
    files[_LIST] = _listed(version, files)
    return {**at_the_top, **{f"{FOLDER}/{name}": data for name, data in files.items()}}


def run_version(files: Mapping[str, str | bytes]) -> str:
    """Return the version of the files from `run_files` among a site's files; "" if there are none."""
    listed = files.get(f"{FOLDER}/{_LIST}")
    return str(json.loads(listed)["version"]) if listed else ""


_ADDRESSES = "address.js"
_IMPORT = re.compile(rb'((?:from|import) "\./[\w.]+\.js)"')


def _with_version(name: str, data: bytes, version: str) -> bytes:
    """Return a script that loads the others by addresses with this version, so that a page never mixes two."""
    if name == _ADDRESSES:
        return data.replace(b'VERSION = "VERSION"', f'VERSION = "{version}"'.encode())
    if name not in _SCRIPTS:
        return data
    return _IMPORT.sub(rb"\1?v=" + version.encode() + b'"', data)


def _listed(version: str, files: Mapping[str, bytes]) -> bytes:
    """Return the list of what to load, for the page: each file's size in bytes and its digest."""
    listed = {name: [len(files[name]), digest(files[name])[:16]] for name in sorted(files)}
    return json.dumps({"version": version, "files": listed}).encode()


#: The parts of a student's copy that the checks need.
_NEEDED = ("exercise.toml", "checks.py", "public.json", "task.md")


def public_parts(exercises: Iterable[Exercise]) -> dict[str, bytes]:
    """Return what a student's copy of each exercise contains, by its path in the archive of checks: nothing hidden.

    Runs the solutions through their public scenarios, unless that was done before. Raises `ExerciseError`.
    """
    files: dict[str, bytes] = {}
    with WorkerPool() as workers:
        for exercise in exercises:
            copy = exercise_files(exercise, workers)
            code = {name for name in copy if name.endswith(".py")} - {exercise.file_name}  # such as a world
            needed = [name for name in copy if name in code or name in _NEEDED]
            files |= {f"exercises/{exercise.name}/{name}": copy[name] for name in needed}
            files |= {f"exercises/{exercise.name}/{name}": text for name, text in _limits(exercise, copy).items()}
            # The grader ignores code that equals the starter, so it has to know the starter.
            files[f"exercises/{exercise.name}/{STARTER}"] = copy[exercise.file_name]
    return files


def _limits(exercise: Exercise, copy: Mapping[str, bytes]) -> dict[str, bytes]:
    """Return what differs for a page, which has no packages and no data: why it can't check, and the interface."""
    lacks = ["files that programs read"] * any(name.startswith(f"{DATA}/") for name in copy)
    lacks += ["a launch file"] * bool(exercise.nodes)
    lacks += [", ".join(package.partition("==")[0] for package in exercise.packages)] * bool(exercise.packages)
    if not lacks:
        return {}
    text = f"This exercise uses {' and '.join(lacks)}, which a web page does not have. Check it in the notebook."
    return {LACKS: text.encode(), "exercise.toml": to_toml(replace(exercise, packages=())).encode()}
