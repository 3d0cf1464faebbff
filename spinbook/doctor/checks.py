"""The list of checks, in the order in which they are told."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Check:
    """One thing to look at.

    `module` is the one whose `examine(name)` does it. `seconds` is how long it may take.
    `needs` are the words of earlier checks without which this one can only fail, so that a cause is told once.
    """

    word: str
    name: str
    module: str
    seconds: float = 15.0
    needs: tuple[str, ...] = ()


#: What every node needs.
_NODE = ("ros", "libraries", "middleware", "logs")


CHECKS = (
    Check("python", "Python", "spinbook.doctor.python_version"),
    Check("folder", "Folder", "spinbook.doctor.folder"),
    Check("libraries", "Library path", "spinbook.doctor.library_path"),
    Check("ros", "ROS 2", "spinbook.doctor.ros_library", 30.0, ("libraries",)),
    Check("middleware", "Middleware", "spinbook.doctor.middleware", 30.0, ("ros",)),
    Check("logs", "Log folder", "spinbook.doctor.log_folder"),
    Check("message", "A message", "spinbook.doctor.message", 60.0, _NODE),
    Check("environment", "ROS settings", "spinbook.doctor.ros_settings"),
    Check("memory", "Shared memory", "spinbook.doctor.shared_memory"),
    Check("kernel", "Jupyter kernel", "spinbook.doctor.kernel", 60.0),
    Check("colcon", "colcon", "spinbook.doctor.colcon", 90.0),
    Check("compiler", "Compiler", "spinbook.doctor.compiler"),
    Check("namespaces", "Namespaces", "spinbook.doctor.namespaces"),
    Check("sandbox", "Sandbox", "spinbook.doctor.sandbox", 150.0, _NODE),
    Check("bubblewrap", "bubblewrap", "spinbook.doctor.bubblewrap"),
    Check("lockstep", "Lockstep", "spinbook.doctor.lockstep", 30.0, ("ros",)),
    Check("ros2", "ros2, turtlesim", "spinbook.doctor.ros2_command"),
    Check("browser", "Browser", "spinbook.doctor.browser", 45.0),
)
