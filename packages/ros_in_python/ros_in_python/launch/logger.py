"""What functions of a launch file use beside actions: `launch.logging.get_logger`, `perform_substitutions`."""

from __future__ import annotations

import logging
import sys
from collections.abc import Callable
from typing import TypeVar

from ros_in_python.launch.substitutions import Context, Substitution, Text, TextSubstitution, text_of

_Kind = TypeVar("_Kind", bound=type)


def get_logger(name: str = "launch") -> logging.Logger:
    """Return a logger whose lines look as those of the launch itself."""
    logger = logging.getLogger(f"launch file.{name}")
    if not logger.handlers:
        handler = logging.StreamHandler(sys.stdout)
        handler.setFormatter(logging.Formatter(f"[%(levelname)s] [{name}]: %(message)s"))
        logger.addHandler(handler)
        logger.setLevel(logging.INFO)
        logger.propagate = False
    return logger


def perform_substitutions(context: Context, substitutions: Text) -> str:
    """Return the text of substitutions in a row."""
    return text_of(substitutions, context)


def normalize_to_list_of_substitutions(substitutions: Text) -> list[Substitution]:
    """Return substitutions in a row; each plain text becomes one."""
    if isinstance(substitutions, list | tuple):
        return [part for item in substitutions for part in normalize_to_list_of_substitutions(item)]
    is_one = isinstance(substitutions, Substitution)
    return [substitutions if is_one else TextSubstitution(text=str(substitutions))]


def expose_action(name: str) -> Callable[[_Kind], _Kind]:
    """Return a decorator that changes nothing: an element of one's own is refused in XML and YAML."""
    return lambda kind: kind


expose_substitution = expose_action
