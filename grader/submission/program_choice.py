"""Chooses the program that a student means among a notebook's cells, or says that it is ambiguous."""

from __future__ import annotations

import hashlib
import re
from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass

from grader.exercise.exercise import Exercise, ProgramFile
from grader.recording.places import without_marks
from grader.submission import python_code
from grader.submission.assembled_program import AssembledProgram, assemble, is_complete, joined
from grader.submission.file_kinds import not_graded
from grader.submission.notebook import Notebook, NotebookCell
from grader.submission.problems import AmbiguousProgram, Unreadable
from groundwork.words import similar

#: No person writes more versions of a program into a notebook; comparing them takes time.
MOST_CANDIDATES = 50


@dataclass(frozen=True)
class Choice:
    """The program in a notebook, and notes on how it was chosen."""

    code: str
    cells: tuple[int, ...]
    notes: tuple[str, ...] = ()


def digest_of(code: str) -> str:
    """Return the SHA-256 of a program without insignificant blanks, as in the record that `%check` saves."""
    return hashlib.sha256(python_code.bare(without_marks(code)).encode(errors="replace")).hexdigest()


def choose(notebook: Notebook, exercise: Exercise, target: ProgramFile, starters: frozenset[str]) -> Choice:
    """Return the program `target` in a notebook. `starters` are digests of the starters that were handed out.

    Raises `Unreadable` if no cell can be it, and `AmbiguousProgram` if several can.
    """
    candidates = _candidates(notebook.cells, exercise, target)
    begun = [one for one in candidates if not python_code.is_empty(one.code)]
    if not begun:
        if candidates:
            raise Unreadable(f"Your program is empty: there is no code in {candidates[-1].title} of the notebook.")
        if "python" not in (notebook.language or "python").lower():
            raise Unreadable(not_graded(notebook.language.capitalize()))
        raise Unreadable(_no_cell(notebook, target))
    if len(begun) > MOST_CANDIDATES:
        raise AmbiguousProgram(f"{len(begun)} cells of the notebook can be {target.file}. Delete or empty the others.")
    # A piece that an editor split from the cell keeps the cell's metadata.
    numbers = {one.number for one in begun if one.name or is_program(one.code, target)}
    programs = [(one, assemble(one, notebook.cells, exercise, numbers - {one.number})) for one in begun]
    if len(begun) > 1 and not any(is_complete(program.code) for _, program in programs):
        whole = joined(begun)
        if is_complete(whole.code):
            return Choice(whole.code, whole.cells, (_consists_of(whole),))
    chosen, why = _decided(programs, notebook, exercise, target, starters)
    cell, program = chosen
    others = _others(cell, program, candidates, notebook, target)
    return Choice(program.code, program.cells, tuple(_notes(cell, program, others, why)))


def _candidates(cells: Sequence[NotebookCell], exercise: Exercise, target: ProgramFile) -> list[NotebookCell]:
    """Return the cells that can be the program, by the first rule that any cell satisfies."""
    by_name = _by_name(cells, exercise, target.file.removesuffix(".py"))
    for tier in (by_name, [cell for cell in cells if cell.exercise == exercise.name], *_by_code(cells, target)):
        if any(cell.code.strip() for cell in tier):
            return tier
    return by_name


def _by_name(cells: Sequence[NotebookCell], exercise: Exercise, stem: str) -> list[NotebookCell]:
    """Return the cells that name the program, or the exercise if it has only one program."""
    names = ("", stem)

    def is_named(cell: NotebookCell) -> bool:
        if cell.name == stem and cell.magic.name != "part":
            return True
        return cell.exercise == exercise.name and cell.name in names and not exercise.programs

    return [cell for cell in cells if is_named(cell)]


def _by_code(cells: Sequence[NotebookCell], target: ProgramFile) -> Iterator[list[NotebookCell]]:
    """Yield the cells that define the program's class, those that create its node, and parts that define the class."""
    parts = [cell for cell in cells if cell.is_python]
    whole = [cell for cell in parts if cell.magic.name != "part"]
    yield [cell for cell in whole if python_code.defines(cell.code, target.class_name)]
    yield [cell for cell in whole if python_code.creates(cell.code, target.node)]
    yield [cell for cell in parts if python_code.defines(cell.code, target.class_name)]


