"""Makes all mutants of a program."""

from __future__ import annotations

import ast
import difflib
import hashlib
import re
import warnings
from collections.abc import Callable, Iterator
from dataclasses import dataclass

import libcst as cst

from grader.audit.mutants import end_points, messages, numbers, peers, statements
from grader.audit.mutants.program import Change, ParsedProgram
from grader.exercise.exercise import Exercise


@dataclass(frozen=True)
class Mutant:
    """A copy of a right program with one change.

    `id` names the change. It stays the same as long as the changed lines and the function around them do, whatever the
    names of the exercise, its class and its node are. `operator` is the kind of change, `what` describes it in words,
    and `line` is where it is, counted from 1. `source` is the whole program, and `diff` the change as a unified diff.
    """

    id: str
    operator: str
    what: str
    line: int
    source: str
    diff: str


Operator = Callable[[cst.CSTNode, ParsedProgram], Iterator[Change]]

#: What may go wrong in one place, in the order in which it is tried.
OPERATORS: tuple[Operator, ...] = (
    *statements.CONDITIONS,
    *numbers.NUMBERS,
    *statements.STATEMENTS,
    *statements.LOOPS,
    *end_points.OPERATORS,
    *messages.OPERATORS,
    *numbers.HISTORY,
    *peers.OPERATORS,
)


def mutants_of(source: str, exercise: Exercise) -> tuple[Mutant, ...]:
    """Return every mutant of a program, in the order of its lines.

    No mutant occurs twice, and none means the same to Python as the program. All of them compile, because Python itself
    reports the others to a student.
    """
    program = ParsedProgram(source, exercise)
    seen = {_meaning(source)}
    ids: dict[str, int] = {}
    mutants: list[Mutant] = []
    for node in program.nodes():
        for operator in OPERATORS:
            for change in operator(node, program):
                changed = program.changed(change)
                meaning = _meaning(changed)
                if meaning and meaning not in seen:
                    seen.add(meaning)
                    mutants.append(_mutant(program, operator.__name__, change, changed, ids))
    return tuple(sorted(mutants, key=lambda mutant: mutant.line))


def _mutant(program: ParsedProgram, operator: str, change: Change, changed: str, ids: dict[str, int]) -> Mutant:
    old, new = program.source.splitlines(), changed.splitlines()
    file = program.exercise.file_name
    diff = list(difflib.unified_diff(old, new, file, file, lineterm=""))
    lines = [line[0] + line[1:].strip() for line in diff[2:] if line[0] in "+-"]
    text = "\n".join([program.place(change.where), change.what, *lines])
    id_ = hashlib.sha256(_without_names(text, program.exercise).encode()).hexdigest()[:10]
    # The same change may be possible in two places of one function.
    ids[id_] = ids.get(id_, 0) + 1
    if ids[id_] > 1:
        id_ += f"-{ids[id_]}"
    name = operator.replace("_", " ")
    return Mutant(id_, name, change.what, program.line(change.where), changed, "\n".join(diff))


def _without_names(text: str, exercise: Exercise) -> str:
    """Return the text without the names that differ between two exercises made from one template: class and node."""
    if exercise.class_name and not exercise.programs:
        text = re.sub(rf"\b{re.escape(exercise.class_name)}\b", "CLASS", text)
    # A node's name may be a word that the program uses for something else, such as `goal`: replace it only in quotes.
    return re.sub(rf"(?<=[\"']){re.escape(exercise.node_name)}", "node", text)


def _meaning(source: str) -> str:
    """Return what a program means to Python, whatever its layout; empty if it does not compile."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")
            tree = ast.parse(source)
            compile(tree, "mutant", "exec")
    except (SyntaxError, ValueError):
        return ""
    return ast.dump(tree)
