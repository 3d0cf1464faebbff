"""Writes bags, message by message."""

from __future__ import annotations

import weakref
from pathlib import Path
from typing import Any

from ros_in_python.ros2 import bag_qos
from ros_in_python.ros2.bag_storage import close_writer, know_type, message_types, open_writer
from ros_in_python.ros2.cli import CommandError
from ros_in_python.ros2.interfaces import check_installed
from rosbag2_py._storage import ConverterOptions, StorageOptions, TopicMetadata, check_formats, check_storage


class SequentialWriter:
    """Writes a new bag. It is finished by `close`, or when the program ends. Errors are RuntimeError, as in ROS 2."""

    def __init__(self) -> None:
        self._writer: Any = None
        self._topics: dict[str, Any] = {}

    def open(self, storage_options: StorageOptions, converter_options: ConverterOptions | None = None) -> None:
        """Begin a bag, in a folder that does not exist yet."""
        check_formats(converter_options or ConverterOptions())
        storage, folder = check_storage(storage_options), Path(storage_options.uri)
        if folder.exists():
            raise RuntimeError(f"Bag directory already exists ({folder}), can't overwrite existing bag")
        self.close()
        try:
            self._writer, self._types = open_writer(folder, storage), message_types()
        except CommandError as error:
            raise RuntimeError(error.message) from None
        self._finish = weakref.finalize(self, close_writer, self._writer, folder)

    def create_topic(self, topic: TopicMetadata) -> None:
        """Add a topic, whose type must be installed."""
        if self._writer is None:
            raise RuntimeError("Bag is not open. Call open() before writing.")
        if topic.name in self._topics:
            return
        if topic.serialization_format != "cdr":
            raise RuntimeError(f"The serialization format '{topic.serialization_format}' is not supported, only 'cdr'.")
        try:
            check_installed(topic.type)
        except (CommandError, ValueError) as error:
            raise RuntimeError(str(error)) from None
        know_type(self._types, topic.type)
        offered = [bag_qos.of_profile(profile) for profile in topic.offered_qos_profiles]
        self._topics[topic.name] = self._writer.add_connection(
            topic.name, topic.type, typestore=self._types, offered_qos_profiles=offered
        )

    def remove_topic(self, topic: TopicMetadata) -> None:
        """Write no more messages of a topic."""
        self._topics.pop(topic.name, None)

    def write(self, topic_name: str, message: bytes, timestamp: int, send_timestamp: int | None = None) -> None:
        """Write a serialized message, with the time at which it was received (ns)."""
        if topic_name not in self._topics:
            raise RuntimeError(f"Topic '{topic_name}' has not been created yet! Call 'create_topic' first.")
        self._writer.write(self._topics[topic_name], timestamp, message)

    def close(self) -> None:
        """Finish the bag, if one is open."""
        if self._writer is not None:
            self._finish()
            self._writer, self._topics = None, {}
