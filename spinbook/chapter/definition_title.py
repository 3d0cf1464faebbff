"""Titles of fences that define a message, a service or an action, such as `msg/JointLimits.msg`."""

from __future__ import annotations

import re

from interface_compiler import prefixes, shipped, store

_TITLE = re.compile(r"(?:(?P<package>\w+)/)?(?P<kind>msg|srv|action)/(?P<name>[\w-]+)\.(?P=kind)")


def interface_path(title: str, package: str) -> str | None:
    """The path `PACKAGE/msg/NAME.msg` that a title stands for, or None where it is something else's.

    `package` is the one of a title that names none.

    >>> interface_path("msg/JointLimits.msg", "my_robot_interfaces")
    'my_robot_interfaces/msg/JointLimits.msg'
    """
    match = _TITLE.fullmatch(title)
    if match is None:
        return None
    return f"{match['package'] or package}/{match['kind']}/{match['name']}.{match['kind']}"


def is_someone_elses(package: str, own: str) -> bool:
    """Whether a package is installed and no course's: a chapter only shows what is in it. `own` is this course's."""
    if package == own:
        return False
    if package in (*shipped.standard(), *shipped.optional()):
        return True
    prefix = prefixes.prefix_of(package, prefixes.installed())
    return prefix is not None and not store.key_of(package, prefix)
