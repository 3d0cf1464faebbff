"""The definitions that come with this package: example_interfaces and turtlesim, and optional ones."""

from __future__ import annotations

import functools
from pathlib import Path

from interface_compiler.definition import Definition, read_folder

_FOLDER = Path(__file__).with_name("definitions")


@functools.cache
def standard() -> tuple[str, ...]:
    """Return the packages that every installation has."""
    return _packages("standard")


@functools.cache
def optional() -> tuple[str, ...]:
    """Return the packages that are compiled on request."""
    return _packages("optional")


def how_to_add(package: str) -> str | None:
    """Return how to get one of these packages where it is not installed; None for any other package."""
    if package in (*standard(), *optional()):
        return f"Compile it, once: python -m interface_compiler add {package}"
    return None


def definitions(package: str) -> list[Definition]:
    """Return the definitions of one of these packages. Raises KeyError for any other."""
    for group in ("standard", "optional"):
        if package in _packages(group):
            return [item for item in read_folder(_FOLDER / group)[0] if item.package == package]
    raise KeyError(package)


def _packages(group: str) -> tuple[str, ...]:
    return tuple(sorted(folder.name for folder in (_FOLDER / group).glob("*") if folder.is_dir()))
