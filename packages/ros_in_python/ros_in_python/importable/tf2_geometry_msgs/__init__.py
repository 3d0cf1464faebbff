"""Lets tf2's buffers transform the types of geometry_msgs. Importing it is enough: `import tf2_geometry_msgs`."""

from tf2_geometry_msgs.tf2_geometry_msgs import do_transform_point as do_transform_point
from tf2_geometry_msgs.tf2_geometry_msgs import do_transform_pose as do_transform_pose
from tf2_geometry_msgs.tf2_geometry_msgs import do_transform_pose_stamped as do_transform_pose_stamped
from tf2_geometry_msgs.tf2_geometry_msgs import (
    do_transform_pose_with_covariance_stamped as do_transform_pose_with_covariance_stamped,
)
from tf2_geometry_msgs.tf2_geometry_msgs import do_transform_vector3 as do_transform_vector3
from tf2_geometry_msgs.tf2_geometry_msgs import do_transform_wrench as do_transform_wrench
from tf2_geometry_msgs.tf2_geometry_msgs import from_msg_msg as from_msg_msg
from tf2_geometry_msgs.tf2_geometry_msgs import to_msg_msg as to_msg_msg
from tf2_geometry_msgs.tf2_geometry_msgs import transform_covariance as transform_covariance
