"""Types by their names, such as `std_msgs/msg/String`."""

from __future__ import annotations

from typing import Any

from rosidl_parser.definition import NamespacedType

from rosidl_runtime_py.import_message import import_message_from_namespaced_type


def get_interface(identifier: str) -> Any:
    """Return the class of a message, service or action by its full name."""
    return import_message_from_namespaced_type(get_namespaced_type(identifier))


def get_message(identifier: str) -> Any:
    """Return the class of a message. Raises ValueError if it is none."""
    return _checked(get_message_namespaced_type(identifier), is_message, "a message")


def get_service(identifier: str) -> Any:
    """Return the class of a service. Raises ValueError if it is none."""
    return _checked(get_service_namespaced_type(identifier), is_service, "a service")


def get_action(identifier: str) -> Any:
    """Return the class of an action. Raises ValueError if it is none."""
    return _checked(get_action_namespaced_type(identifier), is_action, "an action")


def get_namespaced_type(identifier: str) -> NamespacedType:
    """Return rosidl_parser's description of a full name."""
    return _namespaced(identifier, "")


def get_message_namespaced_type(identifier: str) -> NamespacedType:
    """Return the description of a message's name, in which `msg` may be missing."""
    return _namespaced(identifier, "msg")


def get_service_namespaced_type(identifier: str) -> NamespacedType:
    """Return the description of a service's name, in which `srv` may be missing."""
    return _namespaced(identifier, "srv")


def get_action_namespaced_type(identifier: str) -> NamespacedType:
    """Return the description of an action's name, in which `action` may be missing."""
    return _namespaced(identifier, "action")


def is_message(interface: Any) -> bool:
    """Return whether a class is a message's."""
    return hasattr(interface, "SLOT_TYPES")


def is_service(interface: Any) -> bool:
    """Return whether a class is a service's."""
    return hasattr(interface, "Request") and hasattr(interface, "Response")


def is_action(interface: Any) -> bool:
    """Return whether a class is an action's."""
    return all(hasattr(interface, name) for name in ("Goal", "Result", "Feedback"))


def _namespaced(identifier: str, kind: str) -> NamespacedType:
    *namespaces, name = identifier.split("/")
    return NamespacedType([*namespaces, kind] if kind and len(namespaces) == 1 else namespaces, name)


def _checked(described: NamespacedType, test: Any, kind: str) -> Any:
    interface = import_message_from_namespaced_type(described)
    if not test(interface):
        raise ValueError(f"Expected the full name of {kind}, got '{'/'.join(described.namespaced_name())}'")
    return interface
