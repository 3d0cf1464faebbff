"""Chooses the program that a student means among the files of a folder or an archive, or says that it is ambiguous."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property

from grader.exercise.exercise import Exercise, ProgramFile
from grader.submission import packages, python_code
from grader.submission.archive import Contents
from grader.submission.entry_points import EntryPoint, entry_points
from grader.submission.file_kinds import NOT_UNPACKED, OTHER_ARCHIVES, kind_of, language_of, not_graded, original_name
from grader.submission.launch_files import launch_settings, launched
from grader.submission.notebook import Notebook, read_notebook
from grader.submission.problems import AmbiguousProgram, Unreadable
from grader.submission.program_choice import Choice, choose, digest_of, is_program
from grader.submission.unreadable import text_of


@dataclass(frozen=True)
class FileOption:
    """One program that the student may mean: where it is from, its text, and how it is run."""

    title: str
    source: str
    file: str = ""
    function: str = ""
    choice: Choice | None = None
    why: str = ""


@dataclass
class ReadState:
    """The state of reading the files of one submission."""

    contents: Contents
    exercise: Exercise
    called: str = ""
    notebooks: dict[str, Notebook] = field(default_factory=dict)
    problems: list[str] = field(default_factory=list)
    questions: list[str] = field(default_factory=list)

    @property
    def files(self) -> Mapping[str, bytes]:
        """The files by path."""
        return self.contents.files

    @cached_property
    def entries(self) -> list[EntryPoint]:
        """The executables that the packages install."""
        return entry_points(self.files)


def targets(exercise: Exercise) -> tuple[ProgramFile, ...]:
    """Return the programs that a submission must have."""
    return exercise.programs or (ProgramFile(exercise.file_name, exercise.node_name, exercise.class_name),)


def chosen(reading: ReadState, target: ProgramFile, handed_out: frozenset[str]) -> FileOption:
    """Return the program `target` among the files, by the first rule that any file satisfies."""
    options = [_of_python(name, reading) for name in packages.programs(reading.files)]
    begun = [one for one in options if not python_code.is_empty(one.source) and digest_of(one.source) not in handed_out]
    options = begun or options
    named = [one for one in options if _is_called(one.file, target.file)] + _of_notebooks(reading, target, handed_out)
    its_own = [one for one in options if is_program(one.source, target)]
    if not (named or its_own) and reading.questions:
        raise AmbiguousProgram(reading.questions[0])
    only_program = [] if reading.exercise.programs else _by_content(options, _language(reading))
    lost = [name for name in reading.contents.damaged if kind_of(name) in ("python", "notebook", "archive")]
    if its_own and not named and any(_is_called(name, target.file) for name in lost):
        raise AmbiguousProgram(
            f"{target.file} in it can't be read, and {its_own[0].title} may be an older version of it."
        )
    for tier in (named, its_own, *([] if lost else [_by_executable(reading, options, target), *only_program])):
        if tier:
            option = _decided(tier, reading, target)
            return option if reading.exercise.programs else _starting(option, options)
    raise Unreadable(_nothing(reading, target))


def _starting(option: FileOption, options: Sequence[FileOption]) -> FileOption:
    """Return the program that starts what `option` only defines, if a single other one imports it and starts."""
    if option.choice or option.function or python_code.starts(option.source):
        return option
    if "main" in python_code.definitions(option.source):
        return option
    module = option.file.rpartition("/")[2].removesuffix(".py")
    users = [
        one
        for one in options
        if python_code.starts(one.source)
        and any(module in name.split(".") for name in python_code.imported(one.source, relative=True))
    ]
    return replace(users[0], why=f"it starts what {option.file} defines") if len(users) == 1 else option


def _by_content(options: list[FileOption], language: str) -> list[list[FileOption]]:
    """Return what an exercise with a single program takes for it: executables, what uses rclpy, or any Python.

    Next to a program in another language, a script without rclpy is not the program.
    """
    tiers = [[one for one in options if one.function], [one for one in options if "rclpy" in one.source]]
    return tiers if language else [*tiers, options]


def _language(reading: ReadState) -> str:
    """Return the language of files that are not Python; C++ goes before C, which its headers look like."""
    languages = {language_of(name) for name in reading.files if kind_of(name) == "other language"}
    return "C++" if "C++" in languages else min(languages, default="")


def _of_python(name: str, reading: ReadState) -> FileOption:
    source = text_of(reading.files[name])
    entries = [entry for entry in reading.entries if entry.file == name]
    title = f"{name}, the executable {entries[0].name}" if entries else name
    return FileOption(title, source, name, entries[0].function if entries else "")


def _of_notebooks(reading: ReadState, target: ProgramFile, handed_out: frozenset[str]) -> list[FileOption]:
    found = []
    for name in sorted(reading.files):
        if kind_of(name) != "notebook":
            continue
        try:
            notebook = reading.notebooks.setdefault(name, read_notebook(reading.files[name]))
            choice = choose(notebook, reading.exercise, target, handed_out)
        except Unreadable as error:
            reading.problems.append(f"{name}: {error}")
        except AmbiguousProgram as error:
            reading.questions.append(f"{name}: {error}")
        else:
            found.append(FileOption(name, choice.code, name, choice=choice))
    begun = [one for one in found if digest_of(one.source) not in handed_out]
    return begun or found


def _is_called(path: str, file: str) -> bool:
    return original_name(path).lower() == file


def _by_executable(reading: ReadState, options: Sequence[FileOption], target: ProgramFile) -> list[FileOption]:
    """Return the programs that are installed under the exercise's name or launched as its node."""
    stem = target.file.removesuffix(".py")
    names = {stem, target.node} | {one.executable for one in launched(reading.files) if one.name in (stem, target.node)}
    entries = [entry for entry in reading.entries if entry.name.removesuffix(".py") in names]
    return [one for one in options if any(entry.file == one.file for entry in entries)]