def _decided(
    programs: Sequence[tuple[NotebookCell, AssembledProgram]],
    notebook: Notebook,
    exercise: Exercise,
    target: ProgramFile,
    starters: frozenset[str],
) -> tuple[tuple[NotebookCell, AssembledProgram], str]:
    """Return the cell that counts, with its program, and the reason."""
    if _are_equal(programs):
        return programs[-1], ""
    if checked := _checked(programs, notebook, exercise):
        return checked, "it is the one that %check judged last"
    rules: tuple[tuple[str, Callable[[NotebookCell, AssembledProgram], bool]], ...] = (
        ("the others are still the starter", lambda cell, program: digest_of(program.code) not in starters),
        (f"only it has the program {target.node}", lambda cell, program: is_program(program.code, target)),
        ("it is the whole of which the others are parts", lambda cell, program: not _is_inside(cell, programs)),
    )
    for why, fits in rules:
        left = [one for one in programs if fits(*one)]
        if left:
            programs = left
        if _are_equal(programs):
            return programs[-1], why
    titles = ", ".join(cell.title for cell, _ in programs)
    raise AmbiguousProgram(
        f"{len(programs)} cells of the notebook can be {target.file}, they differ, and no saved %check says which one "
        f"counts: {titles}. Delete or empty the others, or run %check and save the notebook."
    )


def _are_equal(programs: Sequence[tuple[NotebookCell, AssembledProgram]]) -> bool:
    return len({python_code.normalized(program.code) for _, program in programs}) == 1


def is_program(code: str, target: ProgramFile) -> bool:
    """Return whether the code has the program's class, or creates its node."""
    return python_code.defines(code, target.class_name) or python_code.creates(code, target.node)


def _is_inside(cell: NotebookCell, programs: Sequence[tuple[NotebookCell, AssembledProgram]]) -> bool:
    return any(cell.number in program.cells for other, program in programs if other != cell)


def _checked(
    programs: Sequence[tuple[NotebookCell, AssembledProgram]], notebook: Notebook, exercise: Exercise
) -> tuple[NotebookCell, AssembledProgram] | None:
    """Return the program that `%check` judged last, from the record in its saved output; None if unknown."""
    checks = [(cell.ran or 0, cell.number, (cell.checked or {}).get(exercise.name)) for cell in notebook.cells]
    digest = max((check for check in checks if check[2]), default=(0, 0, None))[2]
    return next((program for program in reversed(programs) if digest_of(program[1].code) == digest), None)


def _others(
    cell: NotebookCell,
    program: AssembledProgram,
    candidates: Sequence[NotebookCell],
    notebook: Notebook,
    target: ProgramFile,
) -> list[NotebookCell]:
    """Return the cells that did not become part of the program, but are for the exercise as well."""
    like_it = [one for one in notebook.cells if one.magic.name != "part" and is_program(one.code, target)]
    numbers = {one.number for one in (*candidates, *like_it)} - set(program.cells)
    same = python_code.normalized(cell.code)
    return [one for one in notebook.cells if one.number in numbers and python_code.normalized(one.code) != same]


def _notes(cell: NotebookCell, program: AssembledProgram, others: Sequence[NotebookCell], why: str) -> Iterator[str]:
    if others:
        if not why and any(not python_code.is_empty(one.code) for one in others):
            why = "it is the exercise's own cell"
        reason = why or ("the others have no program" if len(others) > 1 else "the other one has no program")
        text = f"{len(others) + 1} cells of the notebook are for this exercise."
        yield f"{text} Taken: {cell.title}, because {reason}."
    if len(program.cells) > 1:
        yield _consists_of(program)


def _consists_of(program: AssembledProgram) -> str:
    return f"Your program consists of the code cells {', '.join(map(str, program.cells))} of the notebook."


def _no_cell(notebook: Notebook, target: ProgramFile) -> str:
    code = f"class {target.class_name}" if target.class_name else f"node {target.node}"
    stem = target.file.removesuffix(".py")
    conflict = next((one for one in notebook.cells if re.search(r"^<{7}( .*)?$", one.source, re.MULTILINE)), None)
    if conflict:
        return (
            f"{conflict.title} holds the marks of a merge conflict from git. Choose one version, and delete the marks."
        )
    if is_program(notebook.text, target):
        return f"The {code} is in a text cell of the notebook, which is not run. Make it a code cell, and run %check."
    for cell in notebook.cells:
        if not cell.is_python and similar(f"{cell.magic.name} {cell.magic.line}".lower(), [f"node {stem}"], cutoff=0.8):
            return f"{cell.title} begins with a command that does not exist. Write %%node {stem}, and run %check."
    return (
        f"None of the notebook's {len(notebook.cells)} code cells is the exercise's. Write the {code} in the cell that "
        f"the chapter gives for it; it begins with %%node {stem}."
    )
