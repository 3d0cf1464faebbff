"""Prints the node graph of ROS_DOMAIN_ID as it is now, as JSON: `python -m spinbook.graph.now [SECONDS]`.

For so many seconds it listens to every topic that is published, to know the rates.
"""

from __future__ import annotations

import sys
import time

from spinbook.graph.model import NodeGraph
from spinbook.graph.sight import GraphWatcher
from spinbook.ros2.cli import CommandError


def graph_now(seconds: float) -> NodeGraph:
    """The graph, with the rates of what could be counted within `seconds`."""
    with GraphWatcher() as watcher:
        watcher.wait_until_idle()
        deadline = time.monotonic() + seconds
        while time.monotonic() < deadline and watcher.count(unheard=True):
            pass
        watcher.stop_counting()
        return watcher.graph()


def main() -> None:
    """Look once."""
    try:
        print(graph_now(float(sys.argv[1]) if len(sys.argv) > 1 else 0.0).to_json())
    except CommandError as error:
        sys.exit(error.format_message())


if __name__ == "__main__":
    main()
