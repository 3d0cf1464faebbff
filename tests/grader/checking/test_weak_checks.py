"""A check that can't fail or can't run is found in its source, and scenarios that ignore the seed by two calls."""

from __future__ import annotations

import ast
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import pytest
from made_up import EMPTY, EXERCISE, published, run

from grader.checking.agreement import unheard_commands
from grader.checking.proofreader import others_each_time, undefined_names
from grader.checking.run import Run
from grader.checking.weak_checks import weak_checks
from grader.scenario.models import JointChain
from grader.scenario.scenario import Scenario, SetParameter
from grader.scenario.steps import at
from grader.scenario.world import World

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


@pytest.mark.parametrize(
    ("check", "problem"),
    [
        (lambda run: run.must_match("data"), "sends 0 messages to the node, so no answer can be judged"),
        (lambda run: run.must_vary("data"), "sends 0 messages to the node"),
        (lambda run: run.must_be_silent(), "sends 0 messages to the node"),
        (lambda run: run.must_be_silent_at_first(), "sends 0 messages to the node"),
        (lambda run: run.must_match_responses("sum"), "the scenario plain never calls /add. Add a step"),
        (lambda run: run.must_respond(), "the scenario plain never calls /add"),
        (lambda run: run.must_match_results(), "the scenario plain sends no goal for /count"),
        (lambda run: run.must_transition(), "the scenario plain asks for no transition"),
        (lambda run: run.must_take("gain"), "the scenario plain never sets the parameter gain."),
        (lambda run: run.must_take_and_refuse_as_the_solution(), "the scenario plain sets no parameter"),
        (lambda run: run.must_have_qos("/outt"), "exercise.toml does not declare /outt"),
        (
            lambda run: run.on("/outt"),
            "there is no topic /outt in exercise.toml, nor in the scenario plain. Did you mean",
        ),
        (lambda run: run.messages_on("/outt"), "Did you mean /out?"),
        (lambda run: run.must_publish("/outt", count=0), "Did you mean /out?"),
        (
            lambda run: run.calls("/ad"),
            "there is no service /ad in exercise.toml, nor in the scenario plain. Did you mean",
        ),
        (lambda run: run.goals("/cuont"), "Did you mean /count?"),
    ],
)
def test_a_helper_with_nothing_to_judge_is_the_authors_fault(check: Callable[[Run], object], problem: str) -> None:
    for mine in (EMPTY, published((1.0,), (2.0,))):
        with pytest.raises(ValueError, match=problem.replace("?", r"\?")):
            check(run(mine, EMPTY))


def test_names_in_a_namespace_and_those_of_every_node_are_right() -> None:
    assert not run(EMPTY).messages_on("/left/out")
    assert not run(EMPTY).messages_on("/rosout")


def test_a_scenario_that_is_no_argument_of_its_check_is_named(tmp_path: Path) -> None:
    file = tmp_path / "checks.py"
    file.write_text("def test_a(usual):\n    usual.must_answer()\n\n\ndef test_b():\n    usual.must_answer()\n")
    (error,) = undefined_names([file], {"usual"})
    assert (error.problem.line, error.problem.problem) == (6, "there is no usual in this file")
    assert error.problem.fix == "usual is a scenario: add it to the arguments of test_b."


@pytest.mark.parametrize(
    ("topic", "fix"), [("/ouut", "Did you mean /out?"), ("/left", "There are: /out."), ("/out", "")]
)
def test_a_topic_that_a_world_reads_and_nobody_publishes_is_named(topic: str, fix: str) -> None:
    world = World(JointChain, joints={"elbow": 0.0}, commands=topic)
    errors = list(unheard_commands(EXERCISE, [Scenario("chain", "", duration=1.0, world=world)]))
    assert [error.problem.fix for error in errors] == ([fix] if fix else [])
    assert all(f"the world of chain reads {topic}" in error.problem.problem for error in errors)
    assert not list(unheard_commands(EXERCISE, [Scenario("chain", "", world=World(JointChain, joints={}))]))
