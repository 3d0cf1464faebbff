"""A view of the ROS graph, opened only if rclpy can work in this environment.

That has to be checked before rclpy is imported, which would end the process without a message.
"""

from __future__ import annotations

import functools
import os
import tempfile
from pathlib import Path
from typing import TYPE_CHECKING, Any, cast

from interface_compiler import prefixes
from ros_in_python.ros2.cli import CommandError, F, discovery_options
from ros_in_python.ros2.domain import domain_id

if TYPE_CHECKING:
    from ros_in_python.ros2.graph import GraphView


def open_graph(
    *, node_name: str | None = None, spin_time: float | None = None, use_sim_time: bool = False
) -> GraphView:
    """Check the environment, then create a node of ours that looks at the graph (a context manager).

    `spin_time` bounds discovery, in seconds. Raises `CommandError` for an environment that rclpy can't work in.
    """
    prepare()
    from ros_in_python.ros2.graph import GraphView

    return GraphView(node_name=node_name, spin_time=spin_time, use_sim_time=use_sim_time)


def with_graph(command: F) -> F:
    """Give a command the graph as its first argument, and the real command's options for discovery."""

    @functools.wraps(command)
    def run(*, spin_time: float | None, use_sim_time: bool, **given: Any) -> Any:
        with open_graph(spin_time=spin_time, use_sim_time=use_sim_time) as graph:
            return command(graph, **given)

    return cast("F", discovery_options(run))


def prepare() -> None:
    """Raise `CommandError` for what would make rclpy fail, and give it a folder for its logs."""
    check_installed()
    _check_rmw()
    domain_id()
    _give_log_folder()


def check_installed() -> None:
    """Raise `CommandError` if there is no rclpy, or PyPI's without Fast DDS, as where programs are only graded."""
    import importlib.util

    if importlib.util.find_spec("rclpy") is None:
        raise CommandError(
            "ROS 2's Python library, rclpy, is not installed for this Python.",
            "On Linux x86_64: pip install 'ros-jazzy-rclpy[fastrtps]' ros-jazzy-common-interfaces",
            "Elsewhere, use a ROS 2 installation or a ros:jazzy container.",
        )
    if list(prefixes.resources("rmw_typesupport", prefixes.installed())) == ["rmw_implementation"]:
        raise CommandError(
            "rclpy is installed without Fast DDS, which nodes need.",
            "Install it: pip install 'ros-jazzy-rclpy[fastrtps]'",
        )


def _check_rmw() -> None:
    middleware = os.environ.get("RMW_IMPLEMENTATION")
    if not middleware:
        return
    here = prefixes.resources("rmw_typesupport", prefixes.installed())
    here.pop("rmw_implementation", None)
    if here and middleware not in here:
        raise CommandError(
            f"RMW_IMPLEMENTATION is '{middleware}', which is not installed here.",
            f"Installed: {', '.join(here)}. Set it to one of these, or unset it: unset RMW_IMPLEMENTATION",
        )


def _give_log_folder() -> None:
    """Set HOME and ROS_LOG_DIR if rclpy could not find or write the folder of its logs, which is below HOME."""
    # Without HOME, rclpy fails even if ROS_LOG_DIR is set.
    home = os.environ.setdefault("HOME", os.path.expanduser("~"))  # noqa: PTH111 (Path.home raises where there is none)
    if os.environ.get("ROS_LOG_DIR") or os.environ.get("ROS_HOME"):
        return
    if not os.access(home, os.W_OK | os.X_OK):
        os.environ["ROS_LOG_DIR"] = str(Path(tempfile.gettempdir(), f"ros-log-{os.getuid()}"))
