"""Proofreads an exercise for its author: finds everything that is wrong in its files, before anything runs.

`problems_of` does this in a process of its own, because it imports scenarios.py and the files of checks.
"""

from __future__ import annotations

import ast
import json
import os
import re
import signal
import subprocess
import sys
from collections.abc import Collection, Iterable, Iterator
from pathlib import Path
from typing import NoReturn

from grader.checking import known_names
from grader.checking.agreement import disagreements, unheard_commands
from grader.checking.judge import listed
from grader.checking.misspellings import misspellings
from grader.checking.verdict import ListedCheck
from grader.checking.weak_checks import weak_checks
from grader.exercise.exercise import Exercise, ExerciseError, ServiceOrAction, Topic
from grader.exercise.imported_files import tree_in, with_modules
from grader.exercise.loading import load
from grader.exercise.mistakes import each_mistake
from grader.exercise.modules import error_in, import_of
from grader.exercise.rules import ids_used_twice, named_by, rules_of, without_markup
from grader.exercise.starter import MarkerError, starter
from grader.recording.arrays import ArrayEncoder
from grader.scenario.declared import declared
from grader.scenario.scenario import Scenario
from grader.submission import python_code
from groundwork.child_process import run_program
from groundwork.clean_environment import module_command, without_foreign
from groundwork.problem import Problem
from groundwork.words import counted, did_you_mean

#: The time limit (s) for importing an exercise's files.
TIME_LIMIT_S = 60

#: After this time (s) the line that sleeps, or waits for something else, is named. One that computes is named sooner.
_WAITING_LIMIT_S = TIME_LIMIT_S - 10


def problems_of(folder: Path) -> tuple[Problem, ...]:
    """Return everything that is wrong in the files of the exercise in `folder`, as far as it shows without running
    a node.
    """
    command = module_command("grader.checking.proofreader", str(folder))
    try:
        run = run_program(command, TIME_LIMIT_S, env=without_foreign(dict(os.environ)))
        entries = json.loads(run.stdout.splitlines()[-1])
    except subprocess.TimeoutExpired:
        problem = f"reading its Python files takes more than {TIME_LIMIT_S} s"
        return (Problem(folder, None, problem, "They must only define."),)
    except (ValueError, IndexError):
        last = (run.stderr.strip().splitlines() or ["no message"])[-1]
        return (Problem(folder, None, f"its Python files can't be read: {last}", "They must only define."),)
    return tuple(Problem(Path(file), line, problem, fix) for file, line, problem, fix in entries)


def faults(folder: Path) -> Iterator[ExerciseError]:
    """Yield the same, in this process."""
    try:
        exercise = load(folder)
    except ExerciseError as error:
        yield error
        return
    yield from _of_solution(exercise)
    yield from disagreements(exercise)
    scenarios: tuple[Scenario, ...] = ()
    try:
        scenarios = declared(exercise, seed=0)
        of_names = [*others_each_time(exercise, scenarios, declared(exercise, seed=0))]
        of_names += [*misspellings(exercise, scenarios), *unheard_commands(exercise, scenarios)]
    except ExerciseError as error:
        of_names = [error]
    files = with_modules([exercise.scenarios_file, *exercise.check_files])
    yield from undefined_names(files, {scenario.name for scenario in scenarios})
    yield from of_names
    for file in exercise.check_files:
        yield from same_name_twice(file)
        yield from weak_checks(file, tree_in(file))
    yield from _twice_in_the_task(exercise)
    yield from _units_of_nothing(exercise)
    yield from rules_that_the_task_lacks(exercise.task, exercise.check_files)
    try:
        checks = listed(exercise, tuple(scenario.name for scenario in scenarios))
    except ExerciseError as error:
        yield error
        return
    yield from _worth_nothing(exercise, checks)
    yield from points_that_do_not_add_up(exercise, [(check.hidden, check.points) for check in checks])
    yield from _of_mistakes(exercise, checks)


def others_each_time(
    exercise: Exercise, scenarios: tuple[Scenario, ...], again: tuple[Scenario, ...]
) -> Iterator[ExerciseError]:
    """Yield scenarios that differ although their seed is the same: students would not get the same grade twice."""
    fix = "Take random values from the seed: random.Random(seed)."
    if len(scenarios) != len(again):
        problem = f"{counted(len(scenarios), 'scenario')} the first time, {len(again)} the second, with the same seed"
        yield ExerciseError(exercise.scenarios_file, problem, fix, None)
    for first, second in zip(scenarios, again, strict=False):
        if _content(first) != _content(second):
            problem = f"the scenario {first.name} is another one each time, with the same seed"
            yield ExerciseError(exercise.scenarios_file, problem, fix, first.line or None)


def _content(scenario: Scenario) -> str:
    messages = json.dumps([(one.at, one.topic, one.fields) for one in scenario.messages], cls=ArrayEncoder)
    world = repr(scenario.world.arguments) if scenario.world else ""
    # Objects that say only where they are in memory differ each time.
    parts = (part for part in (repr(scenario.steps), repr(scenario.parameters), world) if " at 0x" not in part)
    return "\n".join([messages, repr(scenario.duration), *parts])


