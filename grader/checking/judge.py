"""Runs an exercise's checks on recordings, or lists the checks. The student's program has ended by then."""

from __future__ import annotations

import contextlib
import difflib
import io
import os
import re
import sys
import tempfile
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path

import pytest

from grader.checking.plugin import Checks, ReportsWithoutTracebacks, fixtures_of
from grader.checking.run import Run
from grader.checking.verdict import Finding, ListedCheck, Verdict
from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.imported_files import importable
from grader.recording.recording import Recording


def judge(exercise: Exercise, runs: Mapping[str, Run], partly: bool = False) -> tuple[Verdict, ...]:
    """Return the verdict of every check on these runs, by scenario, in the order of the files.

    Raises `ExerciseError` if the files of checks are unusable. Runs pytest in this process, without the plugins that
    are installed on this machine. With `partly`, only the checks judge that need no other scenarios.
    """
    return judge_when_collected(exercise, runs, lambda: runs, partly)


def runs_of(
    exercise: Exercise,
    recordings: dict[str, Recording],
    references: dict[str, Recording],
    titles: dict[str, str],
    seed: int = 1,
) -> dict[str, Run]:
    """Return what a check sees of each scenario. `recordings` are the student's, `references` the solution's."""
    return {name: Run(exercise, recordings[name], references[name], titles.get(name, ""), seed) for name in recordings}


def judge_when_collected(
    exercise: Exercise, scenarios: Iterable[str], given: Callable[[], Mapping[str, Run]], partly: bool
) -> tuple[Verdict, ...]:
    """Judge as `judge` does, on what `given` returns for these scenarios.

    `given` is called once all checks are collected. It may fork, and return other runs in each process, for that
    process's verdicts.
    """
    runs: dict[str, Run | None] = dict.fromkeys(scenarios)
    checks = Checks(before_the_first=lambda: runs.update(given()), partly=partly)
    run_pytest(exercise, runs, checks)
    topics = [topic.name for topic in exercise.topics] + [endpoint.name for endpoint in exercise.endpoints]
    starts = {
        (one.namespace, *one.remappings.values()) for run in runs.values() if run for one in run.recording.programs
    }
    topics += [f"{space}{name}" for space, *_ in starts for name in topics] + [name for _, *to in starts for name in to]
    nodes = {f"/{exercise.node_name}", *(f"/{program.node}" for program in exercise.programs), *exercise.nodes}
    return tuple(with_spelling(verdict, topics, nodes) for verdict in checks.verdicts.values())


def load_pytest() -> None:
    """Make pytest import all its modules, by running a session without a test: it imports them once per process.

    A process that is forked from this one has them already, and judges in two thirds of the time.
    """
    with contextlib.suppress(OSError), tempfile.TemporaryDirectory() as empty:  # the modules are then loaded later
        _session(Path(empty), "--capture=no", empty)


def run_pytest(exercise: Exercise, runs: Mapping[str, Run | None], checks: Checks) -> None:
    """Run the exercise's checks on `runs` with pytest in this process; `checks` collects the results.

    Raises `ExerciseError` if the files of checks are unusable.
    """
    if not exercise.check_files:
        raise ExerciseError(exercise.folder / "checks.py", "there is no such file", "Write at least one check.")
    checks.scenarios = tuple(runs)
    with importable(exercise.folder):
        code = _session(
            exercise.folder,
            *("--import-mode=importlib", "-o", "python_files=*.py", "--capture=fd"),
            *(str(file) for file in exercise.check_files),
            plugins=[ReportsWithoutTracebacks(), checks, fixtures_of(runs)],
        )
    if checks.problem:
        raise checks.problem
    if code not in (pytest.ExitCode.OK, pytest.ExitCode.TESTS_FAILED):
        file: Path = exercise.check_files[0]
        advice = "Are there any checks in it?"
        if "$" in str(file):  # pytest puts the values of variables into paths
            advice = "Move the course to a path without a dollar sign."
        raise ExerciseError(file, f"pytest ended with {pytest.ExitCode(code).name}", advice)


