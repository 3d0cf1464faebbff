"""A chapter's launch and parameter files, such as `launch/humanoid.launch.py`.

They are recognised by their titles. A launch file starts its nodes, as `ros2 run` would start each of them.
"""

from __future__ import annotations

import ast
import re
import shlex
from collections.abc import Iterator
from dataclasses import dataclass

from ros_in_python.launch.python_file import MODULES
from spinbook.chapter.terminal import Command, CommandKind


@dataclass(frozen=True)
class LaunchedNode:
    """One `Node(package=…, executable=…)` of a launch file; `words` are its process's arguments."""

    package: str
    executable: str
    words: tuple[str, ...]

    def command(self, line: int) -> Command:
        """Return `ros2 run` with this node's name, parameters and remappings."""
        words = ("ros2", "run", self.package, self.executable, *self.words)
        return Command(CommandKind.ROS2, shlex.join(words), words, line)


def launched_nodes(code: str) -> list[LaunchedNode]:
    """Return the nodes that a launch file starts, in order; none if the arguments of one are not literals."""
    nodes = [_node(call) for call in _calls(code)]
    return [node for node in nodes if node is not None] if all(nodes) else []


def _calls(code: str) -> Iterator[ast.Call]:
    for item in ast.walk(ast.parse(code)):
        if isinstance(item, ast.Call) and ast.unparse(item.func).rpartition(".")[2] in {"Node", "LifecycleNode"}:
            yield item


def _node(call: ast.Call) -> LaunchedNode | None:
    keywords = {keyword.arg: keyword.value for keyword in call.keywords if keyword.arg}
    package, executable = (_text(keywords.get(name)) for name in ("package", "executable"))
    if not package or not executable:
        return None
    words = [
        *_remapped("__node", _text(keywords.get("name"))),
        *_remapped("__ns", _namespace(keywords.get("namespace"))),
    ]
    words += [word for name, to in _pairs(keywords.get("remappings")) for word in _remapped(name, to)]
    words += [word for name, value in _parameters(keywords.get("parameters")) for word in ("-p", f"{name}:={value}")]
    arguments = [_text(item) for item in _items(keywords.get("arguments"))]
    return LaunchedNode(package, executable, (*filter(None, arguments), *(("--ros-args", *words) if words else ())))


def _text(value: ast.expr | None) -> str:
    return str(value.value) if isinstance(value, ast.Constant) else ""


def _namespace(value: ast.expr | None) -> str:
    text = _text(value)
    return text if not text or text.startswith("/") else f"/{text}"


def _remapped(name: str, to: str) -> list[str]:
    return ["-r", f"{name}:={to}"] if to else []


def _items(value: ast.expr | None) -> list[ast.expr]:
    return value.elts if isinstance(value, ast.List | ast.Tuple) else []


def _pairs(value: ast.expr | None) -> Iterator[tuple[str, str]]:
    for item in _items(value):
        both = [_text(part) for part in _items(item)]
        if len(both) == 2 and all(both):
            yield both[0], both[1]


def _parameters(value: ast.expr | None) -> Iterator[tuple[str, str]]:
    for item in _items(value):
        if isinstance(item, ast.Dict):
            for key, of in zip(item.keys, item.values, strict=True):
                try:
                    value_of = ast.literal_eval(of)
                except ValueError:
                    continue
                yield _text(key), str(value_of).lower() if isinstance(value_of, bool) else str(value_of)


_PATH = re.compile(r"launch/[\w-]+[._]launch\.(py|yaml|yml|xml)|config/[\w-]+\.ya?ml")


def is_package_file(title: str) -> bool:
    """Return whether a title is the path of a launch or parameter file within a package.

    >>> is_package_file("launch/humanoid.launch.py"), is_package_file("joint_publisher.py")
    (True, False)
    """
    return bool(_PATH.fullmatch(title))


def unsupported_in_launch_file(code: str) -> str:
    """Return what a Python launch file imports from ROS 2's launch that is not supported here; "" if all of it is.

    Raises SyntaxError.
    """
    for item in ast.walk(ast.parse(code)):
        if isinstance(item, ast.ImportFrom) and item.module and item.module.split(".")[0] in {"launch", "launch_ros"}:
            there = MODULES.get(item.module, {})
            missing = [name.name for name in item.names if name.name not in there]
            if missing and not all(f"{item.module}.{name}" in MODULES for name in missing):
                return f"{item.module}.{missing[0]}"
        elif isinstance(item, ast.Import):
            for name in item.names:
                if name.name.split(".")[0] in {"launch", "launch_ros"} and name.name not in MODULES:
                    return name.name
    return ""
