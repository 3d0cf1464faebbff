"""Searches a handout for secrets that students must not see, and lists the secrets of each exercise."""

from __future__ import annotations

import ast
import io
import json
import re
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace

from grader.exercise.exercise import Exercise
from grader.exercise.mistakes import EDITS, mistakes_of
from grader.exercise.starter import hidden_blocks, starter

#: A line with this many characters, without spaces, is no coincidence; neither are this many lines with this many.
_ONE_LINE = 40
_LINES, _CHARACTERS = 3, 40
#: Spinbook's own modules, in a wheel or in what a page loads.
_OWN = re.compile(r"\.(whl|zip)/(spinbook|grader|groundwork|interface_compiler|rcl_python|rmw_lockstep|ros_in_python)/")
#: Everybody's packages in what a page loads: rclpy and Jinja have lines and names that solutions and checks have, too.
_FROM_PYPI = re.compile(r"/run/\w+\.zip/(?!exercises/)")
#: How many characters of a secret are looked up before the whole of it is compared.
_PIECE = 8


@dataclass(frozen=True)
class Secret:
    """A piece of text that no student may see, without spaces, and what it is; `at` is its file and first line.

    `is_solution` says that Spinbook's own modules must not have it either. They may have the same `main` as a mistake,
    or the same line as a hidden check, because everybody has them.
    """

    what: str
    text: str
    at: str = ""
    is_solution: bool = False


#: A line's number, and the line without spaces.
NumberedLine = tuple[int, str]


def secrets(exercise: Exercise, taught: str, others: str = "") -> list[Secret]:
    """Return what is secret of this exercise: solutions, hidden checks, and the scenarios of nodes, with their files.

    `taught` is code that students have from the chapters; a line of it is not secret, wherever else it appears. Nor is
    a line of the starter, or of the public checks. `others` is what students get of the course's other exercises, see
    `public_code`: what appears there, too, reveals nothing about this one.
    """
    public = exercise.folder / "checks.py"
    public_text = taught + others + (public.read_text(encoding="utf-8") if public.exists() else "")
    secret = []
    elsewhere = bare(others)
    if exercise.solution_file:
        source = exercise.solution_file.read_text(encoding="utf-8")
        public_text += starter(source)
        title = f"a part of the solution of {exercise.name}"
        place = f"solutions/{exercise.name}/solution.py"
        known = bare(public_text)
        for lines in _solved(source):
            secret += _pieces(title, place, lines, known)
            windows = [part for part in _windows(title, place, lines) if part.text not in elsewhere]
            secret += [replace(part, is_solution=True) for part in windows]
    known = bare(public_text)
    secret += [part for part in _other_programs(exercise) if part.text not in known]
    for file in sorted(exercise.folder.glob("*.py")):
        if file != public:
            title, place = f"a line of {file.name} of {exercise.name}", f"exercises/{exercise.name}/{file.name}"
            secret += _pieces(title, place, _lines(file.read_text(encoding="utf-8")), known)
    return secret + [part for part in _hidden_titles(exercise) if part.text not in elsewhere]


def hidden_names(exercise: Exercise, others: str = "") -> list[Secret]:
    """Return the names of hidden checks, without those that public checks of `others` have, too.

    Spinbook's own files may have a check of that name in an example.
    """
    checks = _hidden_checks(exercise)
    return [Secret(_named(entry, exercise), entry.name) for entry in checks if f"def {entry.name}(" not in others]


def secrets_of_all(exercises: Sequence[Exercise], taught: str) -> tuple[list[Secret], list[Secret]]:
    """Return what is secret of a course's exercises, and the names of their hidden checks.

    Raises ExerciseError if the mistakes of one can't be read.
    """
    texts, names = [], []
    for exercise in exercises:
        others = "\n".join(public_code(other) for other in exercises if other is not exercise)
        texts += secrets(exercise, taught, others)
        names += hidden_names(exercise, others)
    return texts, names


def public_code(exercise: Exercise) -> str:
    """Return the code that students get of an exercise: its starter and its public checks."""
    public = exercise.folder / "checks.py"
    checks = public.read_text(encoding="utf-8") if public.exists() else ""
    return checks + (starter(exercise.solution_file.read_text(encoding="utf-8")) if exercise.solution_file else "")


