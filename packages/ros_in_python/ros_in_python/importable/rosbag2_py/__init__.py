"""rosbag2_py without a ROS installation: reads and writes bags in MCAP and sqlite3, over the library rosbags."""

from typing import Any

from rosbag2_py import _reader as _reader
from rosbag2_py import _storage as _storage
from rosbag2_py import _writer as _writer
from rosbag2_py._reader import Info as Info
from rosbag2_py._reader import SequentialReader as SequentialReader
from rosbag2_py._storage import BagMetadata as BagMetadata
from rosbag2_py._storage import ConverterOptions as ConverterOptions
from rosbag2_py._storage import FileInformation as FileInformation
from rosbag2_py._storage import ReadOrder as ReadOrder
from rosbag2_py._storage import ReadOrderSortBy as ReadOrderSortBy
from rosbag2_py._storage import StorageFilter as StorageFilter
from rosbag2_py._storage import StorageOptions as StorageOptions
from rosbag2_py._storage import TopicInformation as TopicInformation
from rosbag2_py._storage import TopicMetadata as TopicMetadata
from rosbag2_py._storage import convert_rclcpp_qos_to_rclpy_qos as convert_rclcpp_qos_to_rclpy_qos
from rosbag2_py._storage import get_default_storage_id as get_default_storage_id
from rosbag2_py._writer import SequentialWriter as SequentialWriter


def get_registered_readers() -> set[str]:
    """Return the storages that can be read."""
    return {"mcap", "sqlite3"}


get_registered_writers = get_registered_readers


def __getattr__(name: str) -> Any:
    if name.startswith("__"):
        raise AttributeError(name)
    there = ", ".join(sorted(each for each in globals() if each[0].isupper()))
    raise AttributeError(f"rosbag2_py.{name} is not available without a ROS installation. There is: {there}.")
