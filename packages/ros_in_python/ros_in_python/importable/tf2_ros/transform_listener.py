"""Puts what is published on /tf and /tf_static into a buffer."""

from __future__ import annotations

from contextlib import suppress
from threading import Event, Thread, current_thread
from typing import Any

from rclpy.callback_groups import ReentrantCallbackGroup
from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile
from tf2_msgs.msg import TFMessage

from tf2_ros.buffer import Buffer

#: The most time until the listener's own thread notices that it shall end (s).
_NOTICE_S = 0.1

DEFAULT_TF_TOPIC = "/tf"
DEFAULT_STATIC_TF_TOPIC = "/tf_static"


class TransformListener:
    """Subscribes to /tf and /tf_static, and keeps what comes in `buffer`. Keep a reference to it in your node."""

    def __init__(
        self,
        buffer: Buffer,
        node: Node,
        *,
        spin_thread: bool = False,
        qos: QoSProfile | int | None = None,
        static_qos: QoSProfile | int | None = None,
        tf_topic: str = DEFAULT_TF_TOPIC,
        static_tf_topic: str = DEFAULT_STATIC_TF_TOPIC,
    ) -> None:
        self.buffer, self.node = buffer, node
        self._stopped = Event()
        self._thread: Thread | None = None
        # Reentrant: a callback of the node that waits for a transform must not keep transforms from arriving.
        self.group = ReentrantCallbackGroup()
        keep = HistoryPolicy.KEEP_LAST
        moving = QoSProfile(depth=100, history=keep) if qos is None else qos
        latched = QoSProfile(depth=100, history=keep, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.tf_sub = node.create_subscription(TFMessage, tf_topic, self.callback, moving, callback_group=self.group)
        self.tf_static_sub = node.create_subscription(
            TFMessage,
            static_tf_topic,
            self.static_callback,
            latched if static_qos is None else static_qos,
            callback_group=self.group,
        )
        if spin_thread:
            self.executor = SingleThreadedExecutor(context=node.context)
            self.executor.add_node(node)
            self._thread = Thread(target=self._spin, daemon=True)
            self._thread.start()

    def _spin(self) -> None:
        with suppress(ExternalShutdownException):
            while not self._stopped.is_set():
                self.executor.spin_once(timeout_sec=_NOTICE_S)

    def __del__(self) -> None:
        """Stop the subscriptions, and the thread if there is one."""
        self.unregister()

    def unregister(self) -> None:
        """Destroy both subscriptions, and no longer spin the node in a thread of its own."""
        self._stopped.set()
        if self._thread and self._thread is not current_thread():
            self._thread.join()
        for name in ("tf_sub", "tf_static_sub"):
            subscription = self.__dict__.pop(name, None)
            if subscription is not None and self.node.context.ok():
                self.node.destroy_subscription(subscription)

    def callback(self, data: Any) -> None:
        """Take the transforms of one message on /tf."""
        for transform in data.transforms:
            self.buffer.set_transform(transform, "default_authority")

    def static_callback(self, data: Any) -> None:
        """Take the transforms of one message on /tf_static."""
        for transform in data.transforms:
            self.buffer.set_transform_static(transform, "default_authority")
