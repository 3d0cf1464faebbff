"""Reads YAML and XML launch files: two spellings of the same elements (`arg`, `node`, `param`, `remap`, `group` …)."""

from __future__ import annotations

import contextlib
import shlex
from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any
from xml.etree import ElementTree
from xml.parsers import expat

import yaml

from ros_in_python.launch import actions as known
from ros_in_python.launch import changes
from ros_in_python.launch.actions import LaunchDescription
from ros_in_python.launch.conditions import Condition, IfCondition, UnlessCondition
from ros_in_python.launch.markup_text import parse
from ros_in_python.launch.parameters import ParameterFile, ParameterValue
from ros_in_python.launch.substitutions import TextSubstitution
from ros_in_python.ros2.cli import CommandError

_IF = {"if", "unless"}
_PROGRAM = {
    *("name", "cwd", "output", "emulate_tty", "launch-prefix", "launch_prefix", "on_exit"),
    *("respawn", "respawn_delay", "respawn_max_retries", "sigterm_timeout", "sigkill_timeout"),
    *_IF,
}
#: Attributes that each element may have.
_ATTRIBUTES = {
    "append_env": {"name", "value", "prepend", "separator", *_IF},
    "arg": {"name", "default", "description", *_IF},
    "env": {"name", "value"},
    "choice": {"value"},
    "composable_node": {"pkg", "plugin", "name", "namespace", *_IF},
    "executable": {"cmd", "shell", *_PROGRAM},
    "extra_arg": {"name", "value"},
    "group": {"scoped", "forwarding", *_IF},
    "include": {"file", *_IF},
    "keep": {"name", "value"},
    "let": {"name", "value", *_IF},
    "load_composable_node": {"target", *_IF},
    "log": {"message", *_IF},
    "node": {"pkg", "exec", "exec_name", "namespace", "ns", "args", "ros_args", *_PROGRAM},
    "param": {"name", "value", "value-sep", "from", "type", "allow_substs"},
    "push_ros_namespace": {"namespace", *_IF},
    "remap": {"from", "to"},
    "reset": set(_IF),
    "reset_env": set(_IF),
    "ros_timer": {"period", *_IF},
    "set_env": {"name", "value", *_IF},
    "set_parameter": {"name", "value", *_IF},
    "set_parameters_from_file": {"filename", *_IF},
    "set_remap": {"from", "to", *_IF},
    "set_ros_log_dir": {"new_log_dir", *_IF},
    "set_use_sim_time": {"value", *_IF},
    "shutdown": {"reason", *_IF},
    "timer": {"period", "cancel_on_shutdown", *_IF},
    "unset_env": {"name", *_IF},
}
_ATTRIBUTES |= dict.fromkeys(("lifecycle_node", "node_container"), _ATTRIBUTES["node"])
#: Other spellings of elements.
_SPELLINGS = {"push-ros-namespace": "push_ros_namespace", "set-parameter": "set_parameter"}
#: Elements that stand within others alone.
_INNER = {"choice", "composable_node", "env", "extra_arg", "keep", "param", "remap"}
#: The types of a parameter.
_TYPES: dict[str, Any] = {"yaml": None, "bool": bool, "float": float, "int": int, "str": str}
_TYPES |= {"list_of_bool": list[bool], "list_of_float": list[float], "list_of_int": list[int], "list_of_str": list[str]}
_IN_NODE = {"env", "param", "remap"}
#: The elements that an element may contain; those of `_ANY` may contain all but the inner ones.
_CHILDREN = {
    "arg": {"choice"},
    "composable_node": {"extra_arg", "param", "remap"},
    "executable": {"env"},
    "group": {"keep"},
    "include": {"arg", "let"},
    "lifecycle_node": _IN_NODE,
    "load_composable_node": {"composable_node"},
    "node": _IN_NODE,
    "node_container": {"composable_node", *_IN_NODE},
    "param": {"param"},
    "reset": {"keep"},
}
_ANY = {"group", "timer", "ros_timer"}


@dataclass
class Element:
    """One element: what it is called, its attributes, and the elements in it."""

    kind: str
    attributes: dict[str, Any] = field(default_factory=dict)
    children: list[Element] = field(default_factory=list)


def read(file: Path) -> LaunchDescription:
    """Return what a YAML or XML launch file describes. Raises `CommandError` with what is wrong and where."""
    try:
        text = file.read_text(encoding="utf-8-sig")
        elements = list(_from_xml(text) if text.lstrip().startswith("<") else _from_yaml(text))
        return LaunchDescription([_entity(element) for element in elements])
    except UnicodeDecodeError:
        raise known.PlacedError(f"{file}: it is not saved as UTF-8.") from None
    except ElementTree.ParseError as error:
        raise known.PlacedError(f"{file}:{error.position[0]}: {expat.ErrorString(error.code)}.") from None
    except yaml.MarkedYAMLError as error:
        line = f":{error.problem_mark.line + 1}" if error.problem_mark else ""
        raise known.PlacedError(f"{file}{line}: {error.problem or error.context}.") from None
    except yaml.YAMLError as error:
        raise known.PlacedError(f"{file}: {error}") from None
    except CommandError as refusal:
        raise known.PlacedError(f"{file}: {refusal.message}") from None


