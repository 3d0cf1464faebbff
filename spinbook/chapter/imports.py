"""Checks whether a program's imports are available: packages, their modules, ROS interfaces."""

from __future__ import annotations

import functools
import importlib.util
import sys
from collections.abc import Collection, Mapping
from dataclasses import dataclass
from pathlib import Path

import ros_in_python
from grader.submission.python_code import MATPLOTLIB
from groundwork.words import did_you_mean, similar
from interface_compiler import prefixes, shipped
from spinbook.chapter.python_code import PythonCode
from spinbook.chapter.terminal import is_placeholder

#: Module -> its package on PyPI, if the two names differ or Spinbook's own extra `plots` brings it.
_DISTRIBUTIONS = {
    "cv2": "opencv-python",
    "PIL": "pillow",
    "yaml": "PyYAML",
    "sklearn": "scikit-learn",
    "serial": "pyserial",
    **dict.fromkeys(MATPLOTLIB, "matplotlib"),
}
#: Packages that exist but may not be installed here, so that none is taken for a misspelling of another.
_REAL = frozenset(
    [
        *("nav2_msgs", "control_msgs", "moveit_msgs", "vision_msgs", "tf2_msgs", "shape_msgs", "stereo_msgs"),
        *("map_msgs", "object_recognition_msgs", "trajectory_msgs", "visualization_msgs", "diagnostic_msgs"),
        *("actionlib_msgs", "geographic_msgs", "audio_common_msgs"),
    ]
)
#: Python modules of ROS 2 that PyPI does not have.
_ONLY_IN_ROS = frozenset(
    [
        *("image_geometry", "image_transport_py", "laser_geometry"),
        *("rqt_gui", "rqt_gui_py", "nav2_simple_commander", "moveit_py", "robot_localization", "diagnostic_updater"),
        *("moveit", "moveit_configs_utils", "nav2_common", "python_qt_binding", "rqt_py_common", "controller_manager"),
        *("ros2cli", "ros2run", "ros2launch", "launch_testing", "launch_testing_ros", "ros_gz_bridge", "gazebo_ros"),
    ]
)
#: Modules that only programs bring along.
_WITH_OTHERS = {"omni": "Isaac Sim", "carb": "Isaac Sim", "pxr": "Isaac Sim", "rospy": "ROS 1", "roslib": "ROS 1"}
_WITH_OTHERS |= {"moveit_commander": "ROS 1", "actionlib": "ROS 1", "tf": "ROS 1", "dynamic_reconfigure": "ROS 1"}
#: What helps if PyPI lacks a package of ROS.
IN_ROS = "run the course where a ROS installation has it"


@dataclass(frozen=True)
class MissingPackage:
    """A package that is missing here. `package` is the one to install."""

    package: str
    problem: str
    fix: str
    line: int


def missing_imports(
    code: PythonCode, own: Mapping[str, frozenset[str]], own_interfaces: Collection[str] = ()
) -> list[MissingPackage]:
    """Return what a program imports and this environment lacks.

    `own` are the chapter's and the course's packages, each with its modules; under "" the modules of both.
    `own_interfaces` are those that the course defines, such as `my_interfaces/msg/Pose`.
    """
    missing = [_relative(module, line) for module, line in code.relative_imports.items()]
    for module, line in code.imports.items():
        top, _, rest = module.partition(".")
        if module in own.get("", ()) or top in own.get("", ()):
            continue
        if top in own:
            if rest and rest.partition(".")[0] not in own[top]:
                missing.append(_not_shown(module, own[top], line))
        elif not _is_installed(top):
            missing.append(_not_installed(top, line))
        elif rest and not _has_module(top, rest):
            names = [name for (place, name) in code.interfaces if place == module]
            missing.append(_no_module(module, names, line))
    for (module, name), line in code.interfaces.items():
        known = own_names(module, own_interfaces) or interfaces_of(module)
        if known and name != "*" and name not in known:
            missing.append(_no_interface(module, name, known, line))
    return missing


def _relative(module: str, line: int) -> MissingPackage:
    stem = module.lstrip(".") or "module"
    return MissingPackage(
        "relative imports",
        f"imports `{module}`, relative to a package.",
        f"A node's cell is a file of its own: write `import {stem}`, or `from PACKAGE import {stem}`.",
        line,
    )


def _not_shown(module: str, modules: frozenset[str], line: int) -> MissingPackage:
    known = ", ".join(sorted(modules)) or "none"
    fix = f"Show its file in a fence with a `title`. Modules that the chapters show: {known}."
    return MissingPackage(module.partition(".")[0], f"imports `{module}`, which no fence shows.", fix, line)


def _not_installed(top: str, line: int) -> MissingPackage:
    if top in _DISTRIBUTIONS:
        fix = f"Install it: pip install {_DISTRIBUTIONS[top]}"
    elif close := _similar(top):
        fix = f"Did you mean `{close}`?"
    elif is_placeholder(top):
        problem = f"imports `{top}`, which stands for a name that a reader fills in."
        return MissingPackage(top, problem, "Write `static` after the language to say that this is meant.", line)
    elif top.endswith(("_msgs", "_srvs", "_interfaces", "_actions")):
        fix = remedy(top)
    elif top in _ONLY_IN_ROS:
        fix = f"PyPI does not have ROS 2's: {IN_ROS}, or write `static` after the fence's language."
    elif top in _WITH_OTHERS:
        fix = f"It comes only with {_WITH_OTHERS[top]}: write `static` after the fence's language."
    else:
        fix = (
            "If PyPI has it, add it to the course's dependencies; otherwise write `static` after the fence's language."
        )
    return MissingPackage(top, f"imports `{top}`, which is not installed here.", fix, line)