def same_name_twice(file: Path) -> Iterator[ExerciseError]:
    """Yield checks with the same name in a file: Python silently keeps only the last one."""
    first: dict[str, int] = {}
    for node in tree_in(file).body:
        if isinstance(node, (ast.FunctionDef, ast.AsyncFunctionDef)) and node.name.startswith("test"):
            if node.name in first:
                problem = f"there are two checks called {node.name}; the other is in line {first[node.name]}"
                yield ExerciseError(
                    file, problem, "Give each its own name: Python keeps only the last one.", node.lineno
                )
            first.setdefault(node.name, node.lineno)


def undefined_names(files: Iterable[Path], scenarios: Collection[str]) -> Iterator[ExerciseError]:
    """Yield names that a file uses and nothing in it defines. Python notices it only when it comes to such a line.

    A check has the `scenarios` that are among its arguments.
    """
    for file in files:
        tree = tree_in(file)
        imports_all = any(isinstance(node, ast.alias) and node.name == "*" for node in ast.walk(tree))
        for name in sorted(python_code.missing(ast.unparse(tree))) if not imports_all else ():
            lines = {node.lineno for node in ast.walk(tree) if isinstance(node, ast.Name) and node.id == name}
            line = min(lines - _lines_with(name, tree), default=None)
            fix = _remedy_for(name, tree, line or 0, scenarios)
            yield ExerciseError(file, f"there is no {name} in this file", fix, line)


def _lines_with(argument: str, tree: ast.Module) -> set[int]:
    """Return the lines of the functions that have this argument."""
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    having = [one for one in functions if any(argument == name.arg for name in one.args.args)]
    return {line for one in having for line in range(one.lineno, (one.end_lineno or one.lineno) + 1)}


def _remedy_for(name: str, tree: ast.Module, line: int, scenarios: Collection[str]) -> str:
    functions = [node for node in ast.walk(tree) if isinstance(node, ast.FunctionDef)]
    around = [node.name for node in functions if node.lineno <= line <= (node.end_lineno or 0)]
    if name in scenarios and around:
        return f"{name} is a scenario: add it to the arguments of {around[0]}."
    if imported := import_of(name):
        return f"Import it: {imported}"
    known = python_code.bound(tree.body) | {node.arg for node in ast.walk(tree) if isinstance(node, ast.arg)}
    return did_you_mean(name, sorted(known), "Define it, or import it.")


def _twice_in_the_task(exercise: Exercise) -> Iterator[ExerciseError]:
    for rule in ids_used_twice(rules_of(exercise.task)):
        fix = "Give each rule an id of its own."
        yield ExerciseError(exercise.folder / "task.md", f"another rule has the id {rule.id}, too", fix, rule.line)


def _units_of_nothing(exercise: Exercise) -> Iterator[ExerciseError]:
    """Yield units in exercise.toml of fields that a type does not have."""
    file = exercise.folder / "exercise.toml"
    ends: tuple[Topic | ServiceOrAction, ...] = (*exercise.topics, *exercise.endpoints)
    for end in ends:
        types = _types_with_fields(end)
        for path in end.units:
            if any(known_names.fields(one) for one in types) and not any(known_names.has(one, path) for one in types):
                every = ", ".join(dict.fromkeys(name for one in types for name in known_names.fields(one)))
                line = line_with(file, rf'\s*(?:topic|name)\s*=\s*"{re.escape(end.name)}"')
                yield ExerciseError(
                    file, f"{end.name} has a unit for {path}, and no such field", f"It has: {every}.", line
                )


def _types_with_fields(end: Topic | ServiceOrAction) -> list[str]:
    if isinstance(end, Topic):
        return [end.type]
    parts = ("Goal", "Result", "Feedback") if end.role.startswith("action") else ("Request", "Response")
    return [f"{end.type}.{part}" for part in parts]


def rules_that_the_task_lacks(task: str, check_files: Iterable[Path]) -> Iterator[ExerciseError]:
    """Yield checks whose `rule` is neither a sentence of `task`, the text of task.md, nor the id of a rule there."""
    for file in check_files:
        for line, rule in _rules(file):
            yield from rule_that_the_task_lacks(task, rule, file, line)


def rule_that_the_task_lacks(
    task: str, rule: str, file: Path, line: int, subject: str = "a check"
) -> Iterator[ExerciseError]:
    """Yield the error for a check in this line of `file` if its `rule` is not in `task`."""
    if without_markup(rule) not in without_markup(task) and not named_by(rule, rules_of(task)):
        problem = f"{subject} is based on a sentence that is not in task.md: “{rule}”"
        yield ExerciseError(file, problem, "Write the sentence in task.md, or quote a sentence that is there.", line)


