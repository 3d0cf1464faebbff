"""Tells the interfaces that an installation brings along from those that a course defines."""

from __future__ import annotations

from interface_compiler import prefixes, shipped


def is_someone_elses(package: str, own: str) -> bool:
    """Return whether a package is installed and does not belong to a course: a chapter only shows its interfaces. `own`
    is this course's package."""
    if package == own:
        return False
    if package in (*shipped.standard(), *shipped.optional()):
        return True
    prefix = prefixes.prefix_of(package, prefixes.installed())
    return prefix is not None and not prefixes.key_of(package, prefix)
