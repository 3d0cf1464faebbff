"""Reads a submission: a file, a notebook's cell, an upload or an installed executable."""

from __future__ import annotations

import contextlib
import errno
import hashlib
import json
import os
import re
import stat
from collections.abc import Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

from grader.exercise.exercise import Exercise
from grader.sandbox.program import Program
from grader.submission.several_files import MOST_FILES, files_in, joined, parts
from grader.submission.unreadable import not_python
from grader.submission.upload import NoUpload, Upload, unpack


@dataclass(frozen=True)
class Submission:
    """One submission, read.

    `digest` is the SHA-256 of what was handed in. `program` says how it is started, and is None if it can't be; then
    `problem` tells the student why. `source` is its text, to quote lines from. `warning` tells the instructor what
    is unusual about it, such as an upload that was changed; it costs no points.
    """

    name: str
    digest: str
    file_name: str
    source: str
    program: Program | None
    problem: str = ""
    warning: str = ""


@dataclass(frozen=True)
class Executable:
    """An installed Python executable: its script, the folders it needs to see, and where its modules are."""

    script: Path
    folders: tuple[Path, ...]
    python_path: str

    def digest(self) -> str:
        """SHA-256 of the script and of every Python file next to its modules."""
        total = hashlib.sha256(self.script.read_bytes())
        for folder in self.python_path.split(os.pathsep):
            for file in sorted(Path(folder).rglob("*.py")):
                total.update(file.read_bytes())
        return total.hexdigest()


def find(given: str) -> Executable | str:
    """The executable that `package/executable` names, or a sentence that says why there is none."""
    package, _, name = given.partition("/")
    prefixes = [Path(prefix) for prefix in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if prefix]
    for prefix in prefixes:
        script = prefix / "lib" / package / name
        if script.is_file():
            return _described(prefix, script)
    looked = ", ".join(map(str, prefixes)) or "nowhere: AMENT_PREFIX_PATH is not set"
    return (
        f"{given}: there is no such file, and no installed package {package} with the executable {name} (looked in "
        f"{looked}). Build the package with colcon and source install/setup.sh first."
    )


def _described(prefix: Path, script: Path) -> Executable:
    modules = [folder for folder in prefix.glob("lib/python3*/site-packages") if folder.is_dir()]
    folders = [prefix]
    for folder in list(modules):
        for link in folder.glob("*.egg-link"):
            # Where `colcon build --symlink-install` left the modules in the build and source folders.
            target = Path(link.read_text(encoding="utf-8").splitlines()[0])
            modules.append(target)
            folders += [target, *(entry.resolve().parent for entry in target.iterdir() if entry.is_symlink())]
    return Executable(script, tuple(folders), os.pathsep.join(map(str, modules)))


class NoCell(Exception):
    """Raised when a notebook has no cell for the exercise; tells the student why."""


def cell_of(content: bytes, exercise: Exercise) -> str:
    """The code of the exercise's cell (of several cells the last), with its lines numbered as in the cell."""
    return cells_of(content, exercise)[-1]


def cells_of(content: bytes, exercise: Exercise) -> list[str]:
    """The code of every cell that is the exercise's, in their order; at least one. Lines of magic become empty ones.

    Those are cells whose metadata says `spinbook.exercise`; if there are none, those with `%%node` and the exercise's
    name, then those that define the exercise's class, then those that create its node. Raises `NoCell`.
    """
    try:
        cells = json.loads(content)["cells"]
        codes = [(_exercise(cell), _source(cell)) for cell in cells if cell.get("cell_type") == "code"]
    except (ValueError, TypeError, KeyError, AttributeError, RecursionError) as error:
        raise NoCell(f"It is not a valid notebook: {type(error).__name__}: {error}.") from None
    stem = exercise.file_name.removesuffix(".py")
    magic = re.compile(rf"^%%node\s+{re.escape(stem)}(\.py)?(\s.*)?$", re.MULTILINE)
    definition = re.compile(rf"^class\s+{re.escape(exercise.class_name)}\b", re.MULTILINE)
    node = re.compile(rf"""(Node|__init__|create_node)\(\s*['"]{re.escape(exercise.node_name)}['"]""")
    for found in (
        [code for name, code in codes if name == exercise.name],
        [code for _, code in codes if magic.search(code)],
        [code for _, code in codes if exercise.class_name and definition.search(code)],
        [code for _, code in codes if node.search(code)],
    ):
        if found:
            return [_storable(_without_magic(code)) for code in found]
    what = f"class {exercise.class_name}" if exercise.class_name else f"node {exercise.node_name}"
    raise NoCell(
        f"None of the notebook's {len(codes)} code cells is the exercise's. Write the {what} in the cell that the "
        f"chapter gives for it; it begins with %%node {stem}."
    )


