"""The list of checks, in the order in which they are told."""

from __future__ import annotations

from dataclasses import dataclass


@dataclass(frozen=True)
class Check:
    """One thing to look at.

    `module` is the file of this folder whose `examine(name)` does it. `seconds` is how long it may take.
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
    Check("python", "Python", "python_version"),
    Check("folder", "Folder", "folder"),
    Check("libraries", "Library path", "library_path"),
    Check("ros", "ROS 2", "ros_library", 30.0, ("libraries",)),
    Check("middleware", "Middleware", "middleware", 30.0, ("ros",)),
    Check("logs", "Log folder", "log_folder"),
    Check("message", "A message", "message", 60.0, _NODE),
    Check("environment", "ROS settings", "ros_settings"),
    Check("memory", "Shared memory", "shared_memory"),
    Check("kernel", "Jupyter kernel", "kernel", 60.0),
    Check("colcon", "colcon", "colcon", 90.0),
    Check("namespaces", "Namespaces", "namespaces"),
    Check("sandbox", "Sandbox", "sandbox", 150.0, _NODE),
    Check("bubblewrap", "bubblewrap", "bubblewrap"),
    Check("ros2", "ros2, turtlesim", "ros2_command"),
    Check("browser", "Browser", "browser", 45.0),
)
