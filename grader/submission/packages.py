"""Reads ROS 2 packages as students write them: which programs are there, and how to run a module of them.

Source: "Developing a ROS 2 package" in the ROS 2 documentation. Nothing of a submission is run.
"""

from __future__ import annotations

import importlib.util
import posixpath
import re
import sys
from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from grader.recording.places import LAUNCHER
from grader.submission import python_code
from grader.submission.entry_points import is_below, package_name, roots
from grader.submission.file_kinds import kind_of

#: Python files that are never the student's program.
_NOT_PROGRAMS = re.compile(r"(?:setup|conftest|__init__|test_\w*|\w*_test|\w*[._]launch)\.py", re.IGNORECASE)


def programs(files: Mapping[str, bytes]) -> list[str]:
    """Return the paths of the Python files that can be programs.

    Setup files, tests and launch files count only if they use rclpy and nothing else is there.
    """
    python = [name for name in sorted(files) if kind_of(name) == "python"]
    nodes = [name for name in python if posixpath.basename(name) == "__init__.py" and b"rclpy" in files[name]]
    own = [name for name in python if not _is_support(name) or name in nodes]
    return own or [name for name in python if b"rclpy" in files[name]]


def _is_support(name: str) -> bool:
    *folders, file = name.split("/")
    return bool(_NOT_PROGRAMS.fullmatch(file)) or any(folder in ("test", "tests", "launch") for folder in folders)


@dataclass(frozen=True)
class Layout:
    """How a module is run: all files by path, and the module's path and dotted name."""

    files: Mapping[str, bytes]
    main: str
    module: str


def layout_of(file: str, files: Mapping[str, bytes], called: str) -> Layout:
    """Return what belongs to a program: its package, and the packages that it imports.

    `called` is the name of the folder that was handed in, if known.
    """
    root = _import_root(file, files)
    inside = posixpath.relpath(file, root) if root else file
    chosen = {
        posixpath.relpath(name, root) if root else name: data for name, data in files.items() if is_below(name, root)
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
    return any(re.search(rf"^[ \t]*(?:from|import)\s+{re.escape(package)}\b", text, re.MULTILINE) for text in texts)


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
    modules = {
        m.split(".")[1] for m in python_code.imported(code.decode(errors="replace")) if m.startswith(f"{package}.")
    }
    return any(f"{name}.py" in files for name in modules)


def _other_packages(chosen: Mapping[str, bytes], files: Mapping[str, bytes], root: str) -> Iterator[tuple[str, bytes]]:
    """Yield the files of the workspace's other packages."""
    for other in roots(files):
        if other == root or not any(is_below(name, other) and name.endswith("/__init__.py") for name in files):
            continue
        for name, data in files.items():
            inside = posixpath.relpath(name, other) if other else name
            if is_below(name, other) and "/" in inside and inside not in chosen:
                yield inside, data


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
    """Return the packages that define messages, services or actions."""
    interfaces = [name for name in files if re.search(r"\.(msg|srv|action)$", name)]
    return {
        package_name(files, root)
        for root in roots(files)
        if posixpath.join(root, "package.xml") in files and any(is_below(name, root) for name in interfaces)
    }


def is_installed(package: str) -> bool:
    """Return whether a package can be imported here."""
    try:
        return importlib.util.find_spec(package) is not None
    except (ImportError, ValueError):
        return False


#: Runs a module as `python -m` would, or its function as an installed executable does.
_LAUNCHER = """\
{note}
import importlib, operator, os, runpy, sys

_here = os.path.dirname(os.path.abspath(__file__))
sys.path[0] = _here
# For `import helper` next to the module; last, so that a logging.py there does not replace Python's own.
sys.path.append(os.path.join(_here, {folder!r}))
if {function!r}:
    sys.exit(operator.attrgetter({function!r})(importlib.import_module({module!r}))())
runpy.run_module({module!r}, run_name="__main__", alter_sys=True)
"""


def launcher(module: str, function: str) -> bytes:
    """Return a program that runs a module of a package, or one function of it."""
    return _LAUNCHER.format(
        note=LAUNCHER, module=module, function=function, folder=posixpath.dirname(module.replace(".", "/"))
    ).encode()
