"""Reads from a launch file which programs it starts, and what it sets for them.

Source: "Creating a launch file" in the ROS 2 documentation, and launch_ros's Node. Nothing of a submission is run.
"""

from __future__ import annotations

import ast
import posixpath
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass

from grader.submission import python_code
from grader.submission.entry_points import EntryPoint, entry_points


@dataclass(frozen=True)
class LaunchFileNode:
    """A node in a launch file: its executable, and the name that the launch file gives it, if any."""

    executable: str
    name: str
    settings: tuple[str, ...] = ()
    """What the launch file sets for it, by its keywords: see `SETTINGS`."""
    package: str = ""

    def starts(self, entry: EntryPoint) -> bool:
        """Return whether this is the node of an executable."""
        return self.executable == entry.name and (self.package or entry.package) == entry.package


#: What a launch file can set for a node, as "Node" in the documentation of launch_ros has it, and in words.
SETTINGS = {
    **{"remappings": "remappings", "remap": "remappings", "parameters": "parameters", "param": "parameters"},
    **{"namespace": "namespace", "arguments": "arguments", "args": "arguments", "ros_arguments": "arguments"},
}

LAUNCH_FILE = re.compile(r"launch\.(?:py|xml|ya?ml)$|\.launch$")
#: What a launch file can set for all nodes of a group, in Python, XML and YAML.
_OF_GROUPS = re.compile(rb"SetRemap|SetParameters?|PushRosNamespace|set_remap|set_parameter|push[-_]ros[-_]namespace")
#: A node in XML, with the elements in it, and in YAML. No part is looked through twice, whatever a student wrote.
_NODE = re.compile(
    r"(?P<itself><node\b[^<>]*>|^[ \t]*-[ \t]*node:.*?(?=^[ \t]*-|\Z))(?:(?<=[^/]>).*?(?=</?node\b|\Z))?",
    re.DOTALL | re.MULTILINE,
)


def launched(files: Mapping[str, bytes]) -> list[LaunchFileNode]:
    """Return the nodes that launch files start, if their executable is a plain string."""
    found: list[LaunchFileNode] = []
    for name in sorted(files):
        text = files[name].decode("utf-8", errors="replace")
        if name.endswith("launch.py") or (name.endswith(".py") and "def generate_launch_description" in text):
            found += _launched_by_python(text)
        elif LAUNCH_FILE.search(name):
            for node in _NODE.finditer(text):
                values = dict(re.findall(r"""\b(exec|name|pkg)\s*[=:]\s*["']?([\w.-]+)""", node["itself"]))
                keys = [key for key in SETTINGS if re.search(rf"\b{key}\b\s*[=:]|<{key}\b", node[0])]
                names = (values.get("exec", ""), values.get("name", ""))
                found.append(LaunchFileNode(*names, _in_words(keys), values.get("pkg", "")))
    return [one for one in found if one.executable]


def _launched_by_python(text: str) -> Iterator[LaunchFileNode]:
    tree = python_code.tree_of(text)
    for node in ast.walk(tree) if tree else ():
        if isinstance(node, ast.Call) and getattr(node.func, "id", getattr(node.func, "attr", "")).endswith("Node"):
            values = {
                keyword.arg: keyword.value.value
                for keyword in node.keywords
                if isinstance(keyword.value, ast.Constant) and isinstance(keyword.value.value, str)
            }
            keys = [keyword.arg or "" for keyword in node.keywords]
            names = (values.get("executable", ""), values.get("name", ""))
            yield LaunchFileNode(*names, _in_words(keys), values.get("package", ""))


def _in_words(keys: Iterable[str]) -> tuple[str, ...]:
    return tuple(dict.fromkeys(SETTINGS[key] for key in keys if key in SETTINGS))


def launch_settings(files: Mapping[str, bytes], file: str) -> list[str]:
    """Return what launch files set for the program in `file`, in words."""
    stem = posixpath.basename(file).removesuffix(".py")
    names = {stem, f"{stem}.py"} | {entry.name for entry in entry_points(files) if entry.file == file}
    nodes = [node for node in launched(files) if node.executable in names]
    settings = [setting for node in nodes for setting in node.settings]
    code = files[file].decode("utf-8", errors="replace")
    settings += ["the node's name" for node in nodes if node.name and not python_code.creates(code, node.name)]
    is_in_group = any(_OF_GROUPS.search(data) for name, data in files.items() if LAUNCH_FILE.search(name))
    return list(dict.fromkeys([*settings, *(["what it sets for a group"] if nodes and is_in_group else [])]))
