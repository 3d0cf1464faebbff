"""Reads YAML and XML launch files: two spellings of the same elements (`arg`, `node`, `param`, `remap`, `group` …)."""

from __future__ import annotations

import re
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import yaml

from ros_in_python.launch import actions as known
from ros_in_python.launch.actions import LaunchDescription
from ros_in_python.launch.conditions import IfCondition, UnlessCondition
from ros_in_python.launch.markup_text import parse
from ros_in_python.launch.parameters import ParameterFile
from ros_in_python.launch.substitutions import TextSubstitution
from ros_in_python.ros2.cli import CommandError

_IF = {"if", "unless"}
_PROGRAM = {"name", "cwd", "output", "respawn", "respawn_delay", "launch-prefix", "launch_prefix", *_IF}
#: Attributes that each element may have.
_ATTRIBUTES = {
    "append_env": {"name", "value", "prepend", "separator", *_IF},
    "arg": {"name", "default", "description", *_IF},
    "env": {"name", "value"},
    "executable": {"cmd", "shell", "emulate_tty", *_PROGRAM},
    "group": {"scoped", *_IF},
    "include": {"file", *_IF},
    "let": {"name", "value", *_IF},
    "log": {"message", "level", *_IF},
    "node": {"pkg", "exec", "exec_name", "namespace", "ns", "args", "ros_args", "emulate_tty", *_PROGRAM},
    "param": {"name", "value", "from", "type", "sep", "allow_substs"},
    "push_ros_namespace": {"namespace", *_IF},
    "remap": {"from", "to"},
    "set_env": {"name", "value", *_IF},
    "set_parameter": {"name", "value", *_IF},
    "set_remap": {"from", "to", *_IF},
    "shutdown": {"reason", *_IF},
    "timer": {"period", *_IF},
    "unset_env": {"name", *_IF},
}
_ATTRIBUTES["lifecycle_node"] = _ATTRIBUTES["node"]
#: Other spellings of elements.
_SPELLINGS = {"push-ros-namespace": "push_ros_namespace", "set-parameter": "set_parameter"}
#: Elements that stand within others alone.
_INNER = {"env", "param", "remap"}


@dataclass
class Element:
    """One element: what it is called, its attributes, and the elements in it."""

    kind: str
    attributes: dict[str, Any] = field(default_factory=dict)
    children: list[Element] = field(default_factory=list)


def read(file: Path) -> LaunchDescription:
    """Return what a YAML or XML launch file describes. Raises `CommandError` with what is wrong and where."""
    try:
        text = file.read_text(encoding="utf-8")
        elements = list(_from_xml(text) if file.suffix == ".xml" else _from_yaml(text))
        return LaunchDescription([_entity(element) for element in elements])
    except (yaml.YAMLError, ElementTree.ParseError) as error:
        raise CommandError(f"{file}: {error}") from None
    except CommandError as refusal:
        raise CommandError(f"{file}: {refusal.message}") from None


def _from_xml(text: str) -> Iterator[Element]:
    root = ElementTree.fromstring(text)
    if root.tag != "launch":
        raise CommandError(f"the outermost element is <{root.tag}>, and should be <launch>.")
    yield from map(_xml_element, root)


def _xml_element(item: ElementTree.Element) -> Element:
    return Element(item.tag, dict(item.attrib), [_xml_element(child) for child in item])


def _from_yaml(text: str) -> Iterator[Element]:
    root = yaml.safe_load(text)
    if not isinstance(root, dict) or not isinstance(root.get("launch"), list):
        raise CommandError("a YAML launch file begins with `launch:`, and below it a list: `- node:` and so on.")
    for item in root["launch"]:
        yield from _yaml_elements(item)


def _yaml_elements(item: Any) -> Iterator[Element]:
    if not isinstance(item, dict):
        raise CommandError(f"`{item}` is not an element. Write `- node:` and its attributes below.")
    for kind, inside in item.items():
        yield _yaml_element(str(kind), inside)


def _yaml_element(kind: str, inside: Any) -> Element:
    if isinstance(inside, list):  # a group's or a timer's elements
        return Element(kind, children=[child for item in inside for child in _yaml_elements(item)])
    if inside is None and kind == "shutdown":
        return Element(kind)
    if not isinstance(inside, dict):
        raise CommandError(f"`{kind}` needs its attributes below it, such as `pkg: humanoid_control`.")
    element = Element(kind)
    for name, value in inside.items():
        if isinstance(value, list) and name == "children":
            element.children += [child for item in value for child in _yaml_elements(item)]
        elif isinstance(value, list) and name in {"param", "remap", "env", "arg", "let"}:
            element.children += [_yaml_element(name, part) for part in value]
        else:
            element.attributes[str(name)] = value
    return element


def _entity(element: Element) -> Any:
    kind = _SPELLINGS.get(element.kind, element.kind)
    _check(element, kind)
    if kind in _INNER:
        raise CommandError(f"`{kind}` stands within a node, not alone.")
    made = _MADE[kind](element)
    made.condition = _condition(element.attributes)
    return made


def _check(element: Element, kind: str) -> None:
    if kind not in _ATTRIBUTES:
        there = ", ".join(known for known in _ATTRIBUTES if known not in _INNER)
        raise CommandError(f"the element `{element.kind}` is not supported here. There is: {there}.")
    unknown = sorted(set(element.attributes) - _ATTRIBUTES[kind])
    if unknown:
        there = ", ".join(sorted(_ATTRIBUTES[kind]))
        raise CommandError(f"`{unknown[0]}` of `{element.kind}` is not supported here. There is: {there}.")


def _needed(element: Element, name: str) -> Any:
    if name not in element.attributes:
        raise CommandError(f"`{element.kind}` has no `{name}`.")
    return element.attributes[name]


