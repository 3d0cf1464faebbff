"""The pytest plugin that runs checks on recordings: fixtures for scenarios, verdicts instead of reports."""

from __future__ import annotations

import contextlib
import inspect
import tempfile
from collections.abc import Callable, Generator, Iterator, Mapping
from dataclasses import replace
from pathlib import Path
from types import ModuleType
from typing import Any, Literal

import pytest

from grader.checking import doubts
from grader.checking.ending_message import message_of
from grader.checking.hint_texts import hints
from grader.checking.run import Run
from grader.checking.verdict import CheckOptions, Finding, ListedCheck, Verdict, Wrong, check_options
from grader.exercise.computing_limit import computing_limit
from grader.exercise.exercise import ExerciseError
from grader.exercise.modules import error_in
from groundwork.words import look_alike

#: How hints begin that are for a node which works nowhere: a check that depends on others knows better.
_BASIC = tuple(hints(name)[0].partition("{")[0] for name in ("not_published", "only_zeros", "some_zeros"))

#: What a check may say in words.
_TEXTS = ("hint", "todo", "misconception", "untested")

#: Of a hint that says what to do: students don't read more.
MOST_WORDS = 160


def fixtures_of(runs: Mapping[str, Run | None]) -> ModuleType:
    """Return a module with one fixture per scenario, by its name, which returns what `runs` has when a check asks."""
    module = ModuleType("scenarios")
    for name in runs:
        setattr(module, name, pytest.fixture(name=name)(_giving(runs, name)))
    return module


def _giving(runs: Mapping[str, Run | None], name: str) -> Any:
    def scenario() -> Run:
        run = runs[name]
        assert run, "checks that are only listed are not run"
        if run.ending.outcome != "completed":
            run.wrong_at(None, message_of(run.ending, run.exercise))
        return run

    return scenario


class ReportsWithoutTracebacks:
    """Makes pytest's reports without tracebacks and the source around each line: they are never shown."""

    def pytest_runtest_makereport(self, item: pytest.Item, call: pytest.CallInfo[None]) -> pytest.TestReport:
        """Report only the outcome. pytest's own implementation is then not called."""
        outcome: Literal["passed", "failed", "skipped"] = "passed"
        if call.excinfo:
            outcome = "skipped" if isinstance(call.excinfo.value, pytest.skip.Exception) else "failed"
        assert call.when != "collect"
        return pytest.TestReport(item.nodeid, item.location, {}, outcome, None, call.when)


@contextlib.contextmanager
def _temporary_folder() -> Iterator[None]:
    """Give `tmp_path` a folder for these checks alone.

    pytest's own folder is shared by all tests of this user. pytest would remove what other sessions have left there,
    which may take a minute and may still be needed.
    """
    with contextlib.ExitStack() as stack:
        with contextlib.suppress(OSError):  # a full disk matters only to the checks that use the folder
            made = tempfile.TemporaryDirectory(prefix="spinbook-checks-", ignore_cleanup_errors=True)
            patch = stack.enter_context(pytest.MonkeyPatch.context())
            patch.setenv("PYTEST_DEBUG_TEMPROOT", stack.enter_context(made))
        yield


