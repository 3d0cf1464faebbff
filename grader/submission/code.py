"""Turns the bytes that were handed in into the program that runs, in the same way for every command.

`%check`, `spinbook check`, `submit`, the page and `grade` all read with it. It needs no disk, sandbox or ROS, so it
also runs in a web page. Nothing of a submission is run or imported.
"""

from __future__ import annotations

import json
import posixpath
import re
from collections.abc import Mapping
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from grader.exercise.exercise import Exercise
from grader.exercise.starter import MarkerError, starter
from grader.recording.places import is_launcher
from grader.submission import packages, python_code
from grader.submission.archive import Contents, unpacked
from grader.submission.entry_points import is_below
from grader.submission.file_choice import FileOption, ReadState, chosen, notes_on, targets
from grader.submission.file_kinds import (
    NEITHER,
    NOT_UNPACKED,
    OTHER_ARCHIVES,
    kind_of,
    kind_of_content,
    language_of,
    named_by_content,
    not_graded,
)
from grader.submission.launch_program import MAIN, launch_file_in, launch_file_name, program_files
from grader.submission.magics import cell_magic, without_commands
from grader.submission.notebook import Notebook, NotebookCell, read_notebook
from grader.submission.problems import AmbiguousProgram, Unreadable, merge_conflict
from grader.submission.program_choice import choose, digest_of
from grader.submission.python_version import newer_syntax
from grader.submission.several_files import MOST_FILES, files_in, joined, parts
from grader.submission.unreadable import not_python, other_kind, text_of

#: The starter's file in a web page's copy of an exercise.
STARTER = "starter.py"

NO_CPP = not_graded("C++")

_INCLUDES = re.compile(rb"^[ \t]*#[ \t]*include[ \t]*[<\"]", re.MULTILINE)
_A_CELL = (
    "Your file has lines that only a notebook understands, such as %%node, ! or >>>, or Markdown's ```. They were left "
    "out; Python itself can't run the file."
)


@dataclass(frozen=True)
class Code:
    """A program as it runs: `files` by their paths, of which `main` is started.

    `source` is the text of the program itself, `notes` say which program was chosen and why, and `python` is the
    version that the student's notebook or record names, or "".
    """

    files: Mapping[str, bytes]
    main: str
    source: str
    notes: tuple[str, ...] = ()
    python: str = ""


def as_text(code: Code) -> str:
    """Return a program as JSON, for another process."""
    files = {name: content.decode("latin-1") for name, content in code.files.items()}
    return json.dumps({**asdict(replace(code, files={})), "files": files})


def from_text(text: str) -> Code:
    """Return the program that `as_text` wrote."""
    fields = json.loads(text)
    files = {name: content.encode("latin-1") for name, content in fields["files"].items()}
    return Code(**{**fields, "files": files, "notes": tuple(fields["notes"])})


def code_of(name: str, content: bytes, exercise: Exercise) -> Code:
    """Return the program in a file with this name and content. Raises `Unreadable` and `AmbiguousProgram`."""
    kind = kind_of_content(content, kind_of(name))
    if kind == "other language":
        raise Unreadable(not_graded(language_of(name)))
    if kind == "archive":
        return code_of_files(unpacked(content), exercise)
    if kind == "notebook":
        return code_of_notebook(read_notebook(content), exercise, posixpath.basename(name))
    if kind == "python":
        return code_of_python(content, exercise)
    if kind == "launch file" and exercise.nodes:
        return _launched({launch_file_name(name, content, exercise): content}, exercise, text_of(content))
    reason = NOT_UNPACKED if content.startswith(OTHER_ARCHIVES) else NEITHER
    raise Unreadable(other_kind(content) or f"Your file is {reason}. Hand in a .py, .ipynb or .zip file.")


def code_of_python(content: bytes, exercise: Exercise) -> Code:
    """Return the program in one Python file, which runs under the exercise's file name. Raises `Unreadable`."""
    if problem := not_python(content) if content.strip() else "Your file is empty.":
        raise Unreadable(problem)
    source = text_of(content)
    _refuse_conflict(content, "your file")
    notes = newer_syntax(source)
    if not notes and python_code.tree_of(source) is None:
        if _INCLUDES.search(content):
            raise Unreadable(NO_CPP)
        if code := _as_a_cell(source):
            source, content, notes = code, code.encode(errors="replace"), (_A_CELL,)
    if exercise.nodes:
        return _launched({exercise.file_name: content, **_encoded(parts(source))}, exercise, source, notes)
    if exercise.programs:
        files = _parts(source, exercise)
        return Code(files, next(iter(files)), source, notes)
    return Code({exercise.file_name: content}, exercise.file_name, source, notes)


def _as_a_cell(source: str) -> str:
    """Return the Python code of a file into which a notebook's cell was copied with its commands; otherwise ""."""
    code = without_commands(cell_magic(_fenced(source)).code)
    return code if code.strip() and python_code.tree_of(code) else ""