def _needed_text(element: Element, name: str) -> Any:
    return _text(_needed(element, name))


def _optional(element: Element, *names: str) -> Any:
    return next((_text(element.attributes[name]) for name in names if name in element.attributes), None)


def _arg(element: Element) -> known.DeclareLaunchArgument:
    description = element.attributes.get("description")
    return known.DeclareLaunchArgument(str(_needed(element, "name")), _optional(element, "default"), description)


def _group(element: Element) -> known.GroupAction:
    scoped = str(element.attributes.get("scoped", "true")).lower() in ("true", "1")
    return known.GroupAction([_entity(child) for child in element.children], scoped=scoped)


def _include(element: Element) -> known.IncludeLaunchDescription:
    pairs = [(_needed_text(child, "name"), _value_of(child)) for child in element.children]
    return known.IncludeLaunchDescription(_needed_text(element, "file"), pairs)


def _value_of(argument: Element) -> Any:
    if argument.kind not in ("arg", "let"):
        raise CommandError(f"`include` holds `let` and `arg`, not `{argument.kind}`.")
    return _needed_text(argument, "value")


def _timer(element: Element) -> known.TimerAction:
    return known.TimerAction(_needed_text(element, "period"), [_entity(child) for child in element.children])


def _executable(element: Element) -> known.ExecuteProcess:
    line = str(_needed(element, "cmd"))
    shell = str(element.attributes.get("shell", "false")).lower() in ("true", "1")
    words = [line] if shell else _split(line)
    return known.ExecuteProcess(cmd=[_text(word) for word in words], shell=shell, **_program(element))


def _split(line: str) -> list[str]:
    """Return the words of a command, keeping `$(…)` together, which may have spaces in it."""
    return re.findall(r"(?:\$\((?:[^()]|\([^()]*\))*\)|\S)+", line)


def _program(element: Element) -> dict[str, Any]:
    """Return what each program may have, under the names of Python."""
    delay = element.attributes.get("respawn_delay")
    return {
        "name": _optional(element, "name"),
        "cwd": _optional(element, "cwd"),
        "prefix": _optional(element, "launch-prefix", "launch_prefix"),
        "respawn": _optional(element, "respawn") or False,
        "respawn_delay": None if delay is None else float(delay),
        "additional_env": {
            str(_needed(child, "name")): _needed_text(child, "value")
            for child in element.children
            if child.kind == "env"
        },
    }


def _node(element: Element) -> known.Node:
    for child in element.children:
        _check(child, child.kind)
    of, kind = element.attributes, known.LifecycleNode if element.kind == "lifecycle_node" else known.Node
    return kind(
        package=_needed_text(element, "pkg"),
        executable=_needed_text(element, "exec"),
        exec_name=_optional(element, "exec_name"),
        namespace=_optional(element, "namespace", "ns"),
        parameters=[_parameter(child) for child in element.children if child.kind == "param"],
        remappings=[
            (_needed_text(child, "from"), _needed_text(child, "to"))
            for child in element.children
            if child.kind == "remap"
        ],
        arguments=[_text(word) for word in _split(str(of.get("args", "")))],
        ros_arguments=[_text(word) for word in _split(str(of.get("ros_args", "")))],
        **_program(element),
    )


def _parameter(element: Element) -> Any:
    if "from" in element.attributes:
        substitutes = str(element.attributes.get("allow_substs", "false")).lower() in ("true", "1")
        return ParameterFile(_text(element.attributes["from"]), allow_substs=substitutes)
    if element.children:
        nested: dict[str, Any] = {}
        for child in element.children:
            nested |= _parameter(child)
        return {str(_needed(element, "name")): nested}
    value = _needed(element, "value")
    # A text is read as YAML, as in ROS 2: XML knows nothing else.
    of_text = TextSubstitution(text=value) if isinstance(value, str) and "$(" not in value else _text(value)
    return {str(_needed(element, "name")): of_text if isinstance(value, str) else value}


def _condition(attributes: Mapping[str, Any]) -> IfCondition | None:
    if "if" in attributes:
        return IfCondition(_text(attributes["if"]))
    return UnlessCondition(_text(attributes["unless"])) if "unless" in attributes else None


def _text(value: Any) -> Any:
    """Return a text with `$(var gain)` and the like as substitutions."""
    if not isinstance(value, str) or "$(" not in value:
        return str(value).lower() if isinstance(value, bool) else str(value)
    return parse(value)


#: How each element becomes an action.
_MADE: dict[str, Callable[[Element], Any]] = {
    "arg": _arg,
    "append_env": lambda of: known.AppendEnvironmentVariable(
        _needed_text(of, "name"),
        _needed_text(of, "value"),
        _optional(of, "prepend") or False,
        _optional(of, "separator") or ":",
    ),
    "executable": _executable,
    "group": _group,
    "include": _include,
    "let": lambda of: known.SetLaunchConfiguration(_needed_text(of, "name"), _needed_text(of, "value")),
    "lifecycle_node": _node,
    "log": lambda of: known.LogInfo(_needed_text(of, "message")),
    "node": _node,
    "push_ros_namespace": lambda of: known.PushRosNamespace(_needed_text(of, "namespace")),
    "set_env": lambda of: known.SetEnvironmentVariable(_needed_text(of, "name"), _needed_text(of, "value")),
    "set_parameter": lambda of: known.ParameterForAll(_needed_text(of, "name"), [_needed_text(of, "value")]),
    "set_remap": lambda of: known.SetRemap(_needed_text(of, "from"), _needed_text(of, "to")),
    "shutdown": lambda of: known.Shutdown(_optional(of, "reason") or "reason not given"),
    "timer": _timer,
    "unset_env": lambda of: known.UnsetEnvironmentVariable(_needed_text(of, "name")),
}