class Checks:
    """Collects an exercise's checks and keeps their verdicts.

    If `run` is False, none is run and each counts as blocked. `before_the_first` is called between collecting and
    running them. `partly` leaves out checks that need scenarios which are not known.
    """

    def __init__(
        self, run: bool = True, before_the_first: Callable[[], None] = lambda: None, partly: bool = False
    ) -> None:
        self._run, self._partly = run, partly
        self._before_the_first = before_the_first
        self.scenarios: tuple[str, ...] = ()
        """The known scenarios; empty if they do not matter."""
        self.listed: dict[str, ListedCheck] = {}
        self.verdicts: dict[str, Verdict] = {}
        self.problem: ExerciseError | None = None

    @pytest.hookimpl(trylast=True)
    def pytest_collection_modifyitems(self, items: list[pytest.Item]) -> None:
        """Read every mark, and make sure that the checks can run in their order.

        A check that another file imports, such as to name it in `depends`, is not collected again.
        """
        items[:] = [item for item in items if _is_defined_here(item)]
        if self._partly:
            items[:] = [item for item in items if not self._unknown_scenario(item)]
        for item in items:
            try:
                self.listed[item.name] = self._listed(item)
            except ExerciseError as error:
                self.problem = self.problem or error
        if self.problem:
            items.clear()

    def _listed(self, item: pytest.Item) -> ListedCheck:
        function = getattr(item, "function", None)
        line = inspect.unwrap(function).__code__.co_firstlineno if function else None
        title = (inspect.getdoc(function) or "").replace("\n", " ")
        mark = check_options(function)
        if mark and self._partly:
            mark = replace(mark, depends=tuple(name for name in mark.depends if name in self.listed))
        if not mark:
            problem, fix = f"{item.name} is not a check", "Put @check(points=…, hint=…) above it."
        elif item.name in self.listed:
            problem, fix = f"there are two checks called {item.name}", "Give each a name of its own."
        elif not title:
            problem, fix = f"{item.name} has no docstring", "Its docstring is the title that the student reads."
        elif isinstance(mark.points, bool) or not isinstance(mark.points, (int, float)) or not mark.points >= 0:
            problem, fix = f"{item.name} gives {mark.points!r} points", "Give points of 0 or more, such as points=5."
        elif other := [name for name in _TEXTS if not isinstance(getattr(mark, name), str)]:
            problem = f"the {other[0]} of {item.name} is {getattr(mark, other[0])!r}"
            fix = "Write it as a text in quotes."
        elif (words := len(mark.todo.split())) > MOST_WORDS:
            problem, fix = f"the todo of {item.name} has {words} words", f"Say what to do in up to {MOST_WORDS} words."
        elif missing := self._unknown_scenario(item):
            problem = f"{item.name} asks for the scenario {missing}, which scenarios.py does not have"
            fix = f"Its scenarios are: {', '.join(self.scenarios)}."
        elif unknown := [name for name in mark.depends if name not in self.listed]:
            problem = f"{item.name} depends on {unknown[0]}, but no check above it has that name"
            fix = "A check can depend only on checks above it. Public checks come before hidden ones."
        else:
            uses = [name for name in getattr(item, "fixturenames", ()) if name in self.scenarios or not self.scenarios]
            return ListedCheck(
                **vars(mark),
                name=item.name,
                title=title,
                hidden=item.path.name == "hidden_checks.py",
                scenarios=tuple(uses),
                file=item.path,
                line=line or 1,
            )
        raise ExerciseError(item.path, problem, fix, line)

    def _unknown_scenario(self, item: Any) -> str:
        """Return the first argument of a check that is neither a scenario nor another fixture; empty if there is
        none.
        """
        info = item._fixtureinfo
        known = {*info.name2fixturedefs, "request", *self.scenarios}
        return next((name for name in info.names_closure if name not in known), "") if self.scenarios else ""

    @pytest.hookimpl(wrapper=True)
    def pytest_collection(self, session: pytest.Session) -> Generator[None, object, object]:
        """End a file of checks that computes for too long while it is imported, in the line at which it is."""
        with computing_limit():
            return (yield)

    def pytest_exception_interact(self, node: Any, call: pytest.CallInfo[Any], report: object) -> None:
        """Report a file of checks that can't be imported: the author must fix it."""
        if isinstance(report, pytest.CollectReport) and call.excinfo and not self.problem:
            error = call.excinfo.value.__cause__ or call.excinfo.value
            self.problem = error_in(
                error, node.path.parent, node.path, "it can't be read", "Fix it: this file is imported first."
            )

    @pytest.hookimpl(wrapper=True)
    def pytest_runtestloop(self, session: pytest.Session) -> Generator[None, object, object]:
        """Call `before_the_first` if the checks can be run. pytest's own implementation then runs them."""
        if session.items and not session.testsfailed:
            self._before_the_first()
        with _temporary_folder():  # only now: this may be a fork of the process that collected them
            return (yield)

    @pytest.hookimpl(tryfirst=True)
    def pytest_runtest_setup(self, item: pytest.Item) -> None:
        """Skip what can't be judged."""
        doubts.begin()
        if not self._run:
            pytest.skip("only listed")
        blocking = self._blocking(item.name)
        if blocking:
            pytest.skip("blocked by " + ", ".join(blocking))

    def _blocking(self, name: str) -> tuple[str, ...]:
        """Return the checks without which it can't be judged, except those that are blocked themselves."""
        blocking: dict[str, None] = {}
        for other in self.listed[name].depends:
            if self.verdicts[other].blocks:
                blocking.update(dict.fromkeys(self.verdicts[other].blocked_by or (other,)))
        return tuple(blocking)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_call(self, item: pytest.Item) -> Any:
        """End a check that computes for too long, in the line at which it is."""
        with computing_limit():
            return (yield)

    @pytest.hookimpl(wrapper=True)
    def pytest_runtest_makereport(self, item: pytest.Item, call: pytest.CallInfo[None]) -> Any:
        """Turn pytest's outcome into a verdict."""
        report: pytest.TestReport = yield
        if report.when == "call":
            self.listed[item.name] = replace(self.listed[item.name], seconds=call.duration)
        if report.when == "call" or (report.when == "setup" and not report.passed):
            self.verdicts[item.name] = self._verdict(item, call)
        return report

    def _verdict(self, item: pytest.Item, call: pytest.CallInfo[None]) -> Verdict:
        check = self.listed[item.name]
        verdict = Verdict(
            *(check.name, check.title, "passed", check.points, check.hint, check.misconception, check.hidden),
            todo=check.todo,
            untested=check.untested,
        )
        error = call.excinfo.value if call.excinfo else None
        if error is None:
            return replace(verdict, untested=check.untested or doubts.untested())
        if isinstance(error, pytest.skip.Exception):
            return replace(verdict, status="blocked", blocked_by=self._blocking(item.name))
        if isinstance(error, AssertionError):
            text = str(error) or f"“{verdict.title}” is not so."  # an assert without a message
            wrong = error if isinstance(error, Wrong) else Wrong(Finding(text))
            finding = suited(wrong.finding.shortened(), check)
            if advice := look_alike(finding.got, finding.expected):
                finding = replace(finding, text=f"{finding.text} {advice}")
            return replace(verdict, status="failed", finding=finding, share=wrong.share, partial=check.partial)
        advice = ""
        if isinstance(error, NameError) and error.name in self.scenarios:
            advice = f". {error.name} is a scenario: add it to the arguments of {item.name}"
        return replace(verdict, status="error", error=_describe(error, item.path) + advice)


def suited(finding: Finding, options: CheckOptions) -> Finding:
    """Return the finding of a check, without hints for a node that works nowhere if the check depends on others."""
    basic = options.depends and finding.where.startswith(_BASIC)
    return replace(finding, where="", todo="") if basic else finding


def _is_defined_here(item: pytest.Item) -> bool:
    function = getattr(item, "function", None)
    return function is None or inspect.unwrap(function).__code__.co_filename == str(item.path)


def _describe(error: BaseException, file: Path) -> str:
    problem = error_in(error, file.parent, file, fix="").problem
    return f"{problem.place}: {problem.problem}. {problem.fix}".removesuffix(". ")
