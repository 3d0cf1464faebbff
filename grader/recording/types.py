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
#: The service of a node with a life cycle that changes its state, and the transitions that it may be asked for:
#: https://design.ros2.org/articles/node_lifecycle.html
CHANGE_STATE = "change_state"
TRANSITIONS = ("configure", "activate", "deactivate", "cleanup", "shutdown")


@cache
def message_class(type_name: str) -> Any:
    """Return the Python class of `package/msg/Name`. Raises ImportError or AttributeError if there is none."""
    package, kind, name = type_name.split("/")
    return getattr(importlib.import_module(f"{package}.{kind}"), name)
