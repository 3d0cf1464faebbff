"""The archives that a page loads: rclpy and the message classes with rcl_python, the checks, the interface files.

rclpy's files and the message classes are those of the installed wheels, unchanged. The same files
always give the same bytes.
"""

from __future__ import annotations

import importlib.util
import json
import sys
from collections.abc import Iterator, Mapping
from pathlib import Path

import groundwork
import interface_compiler
import rcl_python
import rmw_lockstep
import ros_in_python
import spinbook
from interface_compiler import prefixes
from interface_compiler.wheel_file import zipped
from ros_in_python.example_robots import EXAMPLES

#: Modules of the environment that rclpy and `ros2` need, besides the interface packages.
_ROS = ("rclpy", "rpyutils", "rosidl_parser", "rosidl_generator_py", "ament_index_python", "yaml", "click")
_CHECKS = ("pytest", "_pytest", "py", "pluggy", "iniconfig", "packaging", "pygments", "jinja2", "markupsafe")
#: The lexers of Pygments that pytest needs, out of hundreds.
_LEXERS = ("__init__.py", "_mapping.py", "python.py", "diff.py")
#: Of ROS in Python, what needs numpy, or libraries that a page does not have: an import says so (process.py).
_WITHOUT_A_PAGE = ("cv_bridge", "rosbag2_py", "tf_transformations")
_SPINBOOK = (
    *("__init__.py", "problem.py", "kernel/__init__.py", "kernel/entry.py", "kernel/recorder_lines.py"),
    *("kernel/robot_recorder.py", "kernel/surroundings.py", "kernel/timeline.py", "kernel/timeline_picture.py"),
    *("kernel/timeline_recorder.py", "kernel/plot", "browser", "graph", "chapter/__init__.py", "chapter/bindings.py"),
    "chapter/callback_answers.py",
    *("chapter/interface_fields.py", "chapter/node_classes.py", "chapter/syntax.py", "chapter/terminal.py"),
    *("chapter/variable_types.py", "chapter/wrong_fields.py"),
)
#: The parts of the grader that run scenarios and judge recordings. The rest starts programs and sandboxes them.
_GRADER = ("__init__.py", "checking", "exercise", "recording", "runner", "scenario", "submission", "report")
_INDEXED = ("rosidl_interfaces", "packages")
_TEXTS = (".msg", ".srv", ".action")


def ros_archive() -> bytes:
    """Return rclpy, every interface package, `ros2` with its nodes, and the parts of Spinbook that run in the page."""
    packages = [*_ROS, *interface_packages()]
    files = {name: data for package in packages for name, data in _module(package)}
    # The original module also imports code that looks for compiled libraries, which a page does not have.
    files["rosidl_generator_py/__init__.py"] = b"from .import_type_support_impl import import_type_support\n"
    files |= dict(_python_files(Path(rcl_python.__file__).parent, "rcl_python"))
    for path, data in _python_files(Path(ros_in_python.__file__).parent, "ros_in_python"):
        name = path.removeprefix("ros_in_python/importable/")  # tf2 and its kin by their own names
        if name.partition("/")[0] not in _WITHOUT_A_PAGE:
            files[name] = data
    files |= dict(_python_files(Path(interface_compiler.__file__).parent, "interface_compiler"))  # `ros2` reads with it
    files["rmw_lockstep/type_hashes.json"] = json.dumps(_type_hashes(), sort_keys=True).encode()
    middleware = Path(rmw_lockstep.__file__).parent
    for name in ("__init__.py", "qos.py", "type_hash.py"):
        files[f"rmw_lockstep/{name}"] = (middleware / name).read_bytes()
    # Of a package in two archives, Python sees only one: the hub, which checks use, is here, too.
    files |= _part(middleware / "hub", "rmw_lockstep/hub")
    root = Path(spinbook.__file__).parent
    for part in _SPINBOOK:
        files |= _part(root / part, f"spinbook/{part}")
    files["spinbook/kernel/reply_reader.py"] = (root / "browser" / "in_page" / "reply_reader.py").read_bytes()
    files["numpy.py"] = (root / "browser" / "numpy_fallback" / "numpy.py").read_bytes()
    files |= _used_outside_checks(root.parent / "grader")
    files |= dict(_python_files(root.parent / "grader" / "recording", "grader/recording"))
    return zipped(files)


