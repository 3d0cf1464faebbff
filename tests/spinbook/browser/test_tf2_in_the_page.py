"""A program with tf2 runs in a page: from the page's own archive, over rcl_python, without numpy."""

from __future__ import annotations

import io
import os
import subprocess
import sys
import zipfile
from pathlib import Path

from spinbook.browser.archives import ros_archive

PROGRAM = """
import rcl_python
rcl_python.install()
import rclpy
import tf2_geometry_msgs
from geometry_msgs.msg import PointStamped, TransformStamped
from rclpy.node import Node
from rclpy.time import Time
from tf2_ros import Buffer, StaticTransformBroadcaster, TransformListener

rclpy.init()
node = Node("frames")
buffer = Buffer()
listener = TransformListener(buffer, node)
camera = TransformStamped(child_frame_id="camera")
camera.header.frame_id = "base"
camera.transform.translation.z = 0.5
StaticTransformBroadcaster(node).sendTransform(camera)
rclpy.spin_until_future_complete(node, buffer.wait_for_transform_async("base", "camera", Time()))
point = PointStamped()
point.header.frame_id = "camera"
point.point.x = 2.0
print(buffer.transform(point, "base").point)
"""


def test_a_broadcast_frame_is_looked_up_and_a_point_moved(tmp_path: Path, ros_domain: int) -> None:
    with zipfile.ZipFile(io.BytesIO(ros_archive())) as archive:
        archive.extractall(tmp_path)
    (tmp_path / "program.py").write_text(PROGRAM)
    done = subprocess.run(
        [sys.executable, "-S", str(tmp_path / "program.py")], cwd=tmp_path, env={**os.environ, "PYTHONPATH": ""},
        capture_output=True, text=True, check=False,
    )  # fmt: skip
    assert done.stdout == "geometry_msgs.msg.Point(x=2.0, y=0.0, z=0.5)\n", done.stderr
