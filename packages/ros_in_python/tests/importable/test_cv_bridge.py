"""cv_bridge: images as arrays and back, with another order of colours or depth."""

from __future__ import annotations

import numpy as np
import pytest
from cv_bridge import CvBridge, CvBridgeError
from sensor_msgs.msg import Image
from std_msgs.msg import Header

BRIDGE = CvBridge()
#: Blue, green and red, and white.
PIXELS = np.array([[[255, 0, 0], [0, 255, 0]], [[0, 0, 255], [255, 255, 255]]], np.uint8)


def test_an_array_becomes_a_message_and_the_same_array() -> None:
    message = BRIDGE.cv2_to_imgmsg(PIXELS, "bgr8", Header(frame_id="camera"))
    assert (message.height, message.width, message.step, message.encoding) == (2, 2, 6, "bgr8")
    assert message.header.frame_id == "camera"
    assert np.array_equal(BRIDGE.imgmsg_to_cv2(message), PIXELS)
    assert BRIDGE.cv2_to_imgmsg(PIXELS.astype(np.float32)).encoding == "32FC3"


def test_colours_are_reordered_and_depths_scaled() -> None:
    message = BRIDGE.cv2_to_imgmsg(PIXELS, "bgr8")
    assert BRIDGE.imgmsg_to_cv2(message, "rgb8")[0, 0].tolist() == [0, 0, 255]
    assert BRIDGE.imgmsg_to_cv2(message, "rgba8")[1, 0].tolist() == [255, 0, 0, 255]
    assert BRIDGE.imgmsg_to_cv2(message, "mono8").tolist() == [[29, 150], [76, 255]]
    assert BRIDGE.imgmsg_to_cv2(message, "mono16")[1, 1] == 65535
    with pytest.raises(CvBridgeError, match="the other is not"):
        BRIDGE.imgmsg_to_cv2(message, "32FC1")


def test_rows_with_padding_and_the_other_byte_order_are_read() -> None:
    depth = np.array([[1, 2, 3]], ">u2")
    message = BRIDGE.cv2_to_imgmsg(depth, "mono16")
    assert message.is_bigendian
    message.data.frombytes(b"padding")
    message.step = len(message.data)
    image = BRIDGE.imgmsg_to_cv2(message)
    assert (image.tolist(), image.dtype) == ([[1, 2, 3]], np.dtype("uint16"))


def test_what_does_not_fit_is_named() -> None:
    with pytest.raises(CvBridgeError, match="encoding specified as mono8"):
        BRIDGE.cv2_to_imgmsg(PIXELS, "mono8")
    with pytest.raises(TypeError, match="not a numpy array"):
        BRIDGE.cv2_to_imgmsg([[1]])
    with pytest.raises(CvBridgeError, match="too few"):
        BRIDGE.imgmsg_to_cv2(Image(height=2, width=2, step=6, encoding="rgb8", data=[0] * 11))
    with pytest.raises(CvBridgeError, match="Unrecognized"):
        BRIDGE.imgmsg_to_cv2(Image(encoding="rgb9"))