def _exercise(cell: dict[str, Any]) -> str:
    spinbook = cell.get("metadata", {}).get("spinbook", {})
    name = spinbook.get("exercise", "") if isinstance(spinbook, dict) else ""
    return name if isinstance(name, str) else ""


def _source(cell: dict[str, Any]) -> str:
    source = cell.get("source", "")
    return source if isinstance(source, str) else "".join(source)


def _without_magic(code: str) -> str:
    return "\n".join("" if line.startswith(("%", "!")) else line for line in code.split("\n"))


def _storable(code: str) -> str:
    """Raise `NoCell` for half of a character, which JSON can hold and no file can."""
    try:
        code.encode()
    except UnicodeEncodeError as error:
        line = code.count("\n", 0, error.start) + 1
        found = f"Line {line} of the exercise's cell holds {code[error.start]!r}, half of a character."
        raise NoCell(f"{found} Delete it and type the character again.") from None
    return code


MOST_BYTES = {".py": 1_000_000, ".ipynb": 30_000_000, ".zip": 5_000_000}


class NoSubmission(Exception):
    """Raised when there is nothing to grade under the name that was given: a mistake in the command's usage."""


class _Unusable(Exception):
    pass


def read(given: str, exercise: Exercise) -> Submission:
    """The submission that `given` names: a file, or `package/executable` of an installed package.

    A file is a .py, a notebook, or the .zip that `spinbook submit` writes. Raises `NoSubmission` if there is none.
    """
    path = Path(given)
    if exercise.programs and path.is_dir():
        return of_source(given, joined(_folder(path)).encode(), exercise)
    if path.suffix not in MOST_BYTES and not os.path.lexists(path):
        if given.count("/") == 1:
            return _executable(given, exercise)
        raise NoSubmission(f"{given}: there is no such file. Give a .py, .ipynb or .zip file, or package/executable.")
    if path.suffix not in MOST_BYTES:
        raise NoSubmission(f"{given}: give a .py, .ipynb or .zip file, or package/executable of an installed package.")
    if not os.path.lexists(path):
        raise NoSubmission(f"{given}: there is no such file.")
    try:
        content = _content(path)
    except _Unusable as error:
        return Submission(given, _digest(str(error).encode()), exercise.file_name, "", None, str(error))
    if path.suffix == ".zip":
        return of_upload(given, content, exercise)
    if path.suffix == ".ipynb":
        try:
            code = cell_of(content, exercise).encode()
        except NoCell as error:
            return Submission(given, _digest(content), exercise.file_name, "", None, str(error))
    else:
        code = content
    return of_source(given, code, exercise, _digest(content))


def of_source(name: str, code: bytes, exercise: Exercise, digest: str = "") -> Submission:
    """A submission of this Python source. It runs under the exercise's file name, whatever it was called."""
    source = code.decode("utf-8", errors="replace")
    problem = not_python(code) if code.strip() else "Your file is empty."
    files = {exercise.file_name: code}
    if exercise.programs and not problem:
        files, problem = _several(source, exercise)
    program = None if problem else Program(next(iter(files)), files)
    return Submission(name, digest or _digest(code), exercise.file_name, source, program, problem)