def authors_code(files: Mapping[str, bytes]) -> str:
    """Return the author's code that public checks and scenarios need, and so is in the students' copies of exercises.

    `files` are those copies by their paths, such as `exercises/tank/public.json`.
    """
    modules = [content.decode() for name, content in files.items() if name.endswith(".py")]
    companions = [text for name in files if name.endswith("/public.json") for text in _companions_of(files[name])]
    return "\n".join(modules + companions)


def _companions_of(public: bytes) -> Iterator[str]:
    for scenario in json.loads(public)["scenarios"]:
        for companion in scenario.get("companions", ()):
            yield from (companion["text"], *companion["modules"].values())


def bare(text: str) -> str:
    """Return a text without spaces and line ends."""
    return "".join(text.split())


def _pieces(title: str, place: str, lines: list[NumberedLine], known: str) -> list[Secret]:
    long = [(number, line) for number, line in lines if len(line) >= _ONE_LINE]
    return [Secret(title, line, f"{place}:{number}") for number, line in long if line not in known]


def _windows(title: str, place: str, lines: list[NumberedLine]) -> list[Secret]:
    windows = [lines[i : i + _LINES] for i in range(max(1, len(lines) - _LINES + 1)) if lines]
    texts = [("".join(line for _, line in window), window[0][0]) for window in windows]
    return [Secret(title, text, f"{place}:{number}") for text, number in texts if len(text) >= _CHARACTERS]


def _solved(source: str) -> Iterator[list[NumberedLine]]:
    """Yield the lines of each block between markers, without spaces."""
    for block in hidden_blocks(source):
        yield [(number, bare(line)) for number, line in block if line.strip()]


def _lines(text: str) -> list[NumberedLine]:
    """Return the lines of a file's text that contain more than an import, without spaces."""
    lines = enumerate(text.splitlines(), start=1)
    return [
        (number, bare(line)) for number, line in lines if line.strip() and not line.startswith(("import ", "from "))
    ]


def _other_programs(exercise: Exercise) -> Iterator[Secret]:
    """Yield the parts of the other solutions and of the mistakes, and the parts of mistakes.md as it is."""
    if not (exercise.solution_folder and exercise.solution_file):
        return
    edits = exercise.solution_folder / EDITS
    files = [*sorted(exercise.solution_folder.rglob("*.py")), *([edits] if edits.exists() else [])]
    for file in files:
        if file != exercise.solution_file:
            place = f"solutions/{exercise.name}/{file.relative_to(exercise.solution_folder).as_posix()}"
            yield from _windows(f"a part of {place}", place, _lines(file.read_text(encoding="utf-8")))
    solution = "".join(line for _, line in _lines(exercise.solution_file.read_text(encoding="utf-8")))
    place = f"solutions/{exercise.name}/{EDITS}"
    for mistake in (mistake for mistake in mistakes_of(exercise) if mistake.file == edits):
        windows = _windows(f"a part of {place}", place, [(mistake.line, line) for _, line in _lines(mistake.source)])
        yield from (secret for secret in windows if secret.text not in solution)


def _hidden_titles(exercise: Exercise) -> Iterator[Secret]:
    for entry in _hidden_checks(exercise):
        at = f"exercises/{exercise.name}/hidden_checks.py:{entry.lineno}"
        yield Secret(_named(entry, exercise), f"def{entry.name}(", at)
        if title := ast.get_docstring(entry):
            yield Secret(_named(entry, exercise), bare(title), at)


def _named(check: ast.FunctionDef, exercise: Exercise) -> str:
    return f"the hidden check {check.name} of {exercise.name}"


def _hidden_checks(exercise: Exercise) -> Iterator[ast.FunctionDef]:
    file = exercise.folder / "hidden_checks.py"
    if file.exists():
        for entry in ast.parse(file.read_text(encoding="utf-8")).body:
            if isinstance(entry, ast.FunctionDef) and entry.name.startswith("test"):
                yield entry


@dataclass(frozen=True)
class Leak:
    """A secret in a file of a handout. `at` says where in the course's files it is, and `line` in the file itself.

    `line` is None, and `at` empty, if that is unknown.
    """

    file: str
    what: str
    line: int | None
    at: str


def leaks(files: Mapping[str, bytes], known: list[Secret]) -> Iterator[tuple[str, str]]:
    """Yield (file, what it is) for each file and each secret in it: see `located`."""
    return ((leak.file, leak.what) for leak in located(files, known))


