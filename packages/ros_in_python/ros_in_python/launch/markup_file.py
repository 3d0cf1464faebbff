"""Reads YAML and XML launch files: two spellings of the same elements (`arg`, `node`, `param`, `remap`, `group` …)."""

from __future__ import annotations

import re
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import yaml

from ros_in_python.launch import description as known
from ros_in_python.launch.description import LaunchDescription
from ros_in_python.ros2.cli import CommandError

_SUBSTITUTION = re.compile(r"\$\((?P<name>[\w-]+)(?:\s+(?P<word>[^\s()]+))?(?:\s+(?P<more>[^()]*))?\)")
#: Attributes that each element may have.
_ATTRIBUTES = {
    "arg": {"name", "default", "description"},
    "node": {"pkg", "exec", "name", "namespace", "args", "ros_args", "output", "emulate_tty", "if", "unless"},
    "param": {"name", "value", "from"},
    "remap": {"from", "to"},
    "group": {"if", "unless"},
    "push_ros_namespace": {"namespace", "if", "unless"},
    "push-ros-namespace": {"namespace", "if", "unless"},
    "log": {"message", "level", "if", "unless"},
}


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
    if kind == "group":
        return Element(kind, children=[child for item in inside or () for child in _yaml_elements(item)])
    if not isinstance(inside, dict):
        raise CommandError(f"`{kind}` needs its attributes below it, such as `pkg: humanoid_control`.")
    element = Element(kind)
    for name, value in inside.items():
        if isinstance(value, list) and name in {"param", "remap"}:
            element.children += [Element(name, dict(part)) for part in value]
        else:
            element.attributes[str(name)] = value
    return element


def _entity(element: Element) -> Any:
    _check(element)
    of = element.attributes
    if element.kind == "arg":
        default = _text(of["default"]) if "default" in of else None
        return known.DeclareLaunchArgument(str(_needed(element, "name")), default, of.get("description"))
    if element.kind == "node":
        return _node(element)
    if element.kind == "group":
        return known.GroupAction([_entity(child) for child in element.children], _condition(of))
    if element.kind == "log":
        return known.LogInfo(_text(_needed(element, "message")), _condition(of))
    return known.PushRosNamespace(_text(_needed(element, "namespace")), _condition(of))


def _check(element: Element) -> None:
    if element.kind not in _ATTRIBUTES:
        there = ", ".join(kind for kind in _ATTRIBUTES if kind not in {"param", "remap"})
        raise CommandError(f"the element `{element.kind}` is not supported here. There is: {there}.")
    unknown = sorted(set(element.attributes) - _ATTRIBUTES[element.kind])
    if unknown:
        there = ", ".join(sorted(_ATTRIBUTES[element.kind]))
        raise CommandError(f"`{unknown[0]}` of `{element.kind}` is not supported here. There is: {there}.")


def _needed(element: Element, name: str) -> Any:
    if name not in element.attributes:
        raise CommandError(f"`{element.kind}` has no `{name}`.")
    return element.attributes[name]


def _node(element: Element) -> known.Node:
    of = element.attributes
    for child in element.children:
        _check(child)
    return known.Node(
        package=_text(_needed(element, "pkg")),
        executable=_text(_needed(element, "exec")),
        name=_text(of["name"]) if "name" in of else None,
        namespace=_text(of["namespace"]) if "namespace" in of else None,
        parameters=[_parameter(child) for child in element.children if child.kind == "param"],
        remappings=[
            (_text(_needed(child, "from")), _text(_needed(child, "to")))
            for child in element.children
            if child.kind == "remap"
        ],
        arguments=[_text(word) for word in str(of.get("args", "")).split()],
        ros_arguments=[_text(word) for word in str(of.get("ros_args", "")).split()],
        condition=_condition(of),
    )


def _parameter(element: Element) -> Mapping[str, Any] | list[Any]:
    if "from" in element.attributes:
        return [_text(element.attributes["from"])]
    value = _needed(element, "value")
    # A text is read as YAML, as in ROS 2: XML knows nothing else.
    of_text = known.TextSubstitution(text=value) if isinstance(value, str) and "$(" not in value else _text(value)
    return {str(_needed(element, "name")): of_text if isinstance(value, str) else value}


def _condition(attributes: Mapping[str, Any]) -> known.IfCondition | None:
    if "if" in attributes:
        return known.IfCondition(_text(attributes["if"]))
    return known.UnlessCondition(_text(attributes["unless"])) if "unless" in attributes else None


def _text(value: Any) -> Any:
    """Return a text with `$(var gain)` and the like as substitutions."""
    if not isinstance(value, str) or "$(" not in value:
        return str(value).lower() if isinstance(value, bool) else str(value)
    parts: list[Any] = []
    end = 0
    for match in _SUBSTITUTION.finditer(value):
        parts += [value[end : match.start()], _substitution(match)]
        end = match.end()
    return [*parts, value[end:]]


def _substitution(match: re.Match[str]) -> known.Substitution:
    name, word, more = match["name"], match["word"] or "", match["more"]
    if name == "var" and word:
        return known.LaunchConfiguration(word, default=more)
    if name == "find-pkg-share" and word:
        return known.FindPackageShare(word)
    if name == "env" and word:
        return known.EnvironmentVariable(word, default_value=more)
    raise CommandError(
        f"`{match[0]}` is not supported here. There is: $(var NAME), $(find-pkg-share PACKAGE), $(env NAME)."
    )