def _fenced(source: str) -> str:
    """Return the only block of code between Markdown's fences, in its lines; otherwise the text unchanged."""
    lines = source.split("\n")
    fences = [number for number, line in enumerate(lines) if line.lstrip().startswith("```")]
    if len(fences) != 2:
        return source
    return "\n".join(line if fences[0] < number < fences[1] else "" for number, line in enumerate(lines))


def _refuse_conflict(content: bytes, where: str) -> None:
    """Raise `Unreadable` for the markers of a merge conflict, unless they are in a string."""
    if (line := merge_conflict(content)) and python_code.tree_of(content.decode("utf-8", errors="replace")) is None:
        raise Unreadable(
            f"Line {line} of {where} is a mark of a merge conflict from git. Choose one of the two versions there, and "
            "delete the marks (<<<<<<<, =======, >>>>>>>)."
        )


def _parts(source: str, exercise: Exercise) -> dict[str, bytes]:
    if files_in(source) > MOST_FILES:
        raise Unreadable(f"There are more than {MOST_FILES} files in it. Hand in at most {MOST_FILES}.")
    files = _encoded(parts(source))
    if absent := [one.file for one in exercise.programs if one.file not in files]:
        raise Unreadable(f"There is no {absent[0]} in it. Begin its part of the file with a line: # file: {absent[0]}")
    return files


def _encoded(texts: Mapping[str, str]) -> dict[str, bytes]:
    return {file: text.encode() for file, text in texts.items()}


def _launched(files: Mapping[str, bytes], exercise: Exercise, source: str, notes: tuple[str, ...] = ()) -> Code:
    file = launch_file_in(files, exercise)
    return Code(program_files(file, files, exercise), MAIN, source or files[file].decode(errors="replace"), notes)


def code_of_notebook(notebook: Notebook, exercise: Exercise, name: str = "") -> Code:
    """Return the program in a notebook. Raises `Unreadable` and `AmbiguousProgram`."""
    handed_out = starters(exercise)
    if exercise.nodes:
        choice = choose(notebook, exercise, targets(exercise)[0], handed_out)
        return replace(code_of_python(_storable(choice.code), exercise), notes=choice.notes, python=notebook.python)
    if exercise.programs and (one := _one_cell(notebook, exercise)):
        return replace(code_of_python(_storable(one), exercise), source=one, python=notebook.python)
    choices = {one.file: choose(notebook, exercise, one, handed_out) for one in targets(exercise)}
    files = {file: _storable(choice.code) for file, choice in choices.items()}
    problem = next(filter(None, map(not_python, files.values())), "")
    if problem:
        raise Unreadable(problem)
    for content in files.values():
        _refuse_conflict(content, "the exercise's cell")
    main = next(iter(files))
    notes = [*filter(None, [notebook.note]), *(note for choice in choices.values() for note in choice.notes)]
    if name.removesuffix(".ipynb").endswith("-checkpoint"):
        notes.insert(0, f"{name} is a copy that Jupyter makes by itself; your notebook may be newer.")
    for text in list(files.values()):
        notes += newer_syntax(text.decode())
    files |= _modules(files, notebook)
    source = choices[main].code if len(choices) == 1 else joined(files)
    return Code(files, main, source, tuple(notes), notebook.python)


def _one_cell(notebook: Notebook, exercise: Exercise) -> str:
    """Return a cell that holds all programs of an exercise with several."""
    names = {one.file for one in exercise.programs}
    for cell in reversed(notebook.cells):
        if cell.is_python and names <= parts(cell.code).keys():
            return cell.code
    return ""


def uses_other_files(code: Code) -> bool:
    """Return whether a program needs other files than the one with its text: it imports them, or there are several."""
    if len(code.files.keys() - {MAIN}) == 1:
        return False
    own = {path.partition("/")[0].removesuffix(".py") for path in code.files}
    return any(module.partition(".")[0] in own for module in python_code.imported(code.source)) or (
        re.search(r"^[ \t]*from[ \t]+\.", code.source, re.MULTILINE) is not None or "# file: " in code.source
    )


def _storable(code: str) -> bytes:
    """Encode a program; raise `Unreadable` for a lone surrogate, which JSON can contain, but no file."""
    try:
        return code.encode()
    except UnicodeEncodeError as error:
        line = code.count("\n", 0, error.start) + 1
        text = f"Line {line} of the exercise's cell contains {code[error.start]!r}, half of a character."
        raise Unreadable(f"{text} Delete it and type the character again.") from None


def _modules(files: Mapping[str, bytes], notebook: Notebook) -> dict[str, bytes]:
    """Return the modules in other cells that a program imports, next to it or from the notebook's package."""
    package = next((name for cell in notebook.cells for name in _package(cell)), "notebook_nodes")
    cells = {cell.name: cell for cell in notebook.cells if cell.name and cell.magic.name != "part"}
    found: dict[str, bytes] = {}
    todo = [code.decode(errors="replace") for code in files.values()]
    while todo:
        for module in python_code.imported(todo.pop()):
            name = module.removeprefix(f"{package}.").partition(".")[0]
            path = f"{package}/{name}.py" if module.startswith(f"{package}.") else f"{name}.py"
            if name in cells and path not in {**files, **found}:
                text = files.get(f"{name}.py") or cells[name].code.encode(errors="replace")
                found[path] = text
                todo.append(text.decode(errors="replace"))
    return found


