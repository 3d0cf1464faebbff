"""Names of topics, services, nodes and namespaces: what is valid, and how they expand.

The rules, their order and their messages are those of rcl and rmw: rcl/validate_topic_name.h,
rmw/validate_full_topic_name.h, rmw/validate_namespace.h, rmw/validate_node_name.h and
https://design.ros2.org/articles/topic_and_service_names.html.
"""

from __future__ import annotations

import re
from typing import TypeAlias

from rcl_python.values import at

Fault: TypeAlias = "tuple[str, int] | None"
"""What is wrong and the index of the character, or None."""

NAME_LIMIT = 255
_TOPIC_LIMIT = 247
_NAMESPACE_LIMIT = 245
"""DDS allows 255 characters, of which rmw uses some for its own prefix and the name of a node."""


def topic_fault(name: str) -> Fault:
    """Check a topic's name as written in a program, which may be relative and contain substitutions."""
    if not name:
        return "topic name must not be empty string", 0
    if name[0].isdigit() and name[0].isascii():
        return "topic name token must not start with a number", 0
    if name.endswith("/"):
        return "topic name must not end with a forward slash", len(name) - 1
    fault = _braces_fault(name)
    if fault:
        return fault
    # As in rcl, which checks longer names only.
    if len(name) > 2 and name.startswith("~") and name[1] != "/":
        return "topic name must not have a tilde '~' that is not followed by a forward slash '/'", 1
    return _token_fault(name, "topic name token must not start with a number")


def _braces_fault(name: str) -> Fault:
    opened = -1
    for index, char in enumerate(name):
        fault = _char_fault(name, index, char, opened)
        if fault:
            return fault
        opened = index if char == "{" else -1 if char == "}" else opened
    return ("topic name must not have unmatched (unbalanced) curly braces '{}'", opened) if opened >= 0 else None


def _char_fault(name: str, index: int, char: str, opened: int) -> Fault:
    if re.match(r"[A-Za-z0-9_]", char):
        if opened >= 0 and opened == index - 1 and char.isdigit():
            return "substitution name must not start with a number", index
        return None
    if opened >= 0 and char != "}":
        return "substitution name must not contain characters other than alphanumerics or '_'", index
    if char == "}" and opened < 0:
        return "topic name must not have unmatched (unbalanced) curly braces '{}'", index
    if char == "~" and index:
        return "topic name must not have tilde '~' unless it is the first character", index
    if char not in "/~{}":
        return "topic name must not contain characters other than alphanumerics, '_', '~', '{', or '}'", index
    return None


def _token_fault(name: str, text: str) -> Fault:
    digit = re.search(r"/[0-9]", name)
    return (text, digit.start() + 1) if digit else None


def full_topic_fault(name: str) -> Fault:
    """Check a topic's name as it goes over the wire."""
    if not name:
        return "topic name must not be empty", 0
    if not name.startswith("/"):
        return "topic name must be absolute, it must lead with a '/'", 0
    if name.endswith("/"):
        return "topic name must not end with a '/'", len(name) - 1
    too_long = ("topic length should not exceed '255U - 8U'", _TOPIC_LIMIT - 1) if len(name) > _TOPIC_LIMIT else None
    return _absolute_fault(name, "topic name") or too_long


def namespace_fault(name: str) -> Fault:
    """Check the namespace of a node."""
    if name == "/":
        return None
    if name.startswith("/") and name.endswith("/"):
        return "namespace must not end with a '/', unless only a '/'", len(name) - 1
    if not name:
        return "namespace must not be empty", 0
    if not name.startswith("/"):
        return "namespace must be absolute, it must lead with a '/'", 0
    text = "namespace should not exceed 'RMW_NAMESPACE_MAX_NAME_LENGTH'"
    return _absolute_fault(name, "namespace") or (
        (text, _NAMESPACE_LIMIT - 1) if len(name) > _NAMESPACE_LIMIT else None
    )


def _absolute_fault(name: str, what: str) -> Fault:
    bad = re.search(r"[^A-Za-z0-9_/]", name)
    if bad:
        return f"{what} must not contain characters other than alphanumerics, '_', or '/'", bad.start()
    if "//" in name:
        return f"{what} must not contain repeated '/'", name.index("//") + 1
    return _token_fault(name, f"{what} must not have a token that starts with a number")


def node_name_fault(name: str) -> Fault:
    """Check the name of a node."""
    if not name:
        return "node name must not be empty", 0
    bad = re.search(r"[^A-Za-z0-9_]", name)
    if bad:
        return "node name must not contain characters other than alphanumerics or '_'", bad.start()
    if name[0].isdigit():
        return "node name must not start with a number", 0
    if len(name) > NAME_LIMIT:
        return f"node name length should not exceed '{NAME_LIMIT}'", NAME_LIMIT - 1
    return None


def expand(topic: str, node: str, namespace: str) -> str:
    """Return the absolute name of a topic as `node` in `namespace` names it. Raises ValueError for an invalid name."""
    _refuse(topic_fault(topic), f"topic name '{topic}'", 73)
    _refuse(node_name_fault(node), f"node name '{node}'", 84)
    _refuse(namespace_fault(namespace), f"node namespace '{namespace}'", 94)
    prefix = namespace if namespace != "/" else ""
    absolute = topic
    if topic.startswith("~"):
        absolute = f"{prefix}/{node}{topic[1:]}"
    absolute = re.sub(r"\{(\w+)\}", lambda found: _substitution(found[1], topic, node, namespace), absolute)
    return absolute if absolute.startswith("/") else f"{prefix}/{absolute}"


def _substitution(name: str, topic: str, node: str, namespace: str) -> str:
    values = {"node": node, "ns": namespace, "namespace": namespace}
    if name not in values:
        text = at(f"unknown substitution: {{{name}}}", "rcl/expand_topic_name.c:163")
        raise ValueError(f"topic name '{topic}' is invalid: {text}")
    return values[name]


def _refuse(fault: Fault, what: str, line: int) -> None:
    if fault:
        raise ValueError(f"{what} is invalid: {at(fault[0], f'rcl/expand_topic_name.c:{line}')}")
