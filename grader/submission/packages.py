"""Reads ROS 2 packages as students write them: what they install and launch, and how to run a module of them.

Sources: setuptools' documentation ("Entry Points"), "Developing a ROS 2 package" and "Creating a launch file" in the
ROS 2 documentation, and ament_cmake_python's for `install(PROGRAMS …)`. Nothing of a submission is run.
"""

from __future__ import annotations

import ast
import configparser
import importlib.util
import posixpath
import re
import sys
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from typing import Any

from grader.submission import python_code
from grader.submission.file_kinds import kind_of
from grader.submission.places import LAUNCHER

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

#: A line of an entry point: `beat = my_robot.beat_node:main`.
_ENTRY = re.compile(
    r"\s*(?P<name>[^\s=]+)\s*=\s*(?P<module>[\w.]+)\s*(?::\s*(?P<function>[\w.]+))?\s*(?:\[[^\]]*\])?\s*"
)
_PACKAGE_NAME = re.compile(rb"<name>\s*([\w-]+)\s*</name>")
_MANIFESTS = ("package.xml", "setup.py", "setup.cfg", "pyproject.toml")

#: Where pyproject.toml has the executables.
_SCRIPTS = (("project", "scripts"), ("project", "entry-points", "console_scripts"), ("tool", "poetry", "scripts"))

#: Python files that are never the student's program.
_NOT_PROGRAMS = re.compile(r"(?:setup|conftest|__init__|test_\w*|\w*_test|\w*[._]launch)\.py", re.IGNORECASE)


@dataclass(frozen=True)
class EntryPoint:
    """An executable that a package installs: `name` runs `function` of the module in `file`."""

    name: str
    file: str
    function: str


@dataclass(frozen=True)
class LaunchFileNode:
    """A node in a launch file: its executable, and the name that the launch file gives it, if any."""

    executable: str
    name: str
    settings: tuple[str, ...] = ()
    """What the launch file sets for it, by its keywords: see `SETTINGS`."""


#: What a launch file can set for a node, as "Node" in the documentation of launch_ros has it, and in words.
SETTINGS = {
    **{"remappings": "remappings", "remap": "remappings", "parameters": "parameters", "param": "parameters"},
    **{"namespace": "namespace", "arguments": "arguments", "args": "arguments", "ros_arguments": "arguments"},
}

_LAUNCH_FILE = re.compile(r"launch\.(?:py|xml|ya?ml)$|\.launch$")
#: What a launch file can set for all nodes of a group, in Python, XML and YAML.
_OF_GROUPS = re.compile(rb"SetRemap|SetParameters?|PushRosNamespace|set_remap|set_parameter|push[-_]ros[-_]namespace")


def programs(files: Mapping[str, bytes]) -> list[str]:
    """Return the paths of the Python files that can be programs.

    Setup files, tests and launch files count only if they use rclpy and nothing else is there.
    """
    python = [name for name in sorted(files) if kind_of(name) == "python"]
    own = [name for name in python if not _is_support(name) or _is_package_with_node(name, files)]
    return own or [name for name in python if b"rclpy" in files[name]]


def _is_package_with_node(name: str, files: Mapping[str, bytes]) -> bool:
    return posixpath.basename(name) == "__init__.py" and b"rclpy" in files[name]


def _is_support(name: str) -> bool:
    *folders, file = name.split("/")
    return bool(_NOT_PROGRAMS.fullmatch(file)) or any(folder in ("test", "tests", "launch") for folder in folders)


def roots(files: Mapping[str, bytes]) -> list[str]:
    """Return the folders of packages: those with a package.xml or a setup file. "" is the top."""
    return sorted({posixpath.dirname(name) for name in files if posixpath.basename(name) in _MANIFESTS})


def entry_points(files: Mapping[str, bytes]) -> list[EntryPoint]:
    """Return the executables that the packages install, if their modules exist."""
    return list(dict.fromkeys(entry for root in roots(files) for entry in _entry_points(files, root)))


def _entry_points(files: Mapping[str, bytes], root: str) -> Iterator[EntryPoint]:
    for line in (*_of_setup(files, root), *_of_configuration(files, root), *_of_pyproject(files, root)):
        if (match := _ENTRY.fullmatch(line)) and (file := _module_file(match["module"], root, files)):
            yield EntryPoint(match["name"], file, match["function"] or "main")
    yield from _of_cmake(files, root)


