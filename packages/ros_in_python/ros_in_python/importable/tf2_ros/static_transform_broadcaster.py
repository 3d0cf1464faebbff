"""Sends transforms that never change, also to those who come later."""

from __future__ import annotations

from collections.abc import Iterable

from geometry_msgs.msg import TransformStamped
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, HistoryPolicy, QoSProfile
from tf2_msgs.msg import TFMessage


class StaticTransformBroadcaster:
    """Publishes all transforms that it was given as one latched message on /tf_static."""

    def __init__(self, node: Node, qos: QoSProfile | int | None = None) -> None:
        latched = QoSProfile(depth=1, history=HistoryPolicy.KEEP_LAST, durability=DurabilityPolicy.TRANSIENT_LOCAL)
        self.pub_tf = node.create_publisher(TFMessage, "/tf_static", latched if qos is None else qos)
        self.net_message = TFMessage()

    def sendTransform(self, transform: TransformStamped | Iterable[TransformStamped]) -> None:  # noqa: N802
        """Send one transform or several, together with all earlier ones: the newest of each child frame."""
        several = [transform] if isinstance(transform, TransformStamped) else list(transform)
        newest = {one.child_frame_id: one for one in (*self.net_message.transforms, *several)}
        self.net_message = TFMessage(transforms=list(newest.values()))
        self.pub_tf.publish(self.net_message)
