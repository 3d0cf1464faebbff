"""Conditions of actions, and substitutions that say true or false."""

from __future__ import annotations

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


class IfCondition:
    """Holds when a text is `true` or `1`."""

    holds_for = True

    def __init__(self, predicate_expression: Text) -> None:
        self.expression = predicate_expression

    def holds(self, context: Context) -> bool:
        """Return whether it holds. Raises `CommandError` for a text that is neither true nor false."""
        return truth_of(self.expression, context) is self.holds_for

    evaluate = holds


class UnlessCondition(IfCondition):
    """Holds when a text is `false` or `0`."""

    holds_for = False


class LaunchConfigurationEquals(IfCondition):
    """Holds when an argument has this value."""

    def __init__(self, launch_configuration_name: str, expected_value: Text) -> None:
        super().__init__(EqualsSubstitution(_ArgumentOrNothing(launch_configuration_name), expected_value))


class LaunchConfigurationNotEquals(LaunchConfigurationEquals):
    """Holds when an argument has another value, or none."""

    holds_for = False


class _ArgumentOrNothing(Substitution):
    def __init__(self, name: str) -> None:
        self.name = name

    def perform(self, context: Context) -> str:
        return context.values.get(self.name, "")


def _said(value: bool) -> str:
    return "true" if value else "false"


class EqualsSubstitution(Substitution):
    """`true` if two texts are the same, or mean the same truth or number."""

    def __init__(self, left: Text, right: Text) -> None:
        self.left, self.right = left, right

    def perform(self, context: Context) -> str:
        """Return `true` or `false`."""
        left, right = text_of(self.left, context), text_of(self.right, context)
        return _said(left == right or _meaning(left) == _meaning(right))


def _meaning(text: str) -> object:
    lower = text.strip().lower()
    if lower in ("true", "false"):
        return lower
    try:
        return float(lower)
    except ValueError:
        return text


class NotEqualsSubstitution(EqualsSubstitution):
    """`true` if two texts differ."""

    def perform(self, context: Context) -> str:
        """Return `true` or `false`."""
        return _said(super().perform(context) == "false")


class NotSubstitution(Substitution):
    """The opposite of a truth."""

    def __init__(self, value: Text) -> None:
        self.value = value

    def perform(self, context: Context) -> str:
        """Return `true` or `false`."""
        return _said(not truth_of(self.value, context))


class AllSubstitution(Substitution):
    """`true` if all of its values are."""

    test: Callable[..., bool] = all

    def __init__(self, *values: Text) -> None:
        self.values = values

    def perform(self, context: Context) -> str:
        """Return `true` or `false`."""
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
        """Return the text for which the condition decides."""
        return text_of(self.if_value if truth_of(self.condition, context) else self.else_value, context)
