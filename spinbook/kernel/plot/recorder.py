"""Records numbers from topics and prints them, one JSON array per line, in its own process next to the kernel.

    python -m spinbook.kernel.plot.recorder PATH …

Lines: ["looking"] once it takes part in ROS, ["waiting", [paths not found yet], [topics there are]], ["topics", [those
found, in the order of the paths]], ["sample", topic, kind, unit, label, time (s), value], ["error", words]. A process
rather than a thread: the kernel then needs no rclpy, and its Stop button can't break it.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable, Sequence
from functools import partial
from typing import Any

import rclpy
from rclpy.context import Context
from rclpy.executors import ExternalShutdownException
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile, ReliabilityPolicy

from ros_in_python.ros2.interfaces import message_class
from spinbook.kernel.plot.quantity import TopicPath, quantities, resolve, stamp_of
from spinbook.kernel.recorder_lines import errors_written, write_line

#: Compatible with publishers of every reliability and durability.
_HEARS_ALL = QoSProfile(depth=100, reliability=ReliabilityPolicy.BEST_EFFORT, durability=DurabilityPolicy.VOLATILE)


class PlotRecorder(Node):
    """Subscribes to the topics that paths name, and passes each number from them to `write`, as a line."""

    def __init__(
        self, paths: Sequence[str], write: Callable[..., None] = write_line, context: Context | None = None
    ) -> None:
        super().__init__("_spinbook_plot", context=context, start_parameter_services=False)
        self._paths: dict[str, TopicPath | None] = dict.fromkeys(paths)
        self._write = write
        write("looking")
        self._look()
        self.create_timer(0.05, self._look)

    def _look(self) -> None:
        published = {
            topic: types[0] for topic, types in self.get_topic_names_and_types() if self.count_publishers(topic)
        }
        new = {path: resolve(path, published) for path, known in self._paths.items() if known is None}
        self._paths |= new
        by_topic: dict[str, list[TopicPath]] = {}
        for found in filter(None, new.values()):
            by_topic.setdefault(found.topic, []).append(found)
        for topic, paths in by_topic.items():
            self._subscribe(topic, published[topic], paths)
        if by_topic:
            self._write("topics", list(dict.fromkeys(path.topic for path in self._paths.values() if path)))
        if missing := [path for path, known in self._paths.items() if known is None]:
            self._write("waiting", missing, sorted(t for t in published if t not in {"/rosout", "/parameter_events"}))

    def _subscribe(self, topic: str, full_type: str, paths: Sequence[TopicPath]) -> None:
        """Subscribe once for all paths into the messages of a topic, so that their values come in the paths' order."""
        short = full_type.replace("/msg/", "/")
        kind = message_class(full_type)
        for path in paths:
            list(quantities(path, kind(), short))  # raises if the type has no such field, before any message arrives
        self.create_subscription(kind, topic, partial(self._on_message, paths, short), _HEARS_ALL)

    def _on_message(self, paths: Sequence[TopicPath], type_name: str, message: Any) -> None:
        now = stamp_of(message) or time.time()
        for path in paths:
            for quantity, value in quantities(path, message, type_name):
                self._write("sample", quantity.topic, quantity.kind, quantity.unit, quantity.label, now, value)


def record_until_stopped(recorder: Callable[[], Node]) -> None:
    """Make a recorder, and let it record until its process is stopped."""
    rclpy.init()
    try:
        with errors_written():
            _record(recorder())
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    except (LookupError, ValueError) as error:
        write_line("error", str(error.args[0] if error.args else error))
    finally:
        rclpy.try_shutdown()


def _record(recorder: Node) -> None:
    try:
        rclpy.spin(recorder)
    finally:
        # Otherwise its end is not announced, and others see it for another minute.
        recorder.destroy_node()


if __name__ == "__main__":
    record_until_stopped(lambda: PlotRecorder(sys.argv[1:]))