def _decided(options: Sequence[FileOption], reading: ReadState, target: ProgramFile) -> FileOption:
    checked = {
        digest
        for notebook in reading.notebooks.values()
        for cell in notebook.cells
        for name, digest in (cell.checked or {}).items()
        if name == reading.exercise.name and digest
    }
    nodes = launched(reading.files)
    entries = [entry for entry in reading.entries if any(node.starts(entry) for node in nodes)]
    rules: tuple[tuple[str, Callable[[FileOption], bool]], ...] = (
        ("", lambda one: True),
        ("it is the one that %check judged", lambda one: digest_of(one.source) in checked),
        (f"it is called {target.file}", lambda one: one.choice is not None or _is_called(one.file, target.file)),
        (f"only it has the program {target.node}", lambda one: is_program(one.source, target)),
        ("it is installed as an executable", lambda one: bool(one.function)),
        ("a launch file starts it", lambda one: any(entry.file == one.file for entry in entries)),
    )
    for why, fits in rules:
        options = [one for one in options if fits(one)] or options
        if len({python_code.normalized(one.source) for one in options}) == 1:
            first = min(options, key=lambda one: (one.choice is not None, one.file.count("/"), one.file))
            return replace(first, why=why)
    titles = ", ".join(one.title for one in options[:5])
    raise AmbiguousProgram(
        f"{len(options)} programs in it can be {target.file}, and they differ: {titles}. Which one counts? Hand in "
        "only that one."
    )


def notes_on(option: FileOption, reading: ReadState) -> tuple[str, ...]:
    """Return notes on the choice; none if there was only one program. Raises `AmbiguousProgram`."""
    notes = _notes_on_interfaces(option, reading)
    others = [name for name in packages.programs(reading.files) if name != option.file]
    notebooks = [name for name in reading.files if kind_of(name) == "notebook" and name != option.file]
    called = any(_is_called(option.file, one.file) for one in targets(reading.exercise))
    rivals = [] if reading.exercise.programs else [name for name in others if _is_rival(name, option, reading)]
    if notebooks or rivals or ((others or option.function) and not called):
        why = option.why or (f"it is called {reading.exercise.file_name}" if rivals and called else "")
        notes.append(f"Taken: {option.title}{why and ', because '}{why}.")
    if settings := launch_settings(reading.files, option.file):
        found = ", ".join(settings)
        notes.append(
            f"Not applied from your launch file: {found}. The grader starts the program as `ros2 run` does, without a "
            "launch file: the names and values that the task gives belong into the program."
        )
    return tuple(notes)


def _is_rival(name: str, option: FileOption, reading: ReadState) -> bool:
    source = reading.files[name].decode("utf-8", errors="replace")
    same = python_code.normalized(source) == python_code.normalized(option.source)
    return not same and any(is_program(source, target) for target in targets(reading.exercise))


def _notes_on_interfaces(option: FileOption, reading: ReadState) -> list[str]:
    """Return a note if a program imports messages that it defines and the course has, too.

    Raises `AmbiguousProgram` if the course does not have them. It is for the instructor to decide, as the definitions
    would be compiled outside of any sandbox: comments of a definition get into the code that gcc reads, and gcc can be
    told to copy any file into the result.
    """
    used = packages.packages_of_messages(option.source, reading.files)
    both = sorted(packages.own_interfaces(reading.files) & used)
    for package in [one for one in both if not packages.is_installed(one)]:
        raise AmbiguousProgram(
            f"The program imports {package}, a package of messages that was handed in with it, and the grader does not "
            "build it. Use the types that the task names. To the instructor: to grade it as it is, put its definitions "
            f"into the course's folder interfaces/{package}/, after you have read them."
        )
    return [f"The course's {package} is used, not the one that was handed in." for package in both]


def _nothing(reading: ReadState, target: ProgramFile) -> str:
    if reading.problems:
        return reading.problems[0]
    if language := _language(reading):
        return not_graded(language)
    if packed := [name for name, data in reading.files.items() if data.startswith(OTHER_ARCHIVES)]:
        return f"{packed[0]} in it is {NOT_UNPACKED}. Hand in your code itself, or a .zip file."
    if "[Content_Types].xml" in reading.files or reading.files.get("mimetype", b"").startswith(
        b"application/vnd.oasis"
    ):
        return "It is a document of an office program. Hand in your code as a .py file or a notebook."
    if lost := [*reading.contents.links, *reading.contents.damaged]:
        why = "is a symbolic link" if reading.contents.links else "can't be read (is it damaged, or has it a password?)"
        return (
            f"{lost[0]} in it {why}, and there is no other code for {reading.exercise.name}. Hand in the file itself."
        )
    if reading.exercise.programs:
        there = ", ".join(packages.programs(reading.files)[:5]) or "none"
        return f"There is no {target.file} in it, and no program of the node {target.node}. Python files: {there}."
    there = f" It holds: {', '.join(sorted(reading.files)[:5])}." if reading.files else ""
    return f"There is no code for {reading.exercise.name} in it.{there} Hand in the file that `spinbook submit` writes."
