"""A chapter's launch and parameter files, such as `launch/humanoid.launch.py`.

They are recognised by their titles. A launch file starts its nodes, as `ros2 run` would start each of them.
"""

from __future__ import annotations

import ast
import contextlib
import json
import re
import shlex
from collections.abc import Iterable, Mapping
from dataclasses import dataclass

from ros_in_python.launch.api import ALL_NAMES, COMPOSABLE
from spinbook.chapter.syntax import descendants, last_name, syntax_tree
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


class NotSupportedError(Exception):
    """A launch file does something that can't be done here. The message is what, with its line."""


#: Arguments of a node that change nothing that a notebook shows.
_WITHOUT_EFFECT = frozenset({"output", "emulate_tty", "sigterm_timeout", "sigkill_timeout"})
_NODES = frozenset({"Node", "LifecycleNode"})
#: A node of a launch file in XML, `pkg="robot" exec="talker"`, or in YAML.
_IN_MARKUP = re.compile(r"""\bpkg\s*[=:]\s*["']?(?P<package>\w+)["']?\s+exec\s*[=:]\s*["']?(?P<executable>[\w.]+)""")
#: What lets a launch file start a node or not.
_DECIDES = re.compile(
    r"Condition|OpaqueFunction|LaunchConfigurationEquals|^\s*(if|for)\b.*:$|\b(if|unless)\s*[=:]", re.MULTILINE
)
#: What a launch file may call besides: nothing of it starts or changes a process.
_HARMLESS = frozenset({"LaunchDescription", "DeclareLaunchArgument", "LaunchConfiguration", "add_action", "LogInfo"})


def launched_nodes(code: str, arguments: Mapping[str, str] | None) -> list[LaunchedNode]:
    """Return the nodes that a Python launch file starts, in order. `arguments` are those of the command line.

    Raises NotSupportedError if the file does anything but start nodes whose arguments are texts and numbers.
    """
    try:
        tree = syntax_tree(code)
    except SyntaxError as error:
        raise NotSupportedError(f"line {error.lineno} is not valid Python") from None
    calls = sorted((item for item in descendants(tree) if isinstance(item, ast.Call)), key=lambda call: call.lineno)
    reader = _LaunchReader(_assigned(tree), {**_declared(calls), **(arguments or {})})
    for item in descendants(tree):
        if isinstance(item, ast.For | ast.While | ast.If | ast.Try | ast.ListComp):
            raise NotSupportedError(f"it has a loop or a condition (line {item.lineno})")
    for call in calls:
        name = last_name(call.func)
        if name not in _NODES | _HARMLESS:
            raise NotSupportedError(f"it uses `{ast.unparse(call.func)}` (line {call.lineno})")
    nodes = [reader.node(call) for call in calls if last_name(call.func) in _NODES]
    if not nodes:
        raise NotSupportedError("it starts no node")
    return nodes


def named_nodes(code: str) -> list[LaunchedNode]:
    """Return the nodes that a launch file in Python, XML or YAML starts in any case, by packages and executables that
    are texts in it.
    """
    if _DECIDES.search(code):
        return []
    pairs = [(match["package"], match["executable"]) for match in _IN_MARKUP.finditer(code)]
    with contextlib.suppress(SyntaxError):
        calls = [item for item in descendants(syntax_tree(code)) if isinstance(item, ast.Call)]
        for call in (call for call in calls if last_name(call.func) in _NODES):
            texts = {k.arg: k.value.value for k in call.keywords if isinstance(k.value, ast.Constant)}
            pairs.append((texts.get("package"), texts.get("executable")))
    return [LaunchedNode(str(package), str(executable), ()) for package, executable in pairs if package and executable]


def _assigned(tree: ast.Module) -> dict[str, ast.expr]:
    """Return the variables that are set exactly once, with their values."""
    values: dict[str, list[ast.expr]] = {}
    for item in descendants(tree):
        if isinstance(item, ast.Assign):
            for target in item.targets:
                if isinstance(target, ast.Name):
                    values.setdefault(target.id, []).append(item.value)
    return {name: value[0] for name, value in values.items() if len(value) == 1}


def _declared(calls: Iterable[ast.Call]) -> dict[str, str]:
    """Return the launch arguments that a file declares, with their defaults."""
    defaults: dict[str, str] = {}
    for call in calls:
        values = {"name": call.args[0]} if call.args else {}
        values |= {keyword.arg: keyword.value for keyword in call.keywords if keyword.arg}
        name, default = values.get("name"), values.get("default_value")
        if last_name(call.func) != "DeclareLaunchArgument":
            continue
        if isinstance(name, ast.Constant) and isinstance(default, ast.Constant):
            defaults[str(name.value)] = str(default.value)
    return defaults