def interface_packages() -> list[str]:
    """Return the packages of messages, services and actions that are installed, or compiled for the course."""
    return sorted(name for name in _share_folders() if importlib.util.find_spec(name))


def _share_folders() -> dict[str, Path]:
    """Return the `share` folder of each package of interfaces, by the package's name."""
    markers = prefixes.resources("rosidl_interfaces", prefixes.installed())
    return {name: marker.parents[3] for name, marker in markers.items()}


def share_archive() -> bytes:
    """Return the ament index and the interface files that `ros2 interface show` prints."""
    files, shares = {}, _share_folders()
    for package in interface_packages():
        share = shares[package]
        for kind in _INDEXED:
            entry = share / "ament_index" / "resource_index" / kind / package
            if entry.is_file():
                files[entry.relative_to(share.parent).as_posix()] = entry.read_bytes()
        for file in sorted((share / package).rglob("*")):
            if file.suffix in _TEXTS:
                files[file.relative_to(share.parent).as_posix()] = file.read_bytes()
    robots = (file for file in sorted(EXAMPLES.rglob("*")) if file.is_file())
    return zipped({**files, **{file.relative_to(EXAMPLES).as_posix(): file.read_bytes() for file in robots}})


def check_archive(exercises: Mapping[str, bytes]) -> bytes:
    """Return pytest, the part of the grader that judges, and the exercises' public parts: path -> content."""
    modules = {name: data for package in _CHECKS for name, data in _module(package)}
    files = {name: data for name, data in modules.items() if _needed(name)}
    root = Path(spinbook.__file__).parent.parent / "grader"
    for part in _GRADER:
        files |= _part(root / part, f"grader/{part}")
    files["grader/checking/hints.md"] = (root / "checking" / "hints.md").read_bytes()
    # A page has no sandbox: leave out reader.py, which needs one, and the imports of the package itself.
    del files["grader/submission/reader.py"]
    files["grader/submission/__init__.py"] = b""
    return zipped({**_used_outside_checks(root), **files, **exercises})


def _used_outside_checks(grader: Path) -> dict[str, bytes]:
    """Return the grader's files that every process of a page may need: hidden modules, messages as fields, problems."""
    empty = {f"grader/{name}": b"" for name in ("__init__.py", "runner/__init__.py")}
    used = {f"grader/{name}": (grader / name).read_bytes() for name in ("preloaded.py", "runner/message.py")}
    shared = Path(groundwork.__file__).parent
    names = ("__init__.py", "plain_data.py", "problem.py", "process_exit.py", "words.py")
    shown = {f"groundwork/{name}": (shared / name).read_bytes() for name in names}
    return empty | used | shown


def _needed(name: str) -> bool:
    package, _, file = name.rpartition("/")
    return package != "pygments/lexers" or file in _LEXERS


def _module(name: str) -> Iterator[tuple[str, bytes]]:
    """Yield the files of an installed module: one, or a package's."""
    spec = importlib.util.find_spec(name)
    if spec is None or spec.origin is None:
        raise ModuleNotFoundError(f"{name} is not installed in {sys.prefix}")
    file = Path(spec.origin)
    if spec.submodule_search_locations:
        yield from _python_files(file.parent, name)
    else:
        yield file.name, file.read_bytes()


def _part(path: Path, name: str) -> dict[str, bytes]:
    return {name: path.read_bytes()} if path.is_file() else dict(_python_files(path, name))


def _python_files(folder: Path, name: str) -> Iterator[tuple[str, bytes]]:
    for file in sorted(folder.rglob("*")):
        inside = file.relative_to(folder)
        if file.suffix in (".py", ".html", ".j2", ".json", ".lark") and "__pycache__" not in inside.parts:
            yield f"{name}/{inside.as_posix()}", file.read_bytes()


def _type_hashes() -> dict[str, str]:
    hashes: dict[str, str] = {}
    shares = _share_folders()
    for package in interface_packages():
        for file in sorted((shares[package] / package).rglob("*.json")):
            for item in json.loads(file.read_text(encoding="utf-8")).get("type_hashes", ()):
                hashes[item["type_name"]] = item["hash_string"]
    return hashes
