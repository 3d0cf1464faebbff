"""Parameters as written in arguments and in YAML files.

The rules are those of rcl_yaml_param_parser: quoted values are text, sequences hold one type, and a file names nodes,
`ros__parameters`, then parameters, whose names are joined by dots.
"""

from __future__ import annotations

import re
from collections.abc import Iterator
from typing import Any

import yaml

_TRUE = {"Y", "y", "yes", "Yes", "YES", "true", "True", "TRUE", "on", "On", "ON"}
_FALSE = {"N", "n", "no", "No", "NO", "false", "False", "FALSE", "off", "Off", "OFF"}
_INT = re.compile(r"[-+]?(0[xX][0-9a-fA-F]+|0[0-7]*|[1-9][0-9]*)$")
_FLOAT = re.compile(r"[-+]?(\d+\.?\d*([eE][-+]?\d+)?|\.\d+([eE][-+]?\d+)?|\.?(inf|Inf|INF))$|\.?(nan|NaN|NAN)$")
_KEY = "ros__parameters"


class ParameterError(ValueError):
    """A value or a file of parameters that can't be read; the text says why."""


def value_of(text: str) -> Any:
    """Return the value of YAML text: bool, int, float, str, bytes or a list of one of them."""
    return _value(_composed(text), text)


def in_files(text: str) -> Iterator[tuple[str, str, Any]]:
    """Yield the parameters in a file: (pattern of the node's name, parameter, value)."""
    root = _composed(text)
    if not isinstance(root, yaml.MappingNode):
        raise ParameterError("a file of parameters has to name nodes")
    yield from _nodes(root, "")


def _composed(text: str) -> yaml.Node | None:
    try:
        return yaml.compose(text, Loader=yaml.SafeLoader)
    except yaml.YAMLError as error:
        raise ParameterError(f"Error parsing a event near: {error}") from None


def _nodes(mapping: yaml.MappingNode, path: str) -> Iterator[tuple[str, str, Any]]:
    for key, value in mapping.value:
        if key.value == _KEY and isinstance(value, yaml.MappingNode):
            for name, found in _named(value, ""):
                yield path, name, found
        elif isinstance(value, yaml.MappingNode):
            yield from _nodes(value, f"{path.rstrip('/')}/{key.value.lstrip('/')}" if path else key.value)
        else:
            raise ParameterError(f"Cannot have a value before {_KEY} at line {key.start_mark.line + 1}")


def _named(mapping: yaml.MappingNode, prefix: str) -> Iterator[tuple[str, Any]]:
    for key, value in mapping.value:
        name = f"{prefix}{key.value}"
        if isinstance(value, yaml.MappingNode):
            yield from _named(value, f"{name}.")
        else:
            yield name, _value(value, "")


def _value(node: yaml.Node | None, text: str) -> Any:
    if isinstance(node, yaml.ScalarNode):
        return _scalar(node)
    if isinstance(node, yaml.SequenceNode):
        return _sequence(node)
    if node is None:
        raise ParameterError(f"No value for the parameter: '{text}'")
    raise ParameterError("a parameter's value can't be a mapping")


def _scalar(node: yaml.ScalarNode) -> Any:
    text = node.value
    if node.style in ("'", '"') or node.tag == "!!str":
        return text
    if text in _TRUE or text in _FALSE:
        return text in _TRUE
    if _INT.match(text):
        return int(text, 8) if re.match(r"[-+]?0[0-7]+$", text) else int(text, 0)
    if _FLOAT.match(text):
        return float(text.lower().replace(".inf", "inf").replace(".nan", "nan"))
    return text


def _sequence(node: yaml.SequenceNode) -> list[Any]:
    values = []
    for item in node.value:
        if not isinstance(item, yaml.ScalarNode):
            raise ParameterError("a sequence can't hold sequences or mappings")
        values.append(_scalar(item))
    for item, value in zip(node.value, values, strict=True):
        if type(value) is not type(values[0]):
            kind = {bool: "bool", int: "integer", float: "double", str: "string"}[type(value)]
            line = item.start_mark.line + 1
            text = f"Sequence should be of same type. Value type '{kind}' do not belong at line_num {line}"
            raise ParameterError(text)
    return values


def applies(pattern: str, node: str) -> bool:
    """Return whether parameters for `pattern` (as in `/**`, `/ns/*`) are for the node with this full name."""
    absolute = pattern if pattern.startswith("/") else f"/{pattern}"
    expression = absolute.replace("/**", "\0").replace("/*", r"(/\w+)").replace("\0", r"(/\w+)*")
    return re.fullmatch(expression, node) is not None
