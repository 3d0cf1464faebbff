"""Whether rclpy and its messages load, which they are, and that there is only one of them."""

from __future__ import annotations

import importlib
import os
import sys
from importlib.metadata import version as distribution_version
from pathlib import Path
from xml.etree import ElementTree

from spinbook.doctor.finding import Finding, missing, ok
from spinbook.doctor.ros_origin import NoRos, ros_origin, this_machine

#: Packages that the chapters and the grader use.
MESSAGES = ("builtin_interfaces", "geometry_msgs", "rosgraph_msgs", "sensor_msgs", "std_msgs", "std_srvs")
_MAKE_ANEW = "Make the environment anew, in the terminal that you want to use: make setup"


def examine(name: str) -> Finding:
    """Import rclpy with its compiled part and a type support, and compare with what else is installed."""
    # A middleware that is not installed would end this process. It is a matter of its own: see middleware.py.
    os.environ.pop("RMW_IMPLEMENTATION", None)
    try:
        sourced = ros_origin(os.environ, this_machine()).sourced
        package = Path(importlib.import_module("rclpy").__path__[0])
        _load_messages()
    except NoRos as error:
        return missing(name, *str(error).split("\n", 1))
    except ImportError as error:
        return missing(name, str(error).splitlines()[0], _mend_of(error))
    wheels = wheels_installed()
    version = distribution_version("ros-rclpy") if wheels and not sourced else _version_of(package)
    if sourced and wheels:
        return missing(
            name,
            f"two of them: rclpy {version} from {package.parent}, and PyPI's wheels in {sys.prefix}",
            f"Which libraries are loaded would be chance. {_MAKE_ANEW}",
        )
    return ok(name, f"rclpy {version}, {'PyPI wheels' if wheels else 'sourced'}, {package.parent}")


def wheels_installed() -> bool:
    """Whether this environment holds the wheels from PyPI."""
    return any(Path(sys.prefix).glob("lib/python3*/site-packages/ros_rclpy-*.dist-info"))


def _load_messages() -> None:
    for package in ("rclpy.impl.implementation_singleton", *MESSAGES):
        importlib.import_module(package)
    support = importlib.import_module("rclpy.type_support")
    support.check_for_type_support(importlib.import_module("sensor_msgs.msg").JointState)


def _version_of(package: Path) -> str:
    """The version in the package.xml that every ROS installation has; the distribution's name where it is sourced."""
    distro = os.environ.get("ROS_DISTRO", "")
    for prefix in package.parents:
        manifest = prefix / "share" / "rclpy" / "package.xml"
        if manifest.is_file():
            version = ElementTree.parse(manifest).findtext("version") or "of unknown version"
            return f"{version} ({distro})" if distro else version
    return "of unknown version"


def _mend_of(error: ImportError) -> str:
    absent = (error.name or "").split(".")[0]
    if "cannot open shared object file" in str(error):
        return "The library is not found: open a new terminal. Where ROS 2 is sourced, source its setup file again."
    if absent in MESSAGES and os.environ.get("ROS_DISTRO"):
        return f"sudo apt-get install ros-{os.environ['ROS_DISTRO']}-common-interfaces"
    return _MAKE_ANEW
