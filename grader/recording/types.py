"""The Python classes of messages, services and actions, and the services that every node has."""

from __future__ import annotations

import importlib
from functools import cache
from typing import Any

#: Services that every rclpy node has by default, below its own name.
OWN_SERVICES = (
    "describe_parameters",
    "get_parameter_types",
    "get_parameters",
    "list_parameters",
    "set_parameters",
    "set_parameters_atomically",
    "get_type_description",
)


@cache
def message_class(type_name: str) -> Any:
    """Return the Python class of `package/msg/Name`. Raises ImportError or AttributeError if there is none."""
    package, kind, name = type_name.split("/")
    return getattr(importlib.import_module(f"{package}.{kind}"), name)
