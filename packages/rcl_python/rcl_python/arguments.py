"""What follows `--ros-args`: remappings, parameters, log levels.

The grammar is that of https://design.ros2.org/articles/ros_command_line_arguments.html, the rules those of
rcl/arguments.h.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from rcl_python.names import expand
from rcl_python.parameters import ParameterError, in_files, value_of
from rcl_python.values import RCLInvalidROSArgsError, UnknownROSArgsError

LEVELS = {"debug": 10, "info": 20, "warn": 30, "error": 40, "fatal": 50}

_VALUE = {
    "-r": "remap rule", "--remap": "remap rule", "-p": "parameter", "--param": "parameter",
    "--params-file": "file path", "--log-level": "log level", "--log-config-file": "log config file path",
    "-e": "enclave path",
    "--enclave": "enclave path", "--log-file-name": "log file name prefix",
}  # fmt: skip
_SWITCHES = ("rosout-logs", "stdout-logs", "external-lib-logs")
_RULE = re.compile(r"(?:(?P<node>[A-Za-z_]\w*):(?!//))?(?P<of>(?:rostopic://|rosservice://)?[^:]+|__\w+):=(?P<to>\S+)$")
_NODE_NAME = re.compile(r"[A-Za-z_]\w*$")


@dataclass(frozen=True)
class Remap:
    """A rule: the new name for `name`, for the node `node` or for all. `only` is "topic", "service" or "" for both."""

    name: str
    to: str
    node: str = ""
    only: str = ""


@dataclass
class Arguments:
    """A program's arguments for ROS. `parameters` are (pattern of the node's name, parameter, value)."""

    remaps: list[Remap] = field(default_factory=list)
    parameters: list[tuple[str, str, Any]] = field(default_factory=list)
    level: int | None = None
    levels: dict[str, int] = field(default_factory=dict)
    enclave: str = "/"
    rosout: bool = True
    stdout: bool = True
    others: list[str] = field(default_factory=list)
    """The arguments that are not for ROS."""
    unknown: list[str] = field(default_factory=list)
    """The arguments that are for ROS, but unknown."""

    def refuse_unknown(self) -> None:
        """Raise UnknownROSArgsError if there are unknown arguments."""
        if self.unknown:
            raise UnknownROSArgsError(repr(self.unknown))


def parse(args: Sequence[str]) -> Arguments:
    """Read a program's arguments. Raises RCLInvalidROSArgsError if they can't be read."""
    found = Arguments()
    rest, ours = list(args), False
    while rest:
        arg = rest.pop(0)
        if arg == "--ros-args" or (ours and arg == "--"):
            ours = arg == "--ros-args"
        elif not ours:
            found.others.append(arg)
        elif arg in _VALUE:
            if not rest or rest[0] in ("--", "--ros-args"):
                raise _invalid(f"Couldn't parse trailing {arg} flag. No {_VALUE[arg]} found.")
            _PARSERS[arg](found, arg, rest.pop(0))
        elif not _switch(found, arg):
            found.unknown.append(arg)
    return found


def _invalid(text: str) -> RCLInvalidROSArgsError:
    return RCLInvalidROSArgsError(f"Failed to parse ROS arguments: {text}")


def _switch(found: Arguments, arg: str) -> bool:
    match = re.match(r"--(enable|disable)-(.+)$", arg)
    if not match or match[2] not in _SWITCHES:
        return False
    if match[2] != "external-lib-logs":
        setattr(found, match[2].removesuffix("-logs"), match[1] == "enable")
    return True


def _remap(found: Arguments, flag: str, text: str) -> None:
    rule = _RULE.match(text)
    special = rule and rule["of"].startswith("__")
    if not rule or (special and not _special_is_valid(rule["of"], rule["to"])):
        raise _invalid(f"Couldn't parse remap rule: '{flag} {text}'. Error: expected name:=name")
    scheme, _, name = rule["of"].rpartition("://")
    only = {"rostopic": "topic", "rosservice": "service"}.get(scheme, "")
    to = rule["to"].rpartition("://")[2]
    found.remaps.append(Remap("__node" if name == "__name" else name, to, rule["node"] or "", only))


def _special_is_valid(name: str, to: str) -> bool:
    if name in ("__node", "__name"):
        return bool(_NODE_NAME.match(to))
    return name == "__ns" and to.startswith("/")


def _parameter(found: Arguments, flag: str, text: str) -> None:
    left, sep, value = text.partition(":=")
    node, _, name = left.rpartition(":")
    if not sep or not name:
        raise _invalid(f"Couldn't parse parameter override rule: '{flag} {text}'. Error: expected name:=value")
    try:
        found.parameters.append((node or "/**", name, value_of(value)))
    except ParameterError as error:
        raise _invalid(f"Couldn't parse parameter override rule: '{flag} {text}'. Error: {error}") from None


def _parameters_file(found: Arguments, flag: str, path: str) -> None:
    try:
        found.parameters += in_files(Path(path).read_text(encoding="utf-8"))
    except OSError:
        raise _invalid(f"Couldn't parse params file: '{flag} {path}'. Error: Error opening YAML file") from None
    except ParameterError as error:
        raise _invalid(f"Couldn't parse params file: '{flag} {path}'. Error: {error}") from None


def _log_level(found: Arguments, flag: str, text: str) -> None:
    logger, _, word = text.rpartition(":=")
    if word.lower() not in LEVELS:
        reason = "Argument does not use a valid severity level"
        raise _invalid(f"Couldn't parse log level: '{flag} {text}'. Error: {reason}")
    if logger:
        found.levels[logger] = LEVELS[word.lower()]
    else:
        found.level = LEVELS[word.lower()]


def _enclave(found: Arguments, flag: str, text: str) -> None:
    found.enclave = text


def _nothing(found: Arguments, flag: str, text: str) -> None:
    """Accept an option that has no effect here."""


_PARSERS: dict[str, Callable[[Arguments, str, str], None]] = {
    "-r": _remap, "--remap": _remap, "-p": _parameter, "--param": _parameter, "--params-file": _parameters_file,
    "--log-level": _log_level, "--log-config-file": _nothing, "--log-file-name": _nothing,
    "-e": _enclave, "--enclave": _enclave,
}  # fmt: skip


def remapped_node(remaps: Sequence[Remap], special: str, name: str) -> str | None:
    """Return the value of `__node` or `__ns` for the node that the program calls `name`; None without a rule."""
    for rule in remaps:
        if rule.name == special and rule.node in ("", name):
            return rule.to
    return None


def remapped(remaps: Sequence[Remap], kind: str, absolute: str, node: str, namespace: str) -> str:
    """Return the name of a topic or a service (`kind`) after the rules: the first that fits wins."""
    for rule in remaps:
        if rule.name.startswith("__") or rule.only not in ("", kind) or rule.node not in ("", node):
            continue
        if expand(rule.name, node, namespace) == absolute:
            return expand(rule.to, node, namespace)
    return absolute


def without_ros_args(args: Sequence[str]) -> list[str]:
    """Return the arguments that are not for ROS. Raises if those for ROS can't be read."""
    found = parse(args)
    found.refuse_unknown()
    return found.others
