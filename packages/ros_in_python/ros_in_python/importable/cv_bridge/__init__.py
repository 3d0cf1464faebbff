"""cv_bridge without a ROS installation: images of messages as numpy arrays, which OpenCV works on, and back."""

from cv_bridge.core import CvBridge as CvBridge
from cv_bridge.core import CvBridgeError as CvBridgeError
