"""`rclpy.spin` in the notebook's own process, as in a node's cell without its `%%node` line: said, and ended by Stop.

rclpy waits in C, where Python can't raise the KeyboardInterrupt of the Stop button, and its own handler of SIGINT would
shut ROS 2 down for good. So a notebook's rclpy waits in short slices, and without a handler of its own.
"""

from __future__ import annotations

import functools
import re
from typing import Any

#: How long one wait takes at most, and so how long Stop may take (s).
_SLICE_S = 0.1

#: A program that forgets to import rclpy must fail as in a new Python, so it is not imported for any other cell.
_IMPORT = re.compile(r"^[ \t]*(?:import|from)[ \t]+rclpy\b", re.MULTILINE)

_NOTE = (
    "— `rclpy.spin` runs in the notebook itself, so no other cell can run until you press Stop (■). To run this cell "
    "as a node in the background, make `%%node {name}` its first line. —"
)


class SpinInCell:
    """Watches for cells that use rclpy. `nodes` has the code of each node's cell, by the node's name."""

    def __init__(self, nodes: dict[str, str]) -> None:
        self._nodes = nodes
        self._cell = ""
        self._prepared = False

    def before_cell(self, info: Any) -> None:
        """Prepare rclpy before the first cell that imports it; IPython calls this before each cell."""
        self._cell = info.raw_cell or ""
        self._said = False
        if not self._prepared and _IMPORT.search(self._cell) and not self._cell.lstrip().startswith("%%"):
            self._prepared = True
            self._prepare()

    def _prepare(self) -> None:
        import rclpy
        from rclpy.executors import Executor
        from rclpy.signals import SignalHandlerOptions

        rclpy.init = functools.partial(rclpy.init, signal_handler_options=SignalHandlerOptions.NO)
        until = Executor.spin_until_future_complete

        def spin(executor: Executor) -> None:
            self._say()
            while executor.context.ok() and not executor._is_shutdown:
                executor.spin_once(_SLICE_S)

        def spin_node(node: Any, executor: Executor | None = None) -> None:
            executor = executor or rclpy.get_global_executor()
            try:
                executor.add_node(node)
                executor.spin()
            finally:
                executor.remove_node(node)

        def spin_until(executor: Executor, future: Any, timeout_sec: float | None = None) -> None:
            if timeout_sec is not None and timeout_sec >= 0:
                until(executor, future, timeout_sec)
                return
            while executor.context.ok() and not future.done() and not executor._is_shutdown:
                until(executor, future, _SLICE_S)

        for place, name, ours in (
            (Executor, "spin", spin),
            (Executor, "spin_until_future_complete", spin_until),
            (rclpy, "spin", spin_node),
        ):
            setattr(place, name, ours)

    def _say(self) -> None:
        if self._said:
            return
        self._said = True
        same = (name for name, code in self._nodes.items() if code.strip() == self._cell.strip())
        print(_NOTE.format(name=next(same, "my_node")), flush=True)