def _rules(file: Path) -> Iterator[tuple[int, str]]:
    for node in ast.walk(tree_in(file)):
        if isinstance(node, ast.keyword) and node.arg == "rule":
            several = node.value.elts if isinstance(node.value, (ast.Tuple, ast.List)) else [node.value]
            yield from ((each.lineno, str(each.value)) for each in several if isinstance(each, ast.Constant))


def points_that_do_not_add_up(exercise: Exercise, points: list[tuple[bool, float]]) -> Iterator[ExerciseError]:
    """Yield the error if `points` do not have the declared sum. It says of each check whether it is hidden, and its
    points.
    """
    public, hidden = (sum(number for is_hidden, number in points if is_hidden is which) for which in (False, True))
    if exercise.public_only or abs(public + hidden - exercise.points) <= 1e-9:
        return
    parts = f"checks.py {public:g}, hidden_checks.py {hidden:g}"
    problem = f"the checks give {public + hidden:g} points together ({parts}), but points = {exercise.points:g}"
    file = exercise.folder / "exercise.toml"
    line = line_with(file, r"\s*points\s*=")
    yield ExerciseError(file, problem, "Make the two agree.", line)


def line_with(file: Path, pattern: str) -> int | None:
    """Return the first line of a file that matches, counted from 1; None if none does or the file can't be read."""
    try:
        lines = file.read_text(encoding="utf-8-sig").splitlines()
    except (OSError, UnicodeDecodeError):
        return None
    return next((number for number, line in enumerate(lines, start=1) if re.match(pattern, line)), None)


def _of_solution(exercise: Exercise) -> Iterator[ExerciseError]:
    file = exercise.solution_file
    if file is None:
        return
    if not file.exists():
        yield ExerciseError(file, "there is no such file", "The checks compare with the solution; write it here.")
        return
    try:
        text = file.read_text(encoding="utf-8-sig")
        classes = {node.name for node in ast.walk(ast.parse(text)) if isinstance(node, ast.ClassDef)}
        starter(text)
        if exercise.class_name and not exercise.programs and exercise.class_name not in classes:
            line = line_with(exercise.folder / "exercise.toml", r"\s*class\s*=")
            problem, fix = f"the solution has no class {exercise.class_name}", "Make the two agree, or leave it out."
            yield ExerciseError(exercise.folder / "exercise.toml", problem, fix, line)
    except SyntaxError as error:
        yield ExerciseError(file, f"it is not valid Python: {error.msg}", "Fix it, and grade it.", error.lineno)
    except MarkerError as error:
        yield ExerciseError(
            file, str(error).partition(": ")[2], "Fix the markers; the starter is made from them.", error.line
        )


def _worth_nothing(exercise: Exercise, checks: tuple[ListedCheck, ...]) -> Iterator[ExerciseError]:
    """Yield checks without points on which no other depends: nothing comes of them."""
    needed = {name for check in checks for name in check.depends}
    for check in checks:
        if not check.points and check.name not in needed:
            file = exercise.folder / ("hidden_checks.py" if check.hidden else "checks.py")
            problem = f"{check.name} gives no points, and no check depends on it"
            yield ExerciseError(
                file, problem, "Give it points, or leave it out.", line_with(file, rf"def {check.name}\b")
            )


def _of_mistakes(exercise: Exercise, checks: tuple[ListedCheck, ...]) -> Iterator[ExerciseError]:
    known = {check.name for check in checks}
    for mistake in each_mistake(exercise):
        if isinstance(mistake, ExerciseError):
            yield mistake
            continue
        for rule in mistake.breaks:
            yield from rule_that_the_task_lacks(exercise.task, rule, mistake.file, mistake.line, mistake.name)
        for name in mistake.caught_by:
            if name not in known:
                problem = f"{mistake.name} is to be caught by {name}, and there is no such check"
                yield ExerciseError(mistake.file, problem, "Name a check of this exercise, or remove it.", mistake.line)
        if not mistake.caught_by:
            problem, fix = f"{mistake.name} names no check that must catch it", "Write “Caught by:” and the checks."
            yield ExerciseError(mistake.file, problem, fix, mistake.line)


def _waits(number: int, frame: object) -> NoReturn:
    raise TimeoutError(f"it still waits after {_WAITING_LIMIT_S:g} s")


def main() -> None:
    """Print the problems of the exercise that the command line names, as JSON."""
    folder = Path(sys.argv[1])
    signal.signal(signal.SIGALRM, _waits)
    signal.setitimer(signal.ITIMER_REAL, _WAITING_LIMIT_S)
    errors: list[ExerciseError] = []
    try:
        errors.extend(faults(folder))
    except Exception as error:  # an author's code, such as a world, may raise anything wherever it is called
        errors.append(error_in(error, folder, folder / "exercise.toml"))
    problems = [error.problem for error in errors]
    print(json.dumps([(str(p.file), p.line, p.problem, p.fix) for p in problems]))


if __name__ == "__main__":
    main()