def remedy(package: str) -> str:
    """Return how to get a package of interfaces that is not here."""
    if package in shipped.known():
        return f"Compile it, once: spinbook interfaces add {package}"
    return f"PyPI does not have it: show its .msg, .srv and .action files in the chapter, or {IN_ROS}."


def _no_module(module: str, names: list[str], line: int) -> MissingPackage:
    top, _, rest = module.partition(".")
    there = sorted(name for name in _modules_in(top) if not name.startswith(("_", f"{top}_s_")))
    fix = did_you_mean(rest.partition(".")[0], there, f"It has {', '.join(there[:8])}.", f"`{top}.{{}}`")
    if elsewhere := _places_of(set(names), top):
        fix = f"Did you mean `from {elsewhere[0]} import {names[0]}`?"
    return MissingPackage(module, f"imports `{module}`, and `{top}` has no such module.", fix, line)


def _places_of(names: set[str], package: str) -> list[str]:
    """Return the modules that have interfaces of these names, those of `package` first."""
    modules = (module for module, known in _all_interfaces().items() if known & names)
    return sorted(modules, key=lambda module: (module.partition(".")[0] != package, module))


def _no_interface(module: str, name: str, known: frozenset[str], line: int) -> MissingPackage:
    otherwise = f"It has {', '.join(sorted(known)[:8])} …"
    if elsewhere := _places_of({name}, module.partition(".")[0]):
        otherwise = f"Did you mean `from {elsewhere[0]} import {name}`?"
    fix = did_you_mean(name, known, otherwise, "`{}`")
    return MissingPackage(f"{module}.{name}", f"`{module}` has no `{name}`.", fix, line)


@functools.cache
def _is_installed(module: str) -> bool:
    return module in sys.stdlib_module_names or _spec_of(module) is not None


@functools.cache
def _spec_of(module: str) -> object | None:
    try:
        return importlib.util.find_spec(module)
    except (ImportError, ValueError):
        return None


@functools.cache
def _folders(top: str) -> tuple[Path, ...]:
    """Return the folders of an installed package; none if its modules can't be determined from its files."""
    if top in sys.stdlib_module_names:
        return ()
    return tuple(Path(folder) for folder in getattr(_spec_of(top), "submodule_search_locations", None) or ())


@functools.cache
def _modules_in(top: str) -> frozenset[str]:
    names = {entry.name for folder in _folders(top) if folder.is_dir() for entry in folder.iterdir()}
    return frozenset(name.partition(".")[0] for name in names)


@functools.cache
def _has_module(top: str, rest: str) -> bool:
    """Return whether a ROS package has a module; True for other packages, which may make modules on import."""
    if not _folders(top) or not (top == "rclpy" or top in ros_packages() or top in _of_ours()):
        return True
    return rest.partition(".")[0] in _modules_in(top)


@functools.cache
def _of_ours() -> frozenset[str]:
    """Return the modules of ROS that come with ros_in_python, such as tf2_ros."""
    return frozenset(entry.name for entry in Path(ros_in_python.__file__).with_name("importable").iterdir())


def _similar(module: str) -> str:
    if module in _REAL:
        return ""
    close = similar(module, [*ros_packages(), *_of_ours(), "rclpy", "numpy", "matplotlib"], 0.8)
    # geometry_msgs_py is not a misspelt geometry_msgs.
    if module.startswith(f"{close}_") or close.startswith(f"{module}_"):
        return ""
    # Interface packages have similar names: control_msgs is not a misspelt sensor_msgs.
    (stem, _, ending), (known_stem, _, known_ending) = module.rpartition("_"), close.rpartition("_")
    return "" if stem and ending == known_ending and not similar(stem, [known_stem], 0.8) else close


@functools.cache
def ros_packages() -> frozenset[str]:
    """Return the ROS packages of this environment."""
    return frozenset(prefixes.packages(prefixes.installed()))


def interfaces_of(module: str) -> frozenset[str]:
    """Return the names in a module such as `sensor_msgs.msg`, from the interface files; empty for any other module."""
    return _all_interfaces().get(module, frozenset())


def own_names(module: str, own_interfaces: Collection[str]) -> frozenset[str]:
    """Return the names of a module such as `my_interfaces.msg` that the course defines itself."""
    beginning = module.replace(".", "/") + "/"
    return frozenset(name.removeprefix(beginning) for name in own_interfaces if name.startswith(beginning))


@functools.cache
def _all_interfaces() -> Mapping[str, frozenset[str]]:
    """Map each module of interfaces to its names, for all installed packages."""
    names_of: dict[str, set[str]] = {}
    for package, interfaces in prefixes.interfaces(prefixes.installed()).items():
        for interface in interfaces:
            kind, _, name = interface.partition("/")
            names_of.setdefault(f"{package}.{kind}", set()).add(name)
    return {module: frozenset(names) for module, names in names_of.items()}