def _module_file(module: str, root: str, files: Mapping[str, bytes]) -> str:
    """Return the file of a module in the package in `root`, in whatever folder its setup puts it; otherwise ""."""
    path = module.replace(".", "/")
    inside = {posixpath.relpath(name, root or "."): name for name in files if _below(name, root)}
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


def _of_cmake(files: Mapping[str, bytes], root: str) -> Iterator[EntryPoint]:
    """Yield the scripts that `install(PROGRAMS …)` names."""
    for call in re.findall(r"install\s*\(\s*PROGRAMS([^)]*)\)", _text(files, root, "CMakeLists.txt"), re.IGNORECASE):
        for word in call.split():
            file = posixpath.join(root, word)
            if file in files:
                yield EntryPoint(posixpath.basename(word), file, "")


def launched(files: Mapping[str, bytes]) -> list[LaunchFileNode]:
    """Return the nodes that launch files start, if their executable is a plain string."""
    found: list[LaunchFileNode] = []
    for name in sorted(files):
        text = files[name].decode("utf-8", errors="replace")
        if re.search(r"launch\.py$", name):
            found += _launched_by_python(text)
        elif re.search(r"launch\.(xml|ya?ml)$|\.launch$", name):
            for node in re.findall(r"<node\b[^>]*>|^\s*-\s*node:.*?(?=^\s*-|\Z)", text, re.DOTALL | re.MULTILINE):
                values = dict(re.findall(r"""\b(exec|name)\s*[=:]\s*["']?([\w.-]+)""", node))
                keys = [key for key in SETTINGS if re.search(rf"\b{key}\b\s*[=:]|<{key}\b", _element(text, node))]
                found.append(LaunchFileNode(values.get("exec", ""), values.get("name", ""), _in_words(keys)))
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
            yield LaunchFileNode(values.get("executable", ""), values.get("name", ""), _in_words(keys))


def _element(text: str, tag: str) -> str:
    """Return an XML element with what is in it, given its first tag; any other text as it is."""
    if not tag.startswith("<node") or tag.endswith("/>"):
        return tag
    return tag + text.partition(tag)[2].partition("</node>")[0]


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
    is_in_group = any(_OF_GROUPS.search(data) for name, data in files.items() if _LAUNCH_FILE.search(name))
    return list(dict.fromkeys([*settings, *(["what it sets for a group"] if nodes and is_in_group else [])]))


@dataclass(frozen=True)
class Layout:
    """How a module is run: all files by path, and the module's path and dotted name."""

    files: Mapping[str, bytes]
    main: str
    module: str


def layout_of(file: str, files: Mapping[str, bytes], called: str = "") -> Layout:
    """Return what belongs to a program: its package, and the packages that it imports.

    `called` is the name of the folder that was handed in, if known.
    """
    root = _import_root(file, files)
    inside = posixpath.relpath(file, root) if root else file
    chosen = {
        posixpath.relpath(name, root) if root else name: data for name, data in files.items() if _below(name, root)
    }
    top = posixpath.dirname(file) == root and "/" not in inside
    missing = _unknown_package(file, files) if top else ""
    if missing and (
        missing == (posixpath.basename(root) or called)
        or "__init__.py" in chosen
        or _fits(missing, chosen, files[file])
    ):
        # The content of a package's folder was handed in without the folder itself.
        chosen = {f"{missing}/{name}": data for name, data in chosen.items()}
        inside = f"{missing}/{inside}"
    chosen |= dict(_other_packages(chosen, files, root))
    chosen = {
        name: data
        for name, data in chosen.items()
        if name == inside or not _is_support(name) or name.endswith("__init__.py")
    }
    return Layout(chosen, inside, inside.removesuffix(".py").replace("/", ".") if "/" in inside else "")


def _below(name: str, root: str) -> bool:
    return not root or name.startswith(f"{root}/")


def _import_root(file: str, files: Mapping[str, bytes]) -> str:
    """Return the folder that must be on Python's path: the one above the program's package."""
    own = folder = posixpath.dirname(file)
    while folder and f"{folder}/__init__.py" in files:
        folder = posixpath.dirname(folder)
    # A package without __init__.py.
    if folder and folder == own and own not in roots(files) and _is_imported(posixpath.basename(own), file, files):
        folder = posixpath.dirname(own)
    return folder


