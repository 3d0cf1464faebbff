"""Conditions of actions, and substitutions that say true or false."""

from __future__ import annotations

import math
from collections.abc import Callable

from ros_in_python.launch.substitutions import Context, Substitution, Text, text_of
from ros_in_python.ros2.cli import CommandError

_TRUTH = {"true": True, "1": True, "false": False, "0": False}


def truth_of(value: Text, context: Context) -> bool:
    """Return what a text says: true, 1, false or 0, in any case. Raises `CommandError` for any other."""
    text = text_of(value, context).strip()
    if text.lower() not in _TRUTH:
        raise CommandError(f"a condition must be true, false, 1 or 0, and not '{text}'")
    return _TRUTH[text.lower()]


class Condition:
    """Holds when a function of the context returns true."""

    def __init__(self, *, predicate: Callable[[Context], bool]) -> None:
        self._predicate = predicate

    def evaluate(self, context: Context) -> bool:
        """Return whether it holds."""
        return self._predicate(context)


class IfCondition(Condition):
    """Holds when a text is `true` or `1`, which raises `CommandError` if it is neither true nor false."""

    holds_for = True

    def __init__(self, predicate_expression: Text) -> None:
        super().__init__(predicate=lambda context: truth_of(predicate_expression, context) is self.holds_for)


class UnlessCondition(IfCondition):
    """Holds when a text is `false` or `0`."""

    holds_for = False


class LaunchConfigurationEquals(IfCondition):
    """Holds when an argument has exactly this value, or for None when there is no such argument."""

    def __init__(self, launch_configuration_name: str, expected_value: Text | None) -> None:
        super().__init__(_IsValue(launch_configuration_name, expected_value))


class LaunchConfigurationNotEquals(LaunchConfigurationEquals):
    """Holds when an argument has another value, or none."""

    holds_for = False


class _IsValue(Substitution):
    def __init__(self, name: str, expected: Text | None) -> None:
        self.name, self.expected = name, expected

    def perform(self, context: Context) -> str:
        expected = None if self.expected is None else text_of(self.expected, context)
        return _said(context.value_of(self.name) == expected)


def _said(value: bool) -> str:
    return "true" if value else "false"


class EqualsSubstitution(Substitution):
    """`true` if two texts are the same, or mean the same truth or number."""

    def __init__(self, left: Text | None, right: Text | None) -> None:
        self.left, self.right = ("" if value is None else value for value in (left, right))

    def perform(self, context: Context) -> str:
        left, right = text_of(self.left, context), text_of(self.right, context)
        truths = [_TRUTH.get(text.lower()) for text in (left, right)]
        if None not in truths:
            return _said(truths[0] is truths[1])
        try:
            return _said(math.isclose(float(left), float(right)))
        except ValueError:
            return _said(left == right)


class NotEqualsSubstitution(EqualsSubstitution):
    """`true` if two texts differ."""

    def perform(self, context: Context) -> str:
        return _said(super().perform(context) == "false")


class NotSubstitution(Substitution):
    """The opposite of a truth."""

    def __init__(self, value: Text) -> None:
        self.value = value

    def perform(self, context: Context) -> str:
        return _said(not truth_of(self.value, context))


class AllSubstitution(Substitution):
    """`true` if all of its values are."""

    test: Callable[..., bool] = all

    def __init__(self, *values: Text) -> None:
        self.values = values

    def perform(self, context: Context) -> str:
        return _said(type(self).test(truth_of(value, context) for value in self.values))


class AnySubstitution(AllSubstitution):
    """`true` if one of its values is."""

    test = any


class AndSubstitution(AllSubstitution):
    """`true` if both values are."""

    def __init__(self, left: Text, right: Text) -> None:
        super().__init__(left, right)


class OrSubstitution(AnySubstitution):
    """`true` if one of both values is."""

    def __init__(self, left: Text, right: Text) -> None:
        super().__init__(left, right)


class IfElseSubstitution(Substitution):
    """One of two texts, by a condition."""

    def __init__(self, condition: Text, if_value: Text = "", else_value: Text = "") -> None:
        self.condition, self.if_value, self.else_value = condition, if_value, else_value

    def perform(self, context: Context) -> str:
        return text_of(self.if_value if truth_of(self.condition, context) else self.else_value, context)