def located(files: Mapping[str, bytes], known: list[Secret]) -> Iterator[Leak]:
    """Find each secret in each file, once. Searches notebooks, wheels and zips, too.

    All of a notebook is searched: cells, outputs, attachments, and metadata of the whole and of each cell.
    """
    return _located(files, _Search(known))


class _Search:
    """Finds secrets in a text in one pass, however many there are.

    Wherever a secret is, one of the pieces of `_PIECE` characters that begin at its first n characters begins at a
    multiple of n. So the text's pieces at multiples of n are looked up, and the secrets that have one there compared.
    n is as large as the shortest secret allows.
    """

    def __init__(self, known: Sequence[Secret]) -> None:
        self._known = known
        self._short = [number for number, secret in enumerate(known) if len(secret.text) < 2 * _PIECE]
        long = [(number, secret.text) for number, secret in enumerate(known) if len(secret.text) >= 2 * _PIECE]
        self._step = min((len(text) for _, text in long), default=2 * _PIECE) - _PIECE + 1
        self._having: dict[str, list[tuple[int, int]]] = {}
        for number, text in long:
            for at in range(self._step):
                self._having.setdefault(text[at : at + _PIECE], []).append((number, at))

    def found_in(self, text: str) -> list[Secret]:
        """Return the secrets that are in the text, in their order."""
        found = {number for number in self._short if self._known[number].text in text}
        having = self._having
        for start in [at for at in range(0, len(text), self._step) if text[at : at + _PIECE] in having]:
            for number, at in having[text[start : start + _PIECE]]:
                if start >= at and text.startswith(self._known[number].text, start - at):
                    found.add(number)
        return [self._known[number] for number in sorted(found)]


def _located(files: Mapping[str, bytes], search: _Search) -> Iterator[Leak]:
    for name, content in files.items():
        first: dict[str, Secret] = {}
        own = _OWN.search(name)
        if _FROM_PYPI.search(name) and not own:
            continue
        found = search.found_in(bare(f"{name}\n{_readable(name, content)}"))
        for secret in (secret for secret in found if secret.is_solution or not own):
            first.setdefault(secret.what, secret)
        for secret in first.values():
            yield _leak(name, content, secret)
        if name.endswith((".whl", ".zip")):
            with zipfile.ZipFile(io.BytesIO(content)) as archive:
                inner = {f"{name}/{entry}": archive.read(entry) for entry in archive.namelist()}
            yield from _located(inner, search)


def _leak(name: str, content: bytes, secret: Secret) -> Leak:
    if name.endswith(".ipynb"):
        chapter = _chapter_line(content, secret)
        return Leak(name, secret.what, None, ", ".join(filter(None, (chapter, _same(secret)))))
    return Leak(name, secret.what, _line_in(content.decode("utf-8", errors="replace"), secret), _same(secret))


def _same(secret: Secret) -> str:
    return f"the same as {secret.at}" if secret.at else ""


def _line_in(text: str, secret: Secret) -> int | None:
    """Return the line in which a secret begins."""
    start = bare(text).find(secret.text)
    for number, line in enumerate(text.split("\n") if start >= 0 else (), start=1):
        start -= len(bare(line))
        if start < 0:
            return number
    return None


def _chapter_line(content: bytes, secret: Secret) -> str:
    """Return the chapter and line from which a notebook has the secret, according to the notebook's metadata."""
    try:
        notebook = json.loads(content)
        chapter = notebook["metadata"]["spinbook"]["chapter"]
        for cell in notebook["cells"]:
            line = _line_in("".join(cell["source"]), secret)
            if line is not None:
                return f"{chapter}:{cell['metadata']['spinbook']['line'] + line - 1}"
    except (ValueError, KeyError, TypeError):
        pass
    return ""


def _readable(name: str, content: bytes) -> str:
    """Return a file's text; for a notebook its texts, one after another, as they are shown."""
    text = content.decode("utf-8", errors="replace")
    if name.endswith((".ipynb", ".json")):
        try:
            return "\n".join(_texts(json.loads(text)))
        except ValueError:
            pass
    return text


def _texts(value: object) -> Iterator[str]:
    if isinstance(value, str):
        yield value
    elif isinstance(value, list):
        for item in value:
            yield from _texts(item)
    elif isinstance(value, dict):
        for key, item in value.items():
            yield str(key)
            yield from _texts(item)
