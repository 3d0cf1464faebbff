"""Helpers for parameters: which values a node accepts, refuses and returns."""

from __future__ import annotations

from typing import Any

from grader.checking.cause import UNKNOWN, Cause
from grader.checking.comparator import TOLERANCE, equal, shown
from grader.checking.hint_texts import hints
from grader.checking.partial import each
from grader.checking.recorded_run import RecordedRun
from grader.recording.events import ParameterChange, ParameterReading

#: Any value at all.
ANY: Any = object()


def typed(value: Any) -> str:
    """Return a value in a form that shows its type: the double 2 is shown as `2.0`."""
    return f"{shown(value)}.0" if isinstance(value, float) and value.is_integer() else shown(value)


def kind_of(value: Any) -> str:
    """Return the type of a parameter's value, in ROS's words."""
    words = {bool: "a bool", int: "an integer", float: "a double", str: "a string"}
    return words.get(type(value), "an array")


def must_take(run: RecordedRun, name: str, value: Any = ANY) -> None:
    """Check that the node accepts each `value` that the scenario sets for this parameter.

    Example: `run.must_take("gain", 3.0)`
    """
    each(_changes(run, name, value), lambda change: _see(run, change, taken=True))


def must_refuse(run: RecordedRun, name: str, value: Any = ANY) -> None:
    """Check that the node refuses each `value` that the scenario sets for this parameter, and continues to run.

    Example: `run.must_refuse("gain", -1.0)`
    """
    each(_changes(run, name, value), lambda change: _see(run, change, taken=False))


def must_take_and_refuse_as_the_solution(run: RecordedRun) -> None:
    """Check that the node accepts and refuses the same values as the solution.

    Example: `run.must_take_and_refuse_as_the_solution()`
    """
    if not run.reference.parameters:
        raise ValueError(f"the scenario {run.scenario} sets no parameter. Add at(1.0).set_parameter(…) to it.")
    for change, reference in zip(run.recording.parameters, run.reference.parameters, strict=False):
        if reference.taken is not None:
            _see(run, change, taken=reference.taken)


def must_have_parameter(run: RecordedRun, name: str, value: Any = ANY, tolerance: float = TOLERANCE) -> None:
    """Check that this parameter has this value whenever the scenario reads it; by default the solution's value.

    Example: `run.must_have_parameter("gain", 3.0)`
    """
    readings = _readings(run, run.recording.readings, name)
    for reading, reference in zip(readings, _readings(run, run.reference.readings, name), strict=False):
        right_value = reference.value if value is ANY else value
        if reading.value is None and right_value is not None:
            _unknown(run, reading.at, name, reading.answered is not None)
        if type(reading.value) is not type(right_value):
            expected, got = (
                f"{typed(right_value)}, {kind_of(right_value)}",
                f"{typed(reading.value)}, {kind_of(reading.value)}",
            )
            run.wrong_at(reading.at, f"expected {expected}, got {got}.", f"parameter {name}", expected, got)
        if not equal(reading.value, right_value, tolerance):
            unit = next((parameter.unit for parameter in run.exercise.parameters if parameter.name == name), "")
            expected, got = shown(right_value, unit), shown(reading.value, unit)
            run.wrong_at(reading.at, f"expected {expected}, got {got}.", f"parameter {name}", expected, got)


def _changes(run: RecordedRun, name: str, value: Any) -> list[ParameterChange]:
    changes = [change for change in run.recording.parameters if change.name == name]
    matching = [c for c in changes if value is ANY or (type(c.value) is type(value) and c.value == value)]
    if not matching:
        text = ", ".join(shown(change.value) for change in changes)
        never = f"sets {name} to {text}, never to {value!r}" if text else f"never sets the parameter {name}"
        raise ValueError(f"the scenario {run.scenario} {never}.")
    return matching


def _readings(run: RecordedRun, readings: tuple[ParameterReading, ...], name: str) -> list[ParameterReading]:
    of_parameter = [reading for reading in readings if reading.name == name]
    if not of_parameter:
        raise ValueError(f"the scenario {run.scenario} never asks for the parameter {name}.")
    return of_parameter


def _see(run: RecordedRun, change: ParameterChange, taken: bool) -> None:
    if change.taken is None:
        _unknown(run, change.at, change.name, answered=False)
    if change.taken == taken:
        return
    if taken and "undeclared" in change.reason:
        _unknown(run, change.at, change.name, answered=True)
    expected, got = ("taken", "refused") if taken else ("refused", "taken")
    text = f"the value {typed(change.value)} must be {expected}, but your node {'took' if change.taken else got} it."
    text += f" It said: {change.reason.rstrip('.')}." if change.reason and taken else ""
    run.wrong_at(change.at, text, f"parameter {change.name}", expected, got, _why(run, change, taken))


def _why(run: RecordedRun, change: ParameterChange, taken: bool) -> Cause:
    if change.reason == "Callback returned an invalid type":
        text = "Your on-set callback has to return a SetParametersResult, each way through it."
        return Cause(text, *hints("refuses"))
    answers = {change.taken for change in run.recording.parameters}
    if taken and answers == {False}:
        every = "refuses every value" if len(run.recording.parameters) > 1 else "refused the only value"
        return Cause(f"Your node {every} that is set here.", *hints("refuses"))
    if not taken and answers == {True} and len(run.recording.parameters) > 1:
        return Cause("Your node takes every value. Did you add an on-set callback?", *hints("takes"))
    return UNKNOWN


def _unknown(run: RecordedRun, at: float, name: str, answered: bool) -> None:
    if answered:
        text = "your node does not have it. Declare it in __init__, with declare_parameter."
        run.wrong_at(at, text, f"parameter {name}", "a value", "not declared")
    text = "your node did not answer. Does a callback block the node, or does the node have another name?"
    run.wrong_at(at, text, f"parameter {name}", "an answer", "none")
