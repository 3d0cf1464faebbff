"""Opens a view of the ROS graph, once the environment is known to be one that rclpy can work in."""

from __future__ import annotations

from typing import TYPE_CHECKING

from spinbook.ros2.middleware import prepare

if TYPE_CHECKING:
    from spinbook.ros2.graph import Graph


def open_graph(*, node_name: str | None = None, spin_time: float | None = None, use_sim_time: bool = False) -> Graph:
    """Check the environment, then create a node of ours that looks at the graph (a context manager).

    `spin_time` bounds discovery, in seconds. Raises `CommandError` for an environment that rclpy can't work in.
    """
    prepare()
    from spinbook.ros2.graph import Graph

    return Graph(node_name=node_name, spin_time=spin_time, use_sim_time=use_sim_time)
