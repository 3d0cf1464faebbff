"""Checks of ROS 2: whether rclpy and its libraries load, and settings that surprise people."""

from __future__ import annotations

import importlib
import os
import sys
from collections.abc import Iterator
from importlib.metadata import version as distribution_version
from pathlib import Path
from xml.etree import ElementTree

from groundwork.clean_environment import GUARD, ignored
from spinbook.doctor.diagnosis import MachineFinding, missing, ok, set_up_again, warning
from spinbook.doctor.ros_origin import NoRos, ros_origin, this_machine
from spinbook.kernel.environment import HIGHEST, LOOPBACK_PROFILE

#: Packages of messages that the chapters and the grader use.
MESSAGES = ("builtin_interfaces", "geometry_msgs", "rosgraph_msgs", "sensor_msgs", "std_msgs", "std_srvs")


def examine_ros_library() -> MachineFinding:
    """Import rclpy with its compiled part and a type support, and compare with what else is installed."""
    # A missing middleware would end this process. middleware.py checks that.
    os.environ.pop("RMW_IMPLEMENTATION", None)
    try:
        sourced = ros_origin(os.environ, this_machine()).sourced
        package = Path(importlib.import_module("rclpy").__path__[0])
        _load_messages()
    except NoRos as error:
        return missing(*str(error).split("\n", 1))
    except ImportError as error:
        return missing(str(error).splitlines()[0], _fix_of(error))
    wheels = wheels_installed()
    version = distribution_version("ros-rclpy") if wheels and not sourced else _version_of(package)
    if sourced and wheels:
        return missing(
            f"two installations: rclpy {version} from {package.parent}, and PyPI's wheels in {sys.prefix}",
            f"It would be random which libraries are loaded. {set_up_again()}",
        )
    return ok(f"rclpy {version}, {'PyPI wheels' if wheels else 'sourced'}, {package.parent}")


def wheels_installed() -> bool:
    """Return whether the wheels from PyPI are installed in this environment."""
    return any(Path(sys.prefix).glob("lib/python3*/site-packages/ros_rclpy-*.dist-info"))


def _load_messages() -> None:
    for package in ("rclpy.impl.implementation_singleton", *MESSAGES):
        importlib.import_module(package)
    support = importlib.import_module("rclpy.type_support")
    support.check_for_type_support(importlib.import_module("sensor_msgs.msg").JointState)


def _version_of(package: Path) -> str:
    """Return the version in rclpy's package.xml, with the name of the ROS distribution if it is known."""
    distro = os.environ.get("ROS_DISTRO", "")
    for prefix in package.parents:
        manifest = prefix / "share" / "rclpy" / "package.xml"
        if manifest.is_file():
            version = ElementTree.parse(manifest).findtext("version") or "of unknown version"
            return f"{version} ({distro})" if distro else version
    return "of unknown version"


def _fix_of(error: ImportError) -> str:
    absent = (error.name or "").split(".")[0]
    if "cannot open shared object file" in str(error):
        return "A library is missing. Open a new terminal; if you source ROS 2, source its setup file again."
    if absent in MESSAGES and os.environ.get("ROS_DISTRO"):
        return f"sudo apt-get install ros-{os.environ['ROS_DISTRO']}-common-interfaces"
    return set_up_again()


_PROFILES = ("FASTRTPS_DEFAULT_PROFILES_FILE", "FASTDDS_DEFAULT_PROFILES_FILE")
_WATCHED = (
    "ROS_DOMAIN_ID",
    "ROS_AUTOMATIC_DISCOVERY_RANGE",
    "ROS_LOCALHOST_ONLY",
    "ROS_STATIC_PEERS",
    "ROS_DISCOVERY_SERVER",
    "FASTDDS_BUILTIN_TRANSPORTS",
    *_PROFILES,
)


def examine_ros_settings() -> MachineFinding:
    """Check the variables that decide which nodes discover each other."""
    surprises = [*_other_installations(), *_domain(), *_profiles(), *_discovery()]
    if surprises:
        return warning("; ".join(found for found, _ in surprises), "\n".join(fix for _, fix in surprises))
    is_set = [f"{variable}={os.environ[variable]}" for variable in _WATCHED if os.environ.get(variable)]
    return ok(", ".join(is_set) or "none set: domain 0, notebooks in domains of their own")


#: What is set, and what to do about it.
_Surprises = Iterator[tuple[str, str]]


def _other_installations() -> _Surprises:
    values = ignored()
    if names := sorted(values.keys() - {GUARD}):
        shown = ", ".join(f"{name}={values[name]}" for name in names)
        yield (
            f"of another installation, so Spinbook's programs do not use it: {shown}",
            f"Jupyter and your own programs still do. If they fail: unset {' '.join(names)}",
        )


def _domain() -> _Surprises:
    text = os.environ.get("ROS_DOMAIN_ID", "")
    if text and not (text.isdecimal() and int(text) <= HIGHEST):
        yield (
            f"ROS_DOMAIN_ID is '{text}'",
            f"Use a domain from 0 to {HIGHEST}, because others have no free ports: export ROS_DOMAIN_ID=0",
        )


def _profiles() -> _Surprises:
    for variable in _PROFILES:
        file = os.environ.get(variable, "")
        if file and not Path(file).is_file():
            yield f"{variable} names {file}, which does not exist", f"unset {variable}"
        elif file and Path(file) != LOOPBACK_PROFILE:
            yield (
                f"{variable}={file}",
                "Notebooks and the grader use profiles of their own in its place; your terminals use this one. "
                f"If they do not receive each other's messages: unset {variable}",
            )


def _discovery() -> _Surprises:
    if os.environ.get("ROS_AUTOMATIC_DISCOVERY_RANGE", "").upper() == "OFF":
        yield (
            "ROS_AUTOMATIC_DISCOVERY_RANGE is OFF",
            "Nodes in terminals won't discover each other: unset ROS_AUTOMATIC_DISCOVERY_RANGE",
        )
    if os.environ.get("ROS_DISCOVERY_SERVER"):
        yield (
            "ROS_DISCOVERY_SERVER is set",
            "Nodes in terminals use that server for discovery, and notebooks do not: unset ROS_DISCOVERY_SERVER",
        )


# The wheels set LD_LIBRARY_PATH themselves: their .pth file restarts Python with it, and sets a guard variable. If the
# guard is inherited without the path, or from another environment, Python is not restarted.


def examine_library_path() -> MachineFinding:
    """Check that LD_LIBRARY_PATH leads to this environment's libraries and to no others."""
    entries = [Path(entry) for entry in os.environ.get("LD_LIBRARY_PATH", "").split(os.pathsep) if entry]
    with_ros = list(dict.fromkeys(entry for entry in entries if (entry / "librcl.so").exists()))
    own = Path(sys.prefix, "lib")
    if not wheels_installed():
        return ok(", ".join(map(str, with_ros)) or "no ROS libraries on it")
    if own not in entries:
        return missing(
            f"{GUARD} is set, but LD_LIBRARY_PATH does not name {own}",
            f"LD_LIBRARY_PATH was lost, but the guard was not. Remove both: unset {GUARD} LD_LIBRARY_PATH",
        )
    others = [str(entry) for entry in with_ros if entry != own]
    if others:
        return warning(
            f"{own}, and also {', '.join(others)}",
            "Libraries of another ROS may be loaded. Use a terminal in which neither another environment is active nor "
            f"a ROS setup file is sourced, or: unset {GUARD} LD_LIBRARY_PATH",
        )
    return ok(f"{own}, set by the wheels themselves")
