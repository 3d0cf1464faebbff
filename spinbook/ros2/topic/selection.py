"""Choosing of what arrives: a field of each message, and only messages for which an expression holds."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from typing import Any, TypeVar

import click

from spinbook.ros2.refusal import Refusal

F = TypeVar("F", bound=Callable[..., Any])

#: Whether a message is wanted.
Filter = Callable[[Any], bool]


def _compile(context: click.Context, parameter: click.Parameter, text: str | None) -> Filter | None:
    if text is None:
        return None
    try:
        code = compile(text, "--filter", "eval")
    except (SyntaxError, ValueError) as error:
        raise Refusal(f"--filter {text!r} is no Python expression: {error}", "As in: --filter 'm.data > 3'") from None

    def wanted(message: Any) -> bool:
        try:
            # The person at the terminal wrote it, for their own process.
            return bool(eval(code, {"m": message}))
        except Exception as error:
            raise Refusal(f"--filter {text!r} failed: {error}", "The message is called m.") from None

    return wanted


filter_option: Callable[[F], F] = click.option(
    "--filter",
    "filter_expression",
    callback=_compile,
    metavar="EXPR",
    help="Only messages for which this Python expression holds; the message is m.",
)


def field_path(text: str | None) -> list[str]:
    """`--field pose.position` as a list. Raises `Refusal` for one that names nothing."""
    if text is None:
        return []
    path = [part for part in text.split(".") if part]
    if not path:
        raise Refusal(f"Invalid field value '{text}'", "Expected names with dots between, as in header.stamp")
    return path


def check_path(message: Any, path: Sequence[str]) -> None:
    """Raise `Refusal` where a message class has no such field, with the fields it has."""
    from spinbook.ros2.message_fields import field_names, type_name
    from spinbook.ros2.message_text import is_message

    value = message()
    for part in path:
        names = field_names(value) if is_message(value) else "none"
        if not is_message(value) or part not in value.get_fields_and_field_types():
            owner = type_name(value) if is_message(value) else type(value).__name__
            raise Refusal(
                f"Invalid field '{'.'.join(path)}': '{type(value).__name__}' object has no attribute '{part}'",
                f"Fields of {owner}: {names}.",
            )
        value = getattr(value, part)


def field(message: Any, path: Sequence[str]) -> Any:
    """The field of a message that `path` leads to."""
    for part in path:
        message = getattr(message, part)
    return message
