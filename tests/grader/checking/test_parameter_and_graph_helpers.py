"""What the helpers for parameters, nodes, end points, QoS and ends say."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest
from made_up import EMPTY, ENDS, EXERCISE, ns, run, says

from grader.exercise.exercise import ProgramFile, Topic
from grader.recording import Ending, Recording
from grader.recording.events import ParameterChange, ParameterReading, ProgramExit, ProgramStart


def set_to(*changes: tuple[Any, bool | None]) -> Recording:
    made = tuple(ParameterChange(ns(1), "/worker", "gain", value, taken, "too small") for value, taken in changes)
    return replace(EMPTY, parameters=made)


def read(value: Any, answered: bool = True) -> Recording:
    reading = ParameterReading(ns(2), "/worker", "gain", value, ns(2) if answered else None)
    return replace(EMPTY, readings=(reading,))


def test_right_parameters_pass() -> None:
    mine = run(set_to((3.0, True), (-1.0, False), (3, False)))
    mine.must_take("gain", 3.0)
    mine.must_refuse("gain", -1.0)
    mine.must_refuse("gain", 3)
    mine.must_take_and_refuse_as_the_solution()
    run(read(2.0)).must_have_parameter("gain", 2.0)
    run(read(2.0)).must_have_parameter("gain")


def test_parameters_that_are_taken_or_refused_wrongly() -> None:
    takes, refuses = set_to((3.0, True), (-1.0, True)), set_to((3.0, False), (-1.0, False))
    right, mute = set_to((3.0, True), (-1.0, False)), set_to((3.0, None))
    assert says(lambda: run(takes, right).must_refuse("gain", -1.0)) == (
        "At 1.00 s (as usual), parameter gain: the value -1.0 must be refused, but your node took it. "
        "Your node takes every value. Did you add an on-set callback?"
    )
    message = says(lambda: run(refuses, right).must_take_and_refuse_as_the_solution())
    assert (
        "the value 3.0 must be taken, but your node refused it. It said: too small. Your node refuses every" in message
    )
    undeclared = replace(EMPTY, parameters=(replace(refuses.parameters[0], reason="access to undeclared parameter"),))
    assert "your node does not have it. Declare it" in says(lambda: run(undeclared, right).must_take("gain", 3.0))
    assert "your node did not answer." in says(lambda: run(mute, right).must_take("gain"))


@pytest.mark.parametrize(
    ("mine", "message"),
    [
        (read(3.0), "parameter gain: expected 2 1/s, got 3 1/s."),
        (read(2), "expected 2.0, a double, got 2, an integer."),
        (read(None), "your node does not have it. Declare it in __init__, with declare_parameter."),
        (read(None, answered=False), "your node did not answer."),
    ],
)
def test_readings(mine: Recording, message: str) -> None:
    assert message in says(lambda: run(mine, read(2.0)).must_have_parameter("gain"))


def test_an_author_who_asks_for_a_parameter_that_the_scenario_does_not_is_reported() -> None:
    with pytest.raises(ValueError, match=r"sets gain to 3, never to 4\.0"):
        run(set_to((3.0, True))).must_take("gain", 4.0)
    with pytest.raises(ValueError, match="never asks for the parameter gain"):
        run(EMPTY).must_have_parameter("gain")


def test_a_right_program_passes() -> None:
    mine = run(replace(EMPTY, ending=Ending("completed", interrupted=True)))
    mine.must_have_interface()
    mine.must_have_nodes()
    mine.must_have_qos()
    mine.must_end_on_ctrl_c()
    mine.must_survive()


@pytest.mark.parametrize(
    ("number", "fields", "message"),
    [
        (0, {"topic": "/inn"}, "Your node does not subscribe to /in. It subscribes to: /inn."),
        (1, {"topic": "/outt"}, "Your node does not publish on /out. It publishes on: /outt."),
        (
            2,
            {"kind": "client"},
            "Your node does not have a service /add. Its services are: none. It has only the other",
        ),
        (
            1,
            {"type": "std_msgs/msg/Float32"},
            "Your publisher on /out has another type. Expected std_msgs/msg/Float64",
        ),
        (2, {"topic": "/ad"}, "Your node does not have a service /add. Its services are: /ad."),
        (3, {"kind": "publisher"}, "Your node does not have an action /count. Its actions are: none."),
    ],
)
def test_an_end_point_that_is_missing(number: int, fields: dict[str, Any], message: str) -> None:
    ends = tuple(replace(end, **fields) if i == number else end for i, end in enumerate(ENDS))
    assert says(run(replace(EMPTY, end_points=ends)).must_have_interface).startswith(message)


def test_a_check_may_ask_for_some_end_points_only() -> None:
    mine = run(replace(EMPTY, end_points=ENDS[:1]))
    mine.must_have_interface("/in")
    assert says(lambda: mine.must_have_interface("/in", "/out")).startswith("Your node does not publish on /out.")
    with pytest.raises(ValueError, match="does not declare /inn"):
        mine.must_have_interface("/inn")


def test_end_points_that_are_too_many() -> None:
    run(EMPTY).must_have_interface(only=True)
    more = replace(EMPTY, end_points=(*ENDS, replace(ENDS[0], topic="/clock"), replace(ENDS[0], topic="/other")))
    assert says(lambda: run(more).must_have_interface(only=True)) == (
        "Your node has a subscription on /other, which is not in the task."
    )
    clock = replace(EMPTY, end_points=(*ENDS, replace(ENDS[1], topic="/clock")))
    assert "a publisher on /clock, which is not" in says(lambda: run(clock).must_have_interface(only=True))
    twice = replace(EMPTY, end_points=(*ENDS, ENDS[1]))
    assert says(lambda: run(twice).must_have_interface(only=True)) == "Your node has 2 publishers on /out. Expected 1."


def test_a_name_that_two_robots_share_although_they_have_namespaces_is_said_to_be_absolute() -> None:
    ends = tuple(replace(end, node=f"/{side}/worker") for side in ("left", "right") for end in ENDS)
    programs = tuple(ProgramStart(side, "worker", f"/{side}") for side in ("left", "right"))
    message = says(lambda: run(replace(EMPTY, end_points=ends, programs=programs)).must_have_interface(only=True))
    assert message.startswith("2 programs have a ")
    assert "a name that begins with / is in no namespace. Expected /left/" in message


def test_each_of_several_programs_may_have_one_end_of_a_topic() -> None:
    two = replace(EXERCISE, programs=(ProgramFile("a.py", "worker"), ProgramFile("b.py", "other")))
    both = replace(EMPTY, end_points=(*ENDS, replace(ENDS[1], node="/other")), nodes=("/other", "/worker"))
    run(both, exercise=two).must_be_as_declared()
    twice = replace(both, end_points=(*both.end_points, replace(ENDS[1], node="/other")))
    message = "Your node has 2 publishers on /out. Expected 1."
    assert says(lambda: run(twice, exercise=two).must_be_as_declared()) == message


def test_a_program_must_be_as_exercise_toml_declares_it() -> None:
    run(EMPTY).must_be_as_declared()
    assert "There is no node /worker" in says(lambda: run(replace(EMPTY, nodes=("/other",))).must_be_as_declared())
    best_effort = replace(EMPTY, end_points=(*ENDS[:1], replace(ENDS[1], reliability="best_effort"), *ENDS[2:]))
    assert "Expected reliable and volatile" in says(lambda: run(best_effort).must_be_as_declared())
    short = replace(EMPTY, end_points=(*ENDS[:1], replace(ENDS[1], depth=1), *ENDS[2:]))
    assert "Expected a depth of 10, got 1" in says(lambda: run(short).must_be_as_declared())
    without = replace(EMPTY, end_points=ENDS[1:])
    assert "does not subscribe to /in" in says(lambda: run(without).must_be_as_declared())


def test_qos() -> None:
    latched = Topic("/out", "std_msgs/msg/Float64", "publish", durability="transient_local")
    exercise = replace(EXERCISE, topics=(latched,))
    assert says(run(EMPTY, exercise=exercise).must_have_qos) == (
        "Your publisher on /out is reliable and volatile. Expected reliable and transient_local. "
        "A late subscriber gets nothing that it published before."
    )
    eager = replace(EMPTY, end_points=(replace(ENDS[0], durability="transient_local"),))
    assert says(run(eager).must_have_qos).endswith(
        "A transient local subscription gets nothing from a volatile publisher."
    )


def test_nodes() -> None:
    two = replace(EMPTY, nodes=("/helper", "/worker"))
    assert says(run(two).must_have_nodes) == (
        "Your program creates other nodes, too. Expected /worker, got /helper, /worker."
    )
    assert says(run(replace(EMPTY, nodes=("/work",))).must_have_nodes) == (
        "There is no node /worker. Expected /worker, got /work."
    )
    several = replace(EXERCISE, programs=(ProgramFile("a.py", "worker"), ProgramFile("b.py", "helper")))
    run(two, exercise=several).must_have_nodes()
    ended = replace(EMPTY, nodes=("/right",), ending=Ending("completed", survived="gauge-1 ended: ValueError: no."))
    launched = replace(EXERCISE, nodes=("/left", "/right"))
    assert says(run(ended, exercise=launched).must_have_nodes).endswith("got /right. gauge-1 ended: ValueError: no.")


def test_ends() -> None:
    slow = replace(EMPTY, ending=Ending("completed", interrupted=True, ended_in_time=False))
    assert "still running 2 s after Ctrl-C" in says(run(slow).must_end_on_ctrl_c)
    loud = replace(EMPTY, ending=Ending("completed", interrupted=True, traceback="RCLError: no"))
    assert says(run(loud).must_end_on_ctrl_c) == "After Ctrl-C your program printed a traceback: RCLError: no"
    with pytest.raises(ValueError, match="sends no Ctrl-C"):
        run(EMPTY).must_end_on_ctrl_c()
    ended = replace(
        EMPTY, exits=(ProgramExit(ns(2), "a.py", signal=9, by="grader"), ProgramExit(ns(3), "b.py", code=1))
    )
    run(ended).must_survive("a.py")
    assert (
        says(run(ended).must_survive) == "At 3.00 s (as usual): b.py ended by itself, with code 1, but must continue."
    )
