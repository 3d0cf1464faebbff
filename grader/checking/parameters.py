"""Helpers for parameters: which values a node accepts, refuses and returns."""

from __future__ import annotations

from typing import Any

from grader.checking.comparator import TOLERANCE, equal, shown
from grader.checking.recorded import Recorded
from grader.recording.events import ParameterChange, ParameterReading

#: Any value at all.
ANY: Any = object()


def typed(value: Any) -> str:
    """A value in a form that shows its type: the double 2 is shown as `2.0`."""
    return f"{shown(value)}.0" if isinstance(value, float) and value.is_integer() else shown(value)


def kind_of(value: Any) -> str:
    """The type of a parameter's value, in ROS's words."""
    words = {bool: "a bool", int: "an integer", float: "a double", str: "a string"}
    return words.get(type(value), "an array")


class ParameterChecks(Recorded):
    """Parameters that the scenario set and read while the node ran."""

    def must_take(self, name: str, value: Any = ANY) -> None:
        """The node must accept each `value` that the scenario sets for this parameter."""
        for change in self._changes(name, value):
            self._see(change, taken=True)

    def must_refuse(self, name: str, value: Any = ANY) -> None:
        """The node must refuse each `value` that the scenario sets for this parameter, and continue to run."""
        for change in self._changes(name, value):
            self._see(change, taken=False)

    def must_take_and_refuse_as_the_solution(self) -> None:
        """The node must accept each value that the solution accepts, and refuse each one that the solution refuses."""
        for change, reference in zip(self.recording.parameters, self._reference.parameters, strict=False):
            if reference.taken is not None:
                self._see(change, taken=reference.taken)

    def must_have_parameter(self, name: str, value: Any = ANY, tolerance: float = TOLERANCE) -> None:
        """Each time that the scenario reads this parameter, it must have this value; by default the solution's."""
        readings = self._readings(self.recording.readings, name)
        for reading, reference in zip(readings, self._readings(self._reference.readings, name), strict=False):
            wanted = reference.value if value is ANY else value
            if reading.value is None and wanted is not None:
                self._unknown(reading.at, name, reading.answered is not None)
            if type(reading.value) is not type(wanted):
                expected, got = (
                    f"{typed(wanted)}, {kind_of(wanted)}",
                    f"{typed(reading.value)}, {kind_of(reading.value)}",
                )
                self.wrong_at(reading.at, f"expected {expected}, got {got}.", f"parameter {name}", expected, got)
            if not equal(reading.value, wanted, tolerance):
                unit = next((one.unit for one in self.exercise.parameters if one.name == name), "")
                expected, got = shown(wanted, unit), shown(reading.value, unit)
                self.wrong_at(reading.at, f"expected {expected}, got {got}.", f"parameter {name}", expected, got)

    def _changes(self, name: str, value: Any) -> list[ParameterChange]:
        found = [one for one in self.recording.parameters if one.name == name]
        wanted = [one for one in found if value is ANY or (type(one.value) is type(value) and one.value == value)]
        if not wanted:
            text = ", ".join(shown(one.value) for one in found) or "nothing"
            raise ValueError(f"the scenario {self.scenario} sets {name} to {text}, never to {value!r}.")
        return wanted

    def _readings(self, readings: tuple[ParameterReading, ...], name: str) -> list[ParameterReading]:
        found = [one for one in readings if one.name == name]
        if not found:
            raise ValueError(f"the scenario {self.scenario} never asks for the parameter {name}.")
        return found

    def _see(self, change: ParameterChange, taken: bool) -> None:
        if change.taken is None:
            self._unknown(change.at, change.name, answered=False)
        if change.taken == taken:
            return
        if taken and "undeclared" in change.reason:
            self._unknown(change.at, change.name, answered=True)
        wanted, got = ("taken", "refused") if taken else ("refused", "taken")
        text = f"the value {typed(change.value)} must be {wanted}, but your node {'took' if change.taken else got} it."
        text += f" It said: {change.reason.rstrip('.')}." if change.reason and taken else ""
        self.wrong_at(change.at, text, f"parameter {change.name}", wanted, got, self._never_refuses(taken))

    def _never_refuses(self, taken: bool) -> str:
        answers = {one.taken for one in self.recording.parameters}
        if taken and answers == {False}:
            return (
                "Your node refuses every value: an on-set callback has to return SetParametersResult(successful=True)."
            )
        if not taken and answers == {True} and len(self.recording.parameters) > 1:
            return "Your node takes every value. Did you add an on-set callback?"
        return ""

    def _unknown(self, at: int, name: str, answered: bool) -> None:
        if answered:
            text = "your node does not have it. Declare it in __init__, with declare_parameter."
            self.wrong_at(at, text, f"parameter {name}", "a value", "not declared")
        text = "your node did not answer. Does a callback block the node, or does the node have another name?"
        self.wrong_at(at, text, f"parameter {name}", "an answer", "none")
