"""Messages filled from plain values."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ros_in_python.ros2.cli import CommandError
from ros_in_python.ros2.messages import UnknownFieldError, fill


def set_message_fields(
    msg: Any, values: dict[str, Any], expand_header_auto: bool = False, expand_time_now: bool = False
) -> list[Callable[[Any], None]]:
    """Set a message's fields; fields that are not named stay as they are.

    With `expand_header_auto` or `expand_time_now`, a header that is `auto` and a time that is `now` are left for the
    returned functions, which set them. Raises AttributeError for a field that the message does not have, TypeError if
    `values` is no dictionary, and ValueError for a value that does not fit its field.
    """
    if not isinstance(values, dict):
        raise TypeError(f"Value '{values}' is expected to be a dictionary but is a {type(values).__name__}")
    try:
        return fill(msg, values, stamps=expand_header_auto or expand_time_now)
    except UnknownFieldError as error:
        raise AttributeError(error.message) from None
    except CommandError as error:
        raise ValueError(error.message) from None