def _several(source: str, exercise: Exercise) -> tuple[dict[str, bytes], str]:
    """The programs of an exercise with several, by their files, and what is wrong with them."""
    if files_in(source) > MOST_FILES:
        return {}, f"There are more than {MOST_FILES} files in it. Hand in at most {MOST_FILES}."
    files = {file: text.encode() for file, text in parts(source).items()}
    missing = [one.file for one in exercise.programs if one.file not in files]
    if missing:
        return files, f"There is no {missing[0]} in it. Begin its part of the file with a line: # file: {missing[0]}"
    return files, ""


def of_upload(name: str, content: bytes, exercise: Exercise) -> Submission:
    """The submission in an upload. `warning` says what in it does not match; it is graded anyway."""
    try:
        upload = unpack(content)
    except NoUpload as error:
        return Submission(name, _digest(content), exercise.file_name, "", None, str(error))
    faults = list(upload.faults)
    if upload.record and upload.record.get("exercise") != exercise.name:
        faults.append(f"it was handed in for the exercise {upload.record.get('exercise')!r}")
    text = "; ".join(faults)
    warning = f"Not as it was handed in: {text[:500]}." if text else ""
    code = next(_codes(upload, exercise), None)
    if code is None:
        problem = f"There is no code for {exercise.name} in it. Hand in the file that `spinbook submit` writes."
        return Submission(name, _digest(content), exercise.file_name, "", None, problem, warning)
    return replace(of_source(name, code, exercise, _digest(content)), warning=warning)


def _codes(upload: Upload, exercise: Exercise) -> Iterator[bytes]:
    """What in an upload may be the exercise's code, the likeliest first."""
    if exercise.file_name in upload.files:
        yield upload.files[exercise.file_name]
    if exercise.programs and all(one.file in upload.files for one in exercise.programs):
        yield joined({name: code for name, code in upload.files.items() if name.endswith(".py")}).encode()
    for name in sorted(upload.files):
        if name.endswith(".ipynb"):
            with contextlib.suppress(NoCell):
                yield cell_of(upload.files[name], exercise).encode()
    programs = [name for name in upload.files if name.endswith(".py")]
    if len(programs) == 1:
        yield upload.files[programs[0]]


def _folder(path: Path) -> dict[str, bytes]:
    """The Python files in a folder; of too many the first, which show that they are."""
    found = {}
    for file in sorted(path.glob("*.py"))[: MOST_FILES + 1]:
        with contextlib.suppress(_Unusable):
            found[file.name] = _content(file)
    return found


def _content(path: Path) -> bytes:
    """The content of a file itself, without following links."""
    most = MOST_BYTES[path.suffix]
    try:
        descriptor = os.open(path, os.O_RDONLY | os.O_NOFOLLOW | os.O_NONBLOCK | os.O_CLOEXEC)
    except OSError as error:
        if error.errno == errno.ELOOP:
            raise _Unusable("It is a symbolic link. Hand in the file itself.") from None
        raise _Unusable(f"It can't be read: {error.strerror}.") from None
    try:
        if not stat.S_ISREG(os.fstat(descriptor).st_mode):
            raise _Unusable("It is not a regular file. Hand in a file.")
        with os.fdopen(descriptor, "rb", closefd=False) as file:
            content = file.read(most + 1)
    finally:
        os.close(descriptor)
    if len(content) > most:
        raise _Unusable(f"It is larger than {most // 1_000_000} MB. Hand in your code only, with outputs cleared.")
    return content


def _executable(given: str, exercise: Exercise) -> Submission:
    found = find(given)
    if isinstance(found, str):
        raise NoSubmission(found)
    source = found.script.read_bytes()
    program = Program(
        str(found.script), environment={"PYTHONPATH": found.python_path}, readonly=found.folders, preloaded=False
    )
    return Submission(given, found.digest(), found.script.name, source.decode(errors="replace"), program)


def _digest(content: bytes) -> str:
    return hashlib.sha256(content).hexdigest()
