"""Reads which executables a ROS 2 package installs: from setup.py, setup.cfg, pyproject.toml and CMakeLists.txt.

Sources: setuptools' documentation ("Entry Points"), the Python packaging user guide ("pyproject.toml"), and
ament_cmake_python's for `install(PROGRAMS …)`. Nothing of a submission is run.
"""

from __future__ import annotations

import ast
import configparser
import posixpath
import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from grader.submission import python_code

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

#: A line of an entry point: `beat = my_robot.beat_node:main`.
_ENTRY = re.compile(
    r"\s*(?P<name>[^\s=]+)\s*=\s*(?P<module>[\w.]+)\s*(?::\s*(?P<function>[\w.]+))?\s*(?:\[[^\]]*\])?\s*"
)
_MANIFESTS = ("package.xml", "setup.py", "setup.cfg", "pyproject.toml")

#: Where pyproject.toml has the executables.
_SCRIPTS = (("project", "scripts"), ("project", "entry-points", "console_scripts"), ("tool", "poetry", "scripts"))


@dataclass(frozen=True)
class EntryPoint:
    """An executable that `package` installs: `name` runs `function` of `module`, which is in `file`."""

    name: str
    file: str
    function: str
    module: str = ""
    package: str = ""


def roots(files: Mapping[str, bytes]) -> list[str]:
    """Return the folders of packages: those with a package.xml or a setup file. "" is the top."""
    return sorted({posixpath.dirname(name) for name in files if posixpath.basename(name) in _MANIFESTS})


def is_below(name: str, root: str) -> bool:
    """Return whether a path is inside the folder `root`; everything is inside ""."""
    return not root or name.startswith(f"{root}/")


def entry_points(files: Mapping[str, bytes]) -> list[EntryPoint]:
    """Return the executables that the packages install, if their modules exist."""
    return list(dict.fromkeys(entry for root in roots(files) for entry in entry_points_of(files, root)))


def entry_points_of(files: Mapping[str, bytes], root: str) -> Iterator[EntryPoint]:
    """Yield the executables that the package in the folder `root` installs, if their modules exist."""
    inside = {posixpath.relpath(name, root or "."): name for name in files if is_below(name, root)}
    package = package_name(files, root)
    for line in (*_of_setup(files, root), *_of_configuration(files, root), *_of_pyproject(files, root)):
        if (match := _ENTRY.fullmatch(line)) and (file := _module_file(match["module"], inside)):
            yield EntryPoint(match["name"], file, match["function"] or "main", match["module"], package)
    for name, file in _of_cmake(files, root):
        yield EntryPoint(name, file, "", "", package)


def package_name(files: Mapping[str, bytes], root: str) -> str:
    """Return a package's name, from its package.xml; without one, the name of the folder `root`."""
    name = re.search(r"<name>\s*([\w-]+)\s*</name>", _text(files, root, "package.xml"))
    return name[1] if name else posixpath.basename(root)


def _module_file(module: str, inside: Mapping[str, str]) -> str:
    """Return the file of a module, in whatever folder of the package it is, otherwise ""; `inside` has paths there."""
    path = module.replace(".", "/")
    ends = (f"{path}.py", f"{path}/__init__.py")
    fitting = [file for file in inside if file in ends or file.endswith(tuple(f"/{end}" for end in ends))]
    return inside[min(fitting, key=lambda file: (file.count("/"), file))] if fitting else ""


def _text(files: Mapping[str, bytes], root: str, name: str) -> str:
    return files.get(posixpath.join(root, name), b"").decode("utf-8", errors="replace")


def _of_setup(files: Mapping[str, bytes], root: str) -> Iterator[str]:
    """Yield the strings in setup.py that have the form of an entry point."""
    tree = python_code.tree_of(_text(files, root, "setup.py")[:_LONGEST])
    known: dict[str, str] = {}
    for statement in tree.body if tree else ():
        if isinstance(statement, ast.Assign) and (value := _string(statement.value, known)) is not None:
            known |= {target.id: value for target in statement.targets if isinstance(target, ast.Name)}
    for node in ast.walk(tree) if tree else ():
        text = _string(node, known) or ""
        if ":" in text:
            yield from text.splitlines()


#: The longest setup.py (characters), and the longest string in it, that are read.
_LONGEST = 20_000


def _string(node: ast.AST, known: Mapping[str, str]) -> str | None:
    """Return the string that an expression of strings and known names is, such as `f"beat = {package}.beat:main"`."""
    try:
        text = _folded(node, known)
    except RecursionError:
        return None
    return text if text is not None and len(text) < _LONGEST else None


def _folded(node: ast.AST, known: Mapping[str, str]) -> str | None:
    if isinstance(node, ast.Constant):
        return node.value if isinstance(node.value, str) else None
    if isinstance(node, ast.Name):
        return known.get(node.id)
    if isinstance(node, ast.FormattedValue):
        return _folded(node.value, known)
    if isinstance(node, ast.JoinedStr):
        parts = [_folded(part, known) for part in node.values]
    elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Add):
        parts = [_folded(node.left, known), _folded(node.right, known)]
    elif isinstance(node, ast.BinOp) and isinstance(node.op, ast.Mod):
        parts = _filled(_folded(node.left, known), "%s", node.right, known)
    elif isinstance(node, ast.Call) and isinstance(node.func, ast.Attribute) and node.func.attr == "format":
        parts = _filled(_folded(node.func.value, known), "{}", ast.Tuple(node.args), known)
    else:
        return None
    return None if None in parts else "".join(part for part in parts if part is not None)


def _filled(pattern: str | None, hole: str, values: ast.expr, known: Mapping[str, str]) -> list[str | None]:
    """Return a pattern's texts with the values between them; [None] if they do not fit."""
    filling = [_folded(one, known) for one in (values.elts if isinstance(values, ast.Tuple) else [values])]
    texts = (pattern or "").split(hole)
    if len(texts) != len(filling) + 1:
        return [None]
    return [texts[0], *(part for pair in zip(filling, texts[1:], strict=True) for part in pair)]


def _of_configuration(files: Mapping[str, bytes], root: str) -> Iterator[str]:
    reader = configparser.ConfigParser(interpolation=None, strict=False)
    try:
        reader.read_string(_text(files, root, "setup.cfg"))
        yield from reader.get("options.entry_points", "console_scripts", fallback="").splitlines()
    except configparser.Error:
        return


def _of_pyproject(files: Mapping[str, bytes], root: str) -> Iterator[str]:
    try:
        whole = tomllib.loads(_text(files, root, "pyproject.toml"))
    except (ValueError, RecursionError):
        return
    for place in _SCRIPTS:
        scripts: Any = whole
        for key in place:
            scripts = scripts.get(key) if isinstance(scripts, dict) else None
        for name, value in scripts.items() if isinstance(scripts, dict) else ():
            yield f"{name} = {value}"


def _of_cmake(files: Mapping[str, bytes], root: str) -> Iterator[tuple[str, str]]:
    """Yield the name and the file of each script that `install(PROGRAMS …)` names."""
    for call in re.findall(r"install\s*\(\s*PROGRAMS([^)]*)\)", _text(files, root, "CMakeLists.txt"), re.IGNORECASE):
        for word in call.split():
            for file in (posixpath.join(root, word), posixpath.join(root, f"{word}.py")):  # see `named_by_content`
                if file in files:
                    yield posixpath.basename(word), file
