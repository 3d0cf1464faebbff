"""The types that are installed."""

from __future__ import annotations

import os
from collections.abc import Iterable

from interface_compiler import prefixes
from ros_in_python.ros2.interfaces import folder_of, installed_interfaces


def get_interface_packages() -> dict[str, str]:
    """Return the packages that have types, each with the folder in which it is installed."""
    found = {package: prefixes.prefix_of(package, prefixes.installed()) for package in installed_interfaces()}
    return {package: os.fspath(prefix) for package, prefix in found.items() if prefix}


def get_interfaces(package_names: Iterable[str] = ()) -> dict[str, list[str]]:
    """Return package -> its types as `msg/String`, of all packages or of these. Raises LookupError."""
    return _of_kind("", package_names)


def get_message_interfaces(package_names: Iterable[str] = ()) -> dict[str, list[str]]:
    """Return package -> its messages as `msg/String`. Raises LookupError."""
    return _of_kind("msg/", package_names)


def get_service_interfaces(package_names: Iterable[str] = ()) -> dict[str, list[str]]:
    """Return package -> its services as `srv/Trigger`. Raises LookupError."""
    return _of_kind("srv/", package_names)


def get_action_interfaces(package_names: Iterable[str] = ()) -> dict[str, list[str]]:
    """Return package -> its actions as `action/Fibonacci`. Raises LookupError."""
    return _of_kind("action/", package_names)


def get_interface_path(interface_name: str) -> str:
    """Return the path of a type's file: `std_msgs/msg/String`. Raises ValueError or LookupError."""
    package, slash, rest = interface_name.partition("/")
    if not slash or not rest:
        raise ValueError(f"Invalid name '{interface_name}'. Expected at least two parts separated by '/'")
    if package not in installed_interfaces():
        raise LookupError(f"Unknown package '{package}'")
    file = folder_of(package) / (rest if "." in rest else f"{rest}.{rest.partition('/')[0]}")
    if not file.is_file():
        raise LookupError(f"Could not find the interface '{file}'")
    return os.fspath(file)


def _of_kind(start: str, packages: Iterable[str]) -> dict[str, list[str]]:
    everything = installed_interfaces()
    chosen = list(packages) or list(everything)
    if unknown := [package for package in chosen if prefixes.prefix_of(package, prefixes.installed()) is None]:
        raise LookupError(f"Unknown package '{unknown[0]}'")
    named = {package: [name for name in everything.get(package, ()) if name.startswith(start)] for package in chosen}
    return {package: names for package, names in named.items() if names}
