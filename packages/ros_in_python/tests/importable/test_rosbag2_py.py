"""rosbag2_py writes and reads bags, in both storages."""

from __future__ import annotations

import gc
from pathlib import Path

import pytest
import rosbag2_py
from example_interfaces.msg import Int32
from rclpy.qos import DurabilityPolicy, QoSProfile
from rclpy.serialization import deserialize_message, serialize_message
from rosbag2_py import ConverterOptions, StorageFilter, StorageOptions
from std_msgs.msg import String

LATCHED = QoSProfile(depth=1, durability=DurabilityPolicy.TRANSIENT_LOCAL)


def write(folder: Path, storage: str = "") -> None:
    """Write three numbers and two texts, at 1 to 5 s."""
    writer = rosbag2_py.SequentialWriter()
    writer.open(StorageOptions(uri=str(folder), storage_id=storage), ConverterOptions("", ""))
    numbers = rosbag2_py._storage.TopicMetadata(0, "/numbers", "example_interfaces/msg/Int32", "cdr")
    writer.create_topic(numbers)
    writer.create_topic(rosbag2_py.TopicMetadata(1, "/text", "std_msgs/msg/String", "cdr", [LATCHED]))
    for second in range(1, 6):
        name, message = ("/numbers", Int32(data=second)) if second % 2 else ("/text", String(data=str(second)))
        writer.write(name, serialize_message(message), second * 10**9)


@pytest.fixture
def reader(tmp_path: Path) -> rosbag2_py.SequentialReader:
    write(tmp_path / "bag")
    reader = rosbag2_py.SequentialReader()
    reader.open(StorageOptions(str(tmp_path / "bag"), "mcap"), ConverterOptions("cdr", "cdr"))
    return reader


def read(reader: rosbag2_py.SequentialReader) -> list[int]:
    """Read the rest; return the seconds."""
    seconds = []
    while reader.has_next():
        name, data, at = reader.read_next()
        message = deserialize_message(data, Int32 if name == "/numbers" else String)
        assert int(message.data) == at // 10**9
        seconds.append(at // 10**9)
    return seconds


@pytest.mark.parametrize("storage", ["mcap", "sqlite3"])
def test_what_is_written_is_read_again_with_its_topics(tmp_path: Path, storage: str) -> None:
    write(tmp_path / "bag", storage)
    gc.collect()
    reader = rosbag2_py.SequentialReader()
    reader.open_uri(str(tmp_path / "bag"))
    numbers, text = reader.get_all_topics_and_types()
    assert (numbers.name, numbers.type, text.name) == ("/numbers", "example_interfaces/msg/Int32", "/text")
    assert text.offered_qos_profiles[0].durability == DurabilityPolicy.TRANSIENT_LOCAL
    metadata = rosbag2_py.Info().read_metadata(str(tmp_path / "bag"), storage)
    assert (metadata.storage_identifier, metadata.message_count) == (storage, 5)
    assert (metadata.starting_time.nanoseconds, metadata.duration.nanoseconds) == (10**9, 4 * 10**9)
    assert read(reader) == [1, 2, 3, 4, 5]
    with pytest.raises(RuntimeError, match="at its end"):
        reader.read_next()


def test_a_filter_a_time_and_an_order_choose_what_is_read(reader: rosbag2_py.SequentialReader) -> None:
    assert reader.read_next()[2] == 10**9
    reader.set_filter(StorageFilter(topics=["/numbers"]))
    assert read(reader) == [3, 5]
    reader.seek(2 * 10**9)
    assert read(reader) == [3, 5]
    reader.set_filter(StorageFilter(regex="/t.*"))
    reader.seek(0)
    assert read(reader) == [2, 4]
    reader.set_filter(StorageFilter(exclude_topics=["/text"]))
    assert reader.set_read_order(rosbag2_py.ReadOrder(reverse=True))
    reader.seek(4 * 10**9)
    assert read(reader) == [3, 1]
    reader.reset_filter()
    assert not reader.set_read_order(rosbag2_py.ReadOrder(rosbag2_py.ReadOrderSortBy.PublishedTimestamp))


def test_what_can_not_be_done_is_named(tmp_path: Path) -> None:
    writer = rosbag2_py.SequentialWriter()
    with pytest.raises(RuntimeError, match="max_bagfile_size"):
        writer.open(StorageOptions(str(tmp_path / "a"), max_bagfile_size=9))
    with pytest.raises(RuntimeError, match="json"):
        writer.open(StorageOptions(str(tmp_path / "a")), ConverterOptions("json", ""))
    with pytest.raises(RuntimeError, match="already exists"):
        writer.open(StorageOptions(str(tmp_path)))
    writer.open(StorageOptions(str(tmp_path / "a")))
    with pytest.raises(RuntimeError, match="not installed"):
        writer.create_topic(rosbag2_py.TopicMetadata(0, "/a", "no_msgs/msg/None", "cdr"))
    with pytest.raises(RuntimeError, match="create_topic"):
        writer.write("/a", b"", 0)
    with pytest.raises(RuntimeError, match="can't be read"):
        rosbag2_py.SequentialReader().open_uri(str(tmp_path / "nothing"))
    with pytest.raises(AttributeError, match=r"rosbag2_py\.Player is not available"):
        _ = rosbag2_py.Player