def _package(cell: NotebookCell) -> list[str]:
    words = next((line.split() for line in cell.source.split("\n") if line.startswith("%chapter")), [])
    return words[words.index("--package") + 1 : words.index("--package") + 2] if "--package" in words else []


def code_of_files(contents: Contents, exercise: Exercise, called: str = "") -> Code:
    """Return the program in a folder or an archive; `called` is the folder's name. Raises as `code_of`."""
    contents = replace(contents, files=named_by_content(contents.files))
    if exercise.nodes and "notebook" not in map(kind_of, contents.files):
        return _launched(contents.files, exercise, "")
    reading = ReadState(contents, exercise, called)
    handed_out = starters(exercise)
    options = {one.file: chosen(reading, one, handed_out) for one in targets(exercise)}
    if not exercise.programs:
        return _of_one(next(iter(options.values())), reading)
    if len({option.file for option in options.values()}) == 1 and not any(one.choice for one in options.values()):
        return code_of_python(contents.files[next(iter(options.values())).file], exercise)
    files: dict[str, bytes] = {}
    for file, option in options.items():
        theirs = _files_of(option, reading, file)
        if both := [name for name in theirs if name.endswith(".py") and files.get(name, theirs[name]) != theirs[name]]:
            raise AmbiguousProgram(
                f"{both[0]} is there in several versions, for {file} and for another program. Put each program with "
                "its modules into a package of its own, a folder with an __init__.py."
            )
        files |= theirs
    notes = tuple(dict.fromkeys(note for option in options.values() for note in notes_on(option, reading)))
    shown = {file: files[file] for file in options} | files
    return Code(files, next(iter(options)), joined({k: v for k, v in shown.items() if k.endswith(".py")}), notes)


def _of_one(option: FileOption, reading: ReadState) -> Code:
    exercise = reading.exercise
    notes = notes_on(option, reading)
    if option.choice:
        code = code_of_notebook(reading.notebooks[option.file], exercise, posixpath.basename(option.file))
        files = {**_beside(code.source, posixpath.dirname(option.file), reading.files), **code.files}
        return replace(code, files=files, notes=(*notes, *code.notes))
    files = _files_of(option, reading, exercise.file_name)
    main = exercise.file_name
    if not is_launcher(text_of(files.get(main, b""))):
        main = packages.layout_of(option.file, reading.files, reading.called).main
    if len(files) == 1:
        return replace(code_of_python(files[main], exercise), notes=(*notes, *newer_syntax(option.source)))
    if problem := not_python(reading.files[option.file]) if option.source.strip() else "Your file is empty.":
        raise Unreadable(problem)
    return Code(files, main, option.source, (*notes, *newer_syntax(option.source)))


def _files_of(option: FileOption, reading: ReadState, file: str) -> dict[str, bytes]:
    """Return a program's files. A small file called `file` starts a program that is in a package."""
    if option.choice:
        return {file: option.choice.code.encode(errors="replace")}
    layout = packages.layout_of(option.file, reading.files, reading.called)
    function = option.function
    if not function and not python_code.starts(option.source) and "main" in python_code.definitions(option.source):
        function = "main"
    files = dict(layout.files)
    if layout.module or (function and not python_code.starts(option.source)):
        files[file] = packages.launcher(layout.module or layout.main.removesuffix(".py"), function)
    elif reading.exercise.programs and layout.main != file:
        files[file] = packages.launcher(layout.main.removesuffix(".py"), "")
    return files


def _beside(source: str, folder: str, files: Mapping[str, bytes]) -> dict[str, bytes]:
    """Return the modules and packages in a notebook's folder that its program imports, directly or not."""
    here = {posixpath.relpath(name, folder or "."): data for name, data in files.items() if is_below(name, folder)}
    found: dict[str, bytes] = {}
    todo = [source]
    while todo:
        tops = {module.partition(".")[0] for module in python_code.imported(todo.pop())}
        for name, data in here.items():
            if name.endswith(".py") and name not in found and name.partition("/")[0].removesuffix(".py") in tops:
                found[name] = data
                todo.append(text_of(data))
    return found


def starters(exercise: Exercise) -> frozenset[str]:
    """Return the digests of the starter as it was handed out, if known."""
    course = exercise.folder.parent.parent
    handed_out = course / ".spinbook" / "base" / "exercises" / exercise.name / exercise.file_name
    texts = []
    with suppress(OSError, ValueError, MarkerError):
        if exercise.solution_file:
            texts.append(starter(exercise.solution_file.read_text(encoding="utf-8")))
    for file in (handed_out, exercise.folder / STARTER):
        with suppress(OSError, ValueError):
            texts.append(Path(file).read_text(encoding="utf-8"))
    return frozenset(map(digest_of, texts))
