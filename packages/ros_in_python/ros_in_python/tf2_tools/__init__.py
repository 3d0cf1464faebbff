"""The programs of tf2_ros and tf2_tools: static_transform_publisher, tf2_echo, tf2_monitor and view_frames."""