@dataclass(frozen=True)
class _LaunchReader:
    """Reads the values in a launch file: texts and numbers, variables that hold them, and launch arguments."""

    variables: Mapping[str, ast.expr]
    arguments: Mapping[str, str]

    def node(self, call: ast.Call) -> LaunchedNode:
        keywords = {keyword.arg or "**": keyword.value for keyword in call.keywords}
        words: dict[str, list[str]] = {}
        for name, value in keywords.items():
            if name in _WITHOUT_EFFECT:
                continue
            read = getattr(self, f"_{name}", None)
            if read is None:
                raise NotSupportedError(f"it gives a node `{name}` (line {value.lineno})")
            words[name] = read(value)
        if call.args or not words.get("package") or not words.get("executable"):
            raise NotSupportedError(f"it has a node without `package` and `executable` (line {call.lineno})")
        ros = [word for name in ("name", "namespace", "remappings", "parameters") for word in words.get(name, [])]
        ros += words.get("ros_arguments", [])
        own = words.get("arguments", [])
        if "--ros-args" in own:
            ros, own = [*own[own.index("--ros-args") + 1 :], *ros], own[: own.index("--ros-args")]
        return LaunchedNode(words["package"][0], words["executable"][0], (*own, *(["--ros-args", *ros] if ros else [])))

    def _package(self, value: ast.expr) -> list[str]:
        return [self._text(value)]

    _executable = _package

    def _name(self, value: ast.expr) -> list[str]:
        return ["-r", f"__node:={self._text(value)}"]

    def _namespace(self, value: ast.expr) -> list[str]:
        text = self._text(value)
        return ["-r", f"__ns:=/{text.lstrip('/')}"] if text else []

    def _arguments(self, value: ast.expr) -> list[str]:
        return [self._text(item) for item in self._items(value)]

    _ros_arguments = _arguments

    def _remappings(self, value: ast.expr) -> list[str]:
        pairs = [self._arguments(item) for item in self._items(value)]
        return [word for name, to in pairs for word in ("-r", f"{name}:={to}")]

    def _parameters(self, value: ast.expr) -> list[str]:
        words: list[str] = []
        for item in self._items(value):
            table = self._resolved(item)
            if not isinstance(table, ast.Dict):
                raise NotSupportedError(f"it reads a file of parameters (line {item.lineno})")
            for key, of in zip(table.keys, table.values, strict=True):
                if key is None:
                    raise NotSupportedError(f"it has `**` among parameters (line {item.lineno})")
                words += ["-p", f"{self._text(key)}:={self._text(of)}"]
        return words

    def _items(self, value: ast.expr) -> list[ast.expr]:
        value = self._resolved(value)
        if not isinstance(value, ast.List | ast.Tuple):
            raise NotSupportedError(f"it uses `{ast.unparse(value)[:40]}` (line {value.lineno})")
        return value.elts

    def _resolved(self, value: ast.expr) -> ast.expr:
        return self.variables.get(value.id, value) if isinstance(value, ast.Name) else value

    def _text(self, value: ast.expr) -> str:
        value = self._resolved(value)
        if isinstance(value, ast.Call) and last_name(value.func) == "LaunchConfiguration" and value.args:
            name = ast.unparse(value.args[0]).strip("'\"")
            if name in self.arguments:
                return self.arguments[name]
        try:
            literal = ast.literal_eval(value)
        except ValueError:
            raise NotSupportedError(f"it uses `{ast.unparse(value)[:40]}` (line {value.lineno})") from None
        return json.dumps(literal) if isinstance(literal, bool | list | tuple) else str(literal)


_PATH = re.compile(r"launch/[\w-]+[._]launch\.(py|yaml|yml|xml)|config/[\w-]+\.ya?ml")


def is_package_file(title: str) -> bool:
    """Return whether a title is the path of a launch or parameter file within a package.

    >>> is_package_file("launch/humanoid.launch.py"), is_package_file("joint_publisher.py")
    (True, False)
    """
    return bool(_PATH.fullmatch(title))


def unsupported_in_launch_file(code: str) -> str:
    """Return what a Python launch file imports from ROS 2's launch that can't run here; "" if all of it can.

    Raises SyntaxError.
    """
    for item in descendants(syntax_tree(code)):
        if isinstance(item, ast.ImportFrom) and item.module and item.module.split(".")[0] in {"launch", "launch_ros"}:
            there = ALL_NAMES.get(item.module, ())
            names = [name.name for name in item.names]
            missing = [name for name in names if name not in there and f"{item.module}.{name}" not in ALL_NAMES]
            if never_run := [*missing, *(name for name in names if name in COMPOSABLE)]:
                return f"{item.module}.{never_run[0]}"
        elif isinstance(item, ast.Import):
            for name in item.names:
                if name.name.split(".")[0] in {"launch", "launch_ros"} and name.name not in ALL_NAMES:
                    return name.name
    return ""
