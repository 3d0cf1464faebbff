"""Types by rosidl_parser's descriptions."""

from __future__ import annotations

import importlib
from typing import Any


def import_message_from_namespaced_type(message_type: Any) -> Any:
    """Return the class of a type. Raises ModuleNotFoundError or AttributeError if it is not installed."""
    module = importlib.import_module(".".join(message_type.namespaces))
    action, is_feedback, _ = message_type.name.partition("_FeedbackMessage")
    found = getattr(module, action)
    return found.Impl.FeedbackMessage if is_feedback else found