def _from_xml(text: str) -> Iterator[Element]:
    root = ElementTree.fromstring(text)
    if root.tag != "launch":
        raise CommandError(f"the outermost element is <{root.tag}>, and should be <launch>.")
    yield from map(_xml_element, root)


def _xml_element(item: ElementTree.Element) -> Element:
    attributes: dict[str, Any] = dict(item.attrib)
    if item.tag == "param" and attributes.keys() == {"name", "value"}:
        # As in ROS 2, XML's texts are read as YAML, which YAML's own are not: "1" there is a text.
        attributes["value"] = _read(attributes["value"])
    return Element(item.tag, attributes, [_xml_element(child) for child in item])


def _read(text: str) -> Any:
    with contextlib.suppress(yaml.YAMLError):
        value = yaml.safe_load(text)
        return text if "$(" in text or value is None or isinstance(value, dict) else value
    return text


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
    if inside is None and kind in ("shutdown", "reset", "reset_env"):
        return Element(kind)
    if not isinstance(inside, dict):
        raise CommandError(f"`{kind}` needs its attributes below it, such as `pkg: humanoid_control`.")
    element = Element(kind)
    for name, value in inside.items():
        if isinstance(value, list) and name == "children":
            element.children += [child for item in value for child in _yaml_elements(item)]
        elif isinstance(value, list) and name in {*_INNER, "arg", "let"}:
            element.children += [_yaml_element(name, part) for part in value]
        else:
            element.attributes[str(name)] = value
    return element


def _entity(element: Element) -> Any:
    kind = _SPELLINGS.get(element.kind, element.kind)
    _check(element, kind)
    if kind in _INNER:
        raise CommandError(f"`{kind}` stands within a node, not alone.")
    try:
        made = _MADE[kind](element)
    except ValueError as error:
        raise CommandError(f"`{element.kind}`: {error}.") from None
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
    for child in element.children:
        inner = _CHILDREN.get(kind, set())
        if child.kind not in inner and (kind not in _ANY or child.kind in _INNER):
            raise CommandError(
                f"`{kind}` can't hold `{child.kind}`. It holds: {', '.join(sorted(inner)) or 'nothing'}."
            )


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
    choices = [str(_needed(child, "value")) for child in element.children] or None
    return known.DeclareLaunchArgument(
        str(_needed(element, "name")), _optional(element, "default"), description, choices
    )


def _group(element: Element) -> known.GroupAction:
    return known.GroupAction(
        [_entity(child) for child in element.children if child.kind != "keep"],
        scoped=_yes(element, "scoped", "true"),
        forwarding=_yes(element, "forwarding", "true"),
        launch_configurations=_kept(element),
    )


def _kept(element: Element) -> dict[str, Any]:
    kept = [child for child in element.children if child.kind == "keep"]
    return {str(_needed(child, "name")): _needed_text(child, "value") for child in kept}


def _yes(element: Element, name: str, default: str = "false") -> bool:
    return str(element.attributes.get(name, default)).lower() in ("true", "1")


def _include(element: Element) -> known.IncludeLaunchDescription:
    pairs = [(_needed_text(child, "name"), _needed_text(child, "value")) for child in element.children]
    return known.IncludeLaunchDescription(_needed_text(element, "file"), pairs)


def _timer(element: Element) -> known.TimerAction:
    kind = known.RosTimer if element.kind == "ros_timer" else known.TimerAction
    is_cancelled = _optional(element, "cancel_on_shutdown")
    actions = [_entity(child) for child in element.children]
    return kind(_needed_text(element, "period"), actions, True if is_cancelled is None else is_cancelled)


def _executable(element: Element) -> known.ExecuteProcess:
    words = _split(str(_needed(element, "cmd")))
    return known.ExecuteProcess(cmd=words, shell=_yes(element, "shell"), **_program(element))


def _split(line: str) -> list[Any]:
    """Return the words of a command as a shell has them, without its quotes; `$(…)` may have spaces in it."""
    words: list[list[Any]] = []
    is_open = False
    for part in parse(line) if "$(" in line else [line]:
        if isinstance(part, str):
            try:
                pieces = shlex.split(part)
            except ValueError as error:
                raise CommandError(f"`{line}`: {error}. As in ROS 2, quotes have no `$(…)` in them.") from None
            if pieces and is_open and not part[0].isspace():
                words[-1].append(pieces.pop(0))
            words += [[piece] for piece in pieces]
            is_open = bool(part) and not part[-1].isspace()
        else:
            words += [] if is_open else [[]]
            words[-1].append(part)
            is_open = True
    return words