def _session(folder: Path, *arguments: str, plugins: Sequence[object] = ()) -> int:
    """Run pytest so that it changes no module, reads no settings, prints nothing and does only what is needed.

    It reads no conftest.py above `folder`, and does not look at other files there, because they may belong to anyone.
    """
    alone = (
        *("--assert=plain", "-c", os.devnull, "--rootdir", str(folder), "--confcutdir", str(folder)),
        *("-p", "no:cacheprovider", "-p", "no:terminal"),
        *("-p", "no:unraisableexception"),  # it collects garbage at the end, which takes longer than the checks
    )
    with _nothing_from_outside(), contextlib.redirect_stdout(io.StringIO()):
        return pytest.main([*alone, *arguments], plugins=plugins)


@contextlib.contextmanager
def _nothing_from_outside():  # type: ignore[no-untyped-def]  # noqa: ANN202
    """Keep pytest's environment variables and byte code files away from the checks."""
    kept = {name: os.environ.pop(name) for name in list(os.environ) if name.startswith("PYTEST_")}
    os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"] = "1"
    wrote, sys.dont_write_bytecode = sys.dont_write_bytecode, True
    try:
        yield
    finally:
        sys.dont_write_bytecode = wrote
        del os.environ["PYTEST_DISABLE_PLUGIN_AUTOLOAD"]
        os.environ.update(kept)


def listed(exercise: Exercise, scenarios: tuple[str, ...] = ()) -> tuple[ListedCheck, ...]:
    """Return every check of the exercise, in the order of the files.

    With names of `scenarios`, a check that uses another one is an error. Raises `ExerciseError` if the files of checks
    are unusable. Imports them: call it in a process of its own.
    """
    checks = Checks(run=False)
    run_pytest(exercise, dict.fromkeys(scenarios), checks)
    return tuple(checks.listed.values())


TOPIC = re.compile(r"(?<![\w/])/\w[\w/]*")

#: How similar two names must be, by difflib's measure: /joint_comands and /joint_commands are 0.97.
ALIKE = 0.8


def with_spelling(verdict: Verdict, topics: Collection[str], nodes: Collection[str]) -> Verdict:
    """Add to a finding about topics the name of the exercise's `topics` that was probably meant.

    The names of its `nodes` may be similar to a topic's, and are no misspellings.
    """
    finding = verdict.finding
    if finding is None or finding.message is not None:
        return verdict
    return replace(verdict, finding=_suggest(finding, topics, nodes))


def _suggest(finding: Finding, topics: Collection[str], nodes: Collection[str]) -> Finding:
    for name in dict.fromkeys(TOPIC.findall(finding.text)):
        if name not in (*topics, *nodes) and (advice := _meant(name, topics)):
            return replace(finding, text=f"{finding.text} {advice}")
    return finding


def _likeness(name: str, other: str) -> float:
    """Return how similar two names are; of two in one namespace, only what follows it counts."""
    (space, _, end), (other_space, _, other_end) = name.rpartition("/"), other.rpartition("/")
    pair = (end, other_end) if space == other_space else (name, other)
    return difflib.SequenceMatcher(None, *pair).ratio()


def _meant(name: str, topics: Collection[str]) -> str:
    """Return what a name that the task does not have probably means."""
    if name.endswith("/transition_event"):
        return "A lifecycle node has this topic. The task asks for a plain one: derive it from rclpy.node.Node."
    similar = max(topics, key=lambda topic: _likeness(name, topic), default="")
    if similar and _likeness(name, similar) >= ALIKE:
        return f"Is {name} a misspelling of {similar}?"
    same_end = [topic for topic in topics if topic.rpartition("/")[2] == name.rpartition("/")[2]]
    return f"{name} is not {same_end[0]}: the whole name counts." if same_end else ""