def _is_imported(package: str, file: str, files: Mapping[str, bytes]) -> bool:
    siblings = [name for name in files if posixpath.dirname(name) == posixpath.dirname(file) and name.endswith(".py")]
    texts = [files[name].decode("utf-8", errors="replace") for name in siblings]
    return any(re.search(rf"^\s*(?:from|import)\s+{re.escape(package)}\b", text, re.MULTILINE) for text in texts)


def _unknown_package(file: str, files: Mapping[str, bytes]) -> str:
    """Return a package that the program imports modules of, and that is neither here nor installed."""
    there = {name.removesuffix(".py").rpartition("/")[2] for name in files if name.endswith(".py")}
    there |= {folder for name in files for folder in name.split("/")[:-1]}
    for module in sorted(python_code.imported(files[file].decode("utf-8", errors="replace"))):
        package, _, rest = module.partition(".")
        is_known = package in sys.stdlib_module_names or package in there or package == "rclpy"
        if not is_known and rest.partition(".")[0] in there:
            return package
    return ""


def _fits(package: str, files: Mapping[str, bytes], code: bytes) -> bool:
    wanted = {
        m.split(".")[1] for m in python_code.imported(code.decode(errors="replace")) if m.startswith(f"{package}.")
    }
    return any(f"{name}.py" in files for name in wanted)


def _other_packages(chosen: Mapping[str, bytes], files: Mapping[str, bytes], root: str) -> Iterator[tuple[str, bytes]]:
    """Yield the files of the workspace's other packages."""
    for other in roots(files):
        if other == root or not _has_package(other, files):
            continue
        for name, data in files.items():
            inside = posixpath.relpath(name, other) if other else name
            if _below(name, other) and "/" in inside and inside not in chosen:
                yield inside, data


def _has_package(root: str, files: Mapping[str, bytes]) -> bool:
    return any(_below(name, root) and name.endswith("/__init__.py") for name in files)


def packages_of_messages(source: str, files: Mapping[str, bytes]) -> set[str]:
    """Return the packages whose messages, services or actions a program imports, also in its modules among `files`."""
    by_name = {posixpath.basename(name).removesuffix(".py"): name for name in files if name.endswith(".py")}
    modules: set[str] = set()
    texts = [source]
    while texts:
        new = python_code.imported(texts.pop(), relative=True) - modules
        modules |= new
        own = {by_name.pop(part, "") for module in new for part in module.split(".")} - {""}
        texts += [files[name].decode("utf-8", errors="replace") for name in sorted(own)]
    return {module.split(".")[0] for module in modules if module.split(".")[1:2] in (["msg"], ["srv"], ["action"])}


def own_interfaces(files: Mapping[str, bytes]) -> set[str]:
    """Return the packages that define messages, services or actions, and are not installed here as well."""
    found = set()
    for root in roots(files):
        manifest = _PACKAGE_NAME.search(files.get(posixpath.join(root, "package.xml"), b""))
        kinds = [name for name in files if _below(name, root) and re.search(r"\.(msg|srv|action)$", name)]
        if manifest and kinds and not _is_installed(manifest[1].decode()):
            found.add(manifest[1].decode())
    return found


def _is_installed(package: str) -> bool:
    try:
        return importlib.util.find_spec(package) is not None
    except (ImportError, ValueError):
        return False


#: Runs a module as `python -m` would, or its function as an installed executable does.
_LAUNCHER = """\
{note}
import importlib, operator, os, runpy, sys

_here = os.path.dirname(os.path.abspath(__file__))
sys.path[:1] = [_here, os.path.join(_here, {folder!r})]
if {function!r}:
    sys.exit(operator.attrgetter({function!r})(importlib.import_module({module!r}))())
runpy.run_module({module!r}, run_name="__main__", alter_sys=True)
"""


def launcher(module: str, function: str) -> bytes:
    """Return a program that runs a module of a package, or one function of it."""
    return _LAUNCHER.format(
        note=LAUNCHER, module=module, function=function, folder=posixpath.dirname(module.replace(".", "/"))
    ).encode()
