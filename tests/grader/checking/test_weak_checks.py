"""A check that can't fail or can't run is found in its source, and scenarios that ignore the seed by two calls."""

from __future__ import annotations

import ast
from dataclasses import replace
from pathlib import Path

import pytest
from made_up import EXERCISE

from grader.checking.proofreader import others_each_time
from grader.checking.weak_checks import weak_checks
from grader.scenario.scenario import Scenario, SetParameter
from grader.scenario.steps import at

CHECK = '@check(points=1, hint="")\ndef test_it(near: Run) -> None:\n    """It works."""\n    {line}\n'


@pytest.mark.parametrize(
    ("line", "problem"),
    [
        ("pass", "test_it can't fail: it calls nothing"),
        ("near.received and near.sent", "test_it can't fail: it calls nothing"),
        ("len(near.received) == 4", "nothing uses the result of this comparison"),
        ("assert (len(near.received) == 4, 'too few')", "assert of a tuple always holds"),
        ("yield near.must_answer()", "test_it has yield"),
        ("return near.must_answer() and 4", "nothing uses what test_it returns"),
        ("near.must_answer()", ""),
        ("assert near.received, 'Nothing came.'", ""),
    ],
)
def test_a_check_that_can_not_fail_is_found(line: str, problem: str) -> None:
    errors = list(weak_checks(Path("checks.py"), ast.parse(CHECK.format(line=line))))
    assert bool(errors) == bool(problem)
    assert problem in (errors[0].problem.problem if errors else "")
    assert all(error.problem.line for error in errors)


@pytest.mark.parametrize(
    ("old", "new", "problem"),
    [("def", "async def", "test_it is async"), (": Run", ": Run = None", "test_it has a default for near")],
)
def test_so_is_one_that_can_not_run(old: str, new: str, problem: str) -> None:
    text = CHECK.format(line="near.must_answer()").replace(old, new)
    (error,) = weak_checks(Path("checks.py"), ast.parse(text))
    assert problem in error.problem.problem


def test_scenarios_must_be_the_same_for_one_seed() -> None:
    steps = at(1.0).set_parameter("gain", 1.0)
    first = Scenario("first", "", steps, duration=2.0)
    second = replace(first, steps=(replace(steps[0], value=2.0),))
    assert isinstance(first.steps[0], SetParameter)
    assert not list(others_each_time(EXERCISE, (first,), (replace(first),)))
    (error,) = others_each_time(EXERCISE, (first,), (second,))
    assert "the scenario first is another one each time" in error.problem.problem
    (error,) = others_each_time(EXERCISE, (first,), (first, second))
    assert "1 scenario the first time, 2 the second" in error.problem.problem