def _program(element: Element) -> dict[str, Any]:
    """Return what each program may have, under the names of Python."""
    delay = element.attributes.get("respawn_delay")
    if element.attributes.get("on_exit", "shutdown") != "shutdown":
        raise CommandError(f"`on_exit` of `{element.kind}` is `shutdown` or not there.")
    return {
        "name": _optional(element, "name"),
        "cwd": _optional(element, "cwd"),
        "prefix": _optional(element, "launch-prefix", "launch_prefix"),
        "respawn": _optional(element, "respawn") or False,
        "respawn_delay": None if delay is None else float(delay),
        "respawn_max_retries": int(element.attributes.get("respawn_max_retries", -1)),
        **{name: _text(value) for name, value in element.attributes.items() if name.endswith("_timeout")},
        "on_exit": known.Shutdown() if "on_exit" in element.attributes else (),
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
        package=_optional(element, "pkg"),
        executable=_needed_text(element, "exec"),
        exec_name=_optional(element, "exec_name"),
        namespace=_optional(element, "namespace", "ns"),
        parameters=[_parameter(child) for child in element.children if child.kind == "param"],
        remappings=[
            (_needed_text(child, "from"), _needed_text(child, "to"))
            for child in element.children
            if child.kind == "remap"
        ],
        arguments=_split(str(of.get("args", ""))),
        ros_arguments=_split(str(of.get("ros_args", ""))),
        **_program(element),
    )


def _composable(element: Element) -> list[known.ComposableNode]:
    """Return the composable nodes in an element, as far as a message names them: they are never started."""
    nodes = [child for child in element.children if child.kind == "composable_node"]
    for node in nodes:
        _check(node, node.kind)
    return [
        known.ComposableNode(
            package=_needed_text(node, "pkg"), plugin=_needed_text(node, "plugin"),
            condition=_condition(node.attributes),
        )
        for node in nodes
    ]  # fmt: skip


def _parameter(element: Element) -> Any:
    if "from" in element.attributes:
        return ParameterFile(_text(element.attributes["from"]), allow_substs=_yes(element, "allow_substs"))
    if element.children:
        nested: dict[str, Any] = {}
        for child in element.children:
            nested |= _parameter(child)
        return {str(_needed(element, "name")): nested}
    value = _needed(element, "value")
    if "value-sep" in element.attributes:
        value = yaml.safe_load(f"[{', '.join(value.split(element.attributes['value-sep']))}]")
    if "type" in element.attributes:
        plain = value if isinstance(value, list) else _text(value)
        return {str(_needed(element, "name")): ParameterValue(plain, value_type=_type_of(element))}
    return {str(_needed(element, "name")): parse(value) if isinstance(value, str) and "$(" in value else value}


def _for_all(element: Element) -> Any:
    """Return a value that is read as YAML, also in YAML."""
    value = _needed_text(element, "value")
    return TextSubstitution(text=value) if isinstance(value, str) else value


def _type_of(element: Element) -> Any:
    name = str(element.attributes["type"])
    if name not in _TYPES:
        raise CommandError(f"the type of a `param` is one of {', '.join(_TYPES)}, and not `{name}`.")
    return _TYPES[name]


def _condition(attributes: Mapping[str, Any]) -> Condition | None:
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
    "append_env": lambda of: changes.AppendEnvironmentVariable(
        _needed_text(of, "name"),
        _needed_text(of, "value"),
        _optional(of, "prepend") or False,
        _optional(of, "separator") or ":",
    ),
    "executable": _executable,
    "group": _group,
    "include": _include,
    "let": lambda of: changes.SetLaunchConfiguration(_needed_text(of, "name"), _needed_text(of, "value")),
    "lifecycle_node": _node,
    "load_composable_node": lambda of: known.LoadComposableNodes(
        composable_node_descriptions=_composable(of), target_container=_needed_text(of, "target")
    ),
    "log": lambda of: known.LogInfo(_needed_text(of, "message")),
    "node": _node,
    "node_container": lambda of: known.ComposableNodeContainer(
        package=_needed_text(of, "pkg"),
        executable=_needed_text(of, "exec"),
        composable_node_descriptions=_composable(of),
    ),
    "push_ros_namespace": lambda of: changes.PushRosNamespace(_needed_text(of, "namespace")),
    "reset": lambda of: changes.ResetLaunchConfigurations(_kept(of) or None),
    "reset_env": lambda of: changes.ResetEnvironment(),
    "ros_timer": _timer,
    "set_env": lambda of: changes.SetEnvironmentVariable(_needed_text(of, "name"), _needed_text(of, "value")),
    "set_parameter": lambda of: changes.ParameterForAll(_needed_text(of, "name"), _for_all(of)),
    "set_parameters_from_file": lambda of: changes.SetParametersFromFile(_needed_text(of, "filename")),
    "set_ros_log_dir": lambda of: changes.SetROSLogDir(_needed_text(of, "new_log_dir")),
    "set_use_sim_time": lambda of: changes.SetUseSimTime(_for_all(of)),
    "set_remap": lambda of: changes.SetRemap(_needed_text(of, "from"), _needed_text(of, "to")),
    "shutdown": lambda of: known.Shutdown(_optional(of, "reason") or "reason not given"),
    "timer": _timer,
    "unset_env": lambda of: changes.UnsetEnvironmentVariable(_needed_text(of, "name")),
}
