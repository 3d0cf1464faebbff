"""Reads bags, message by message."""

from __future__ import annotations

from collections.abc import Iterator
from pathlib import Path
from typing import Any

from rclpy.duration import Duration
from rclpy.time import Time

from ros_in_python.ros2 import bag_qos
from ros_in_python.ros2.bag_storage import duration_of, open_reader, stored_files
from ros_in_python.ros2.cli import CommandError
from rosbag2_py._storage import (
    BagMetadata,
    ConverterOptions,
    FileInformation,
    ReadOrder,
    ReadOrderSortBy,
    StorageFilter,
    StorageOptions,
    TopicInformation,
    TopicMetadata,
    check_formats,
)


class SequentialReader:
    """Reads a bag from its first message to its last. Errors are RuntimeError, as in ROS 2."""

    def __init__(self) -> None:
        self._reader: Any = None
        self._filter, self._order = StorageFilter(), ReadOrder()
        self._from: int | None = None
        self._next: Any = None

    def open(self, storage_options: StorageOptions, converter_options: ConverterOptions | None = None) -> None:
        """Open a bag, in whichever storage it is."""
        check_formats(converter_options or ConverterOptions())
        self.close()
        self._uri = Path(storage_options.uri)
        try:
            self._reader = open_reader(self._uri)
        except CommandError as error:
            raise RuntimeError(error.message) from None
        self._restart(None)

    def open_uri(self, uri: str) -> None:
        """Open a bag by its folder alone."""
        self.open(StorageOptions(uri))

    def close(self) -> None:
        """Close the bag, if one is open."""
        if self._reader is not None:
            self._reader.close()
            self._reader = None

    def has_next(self) -> bool:
        """Return whether there is another message."""
        while self._next is not None and not self._filter.lets_through(self._next[0].topic):
            self._next = next(self._messages, None)
        return self._next is not None

    def read_next(self) -> tuple[str, bytes, int]:
        """Return the next message: its topic, its bytes, and when it was received (ns)."""
        if not self.has_next():
            raise RuntimeError("Bag is at its end. No next message.")
        (connection, at, data), self._next = self._next, next(self._messages, None)
        return connection.topic, bytes(data), at

    def set_filter(self, storage_filter: StorageFilter) -> None:
        """From here on, read only topics that the filter lets through."""
        self._filter = storage_filter

    def reset_filter(self) -> None:
        """From here on, read all topics."""
        self._filter = StorageFilter()

    def seek(self, timestamp: int) -> None:
        """Go to the first message at or after a time (ns); in reverse order, to the last at or before it."""
        self._restart(timestamp)

    def set_read_order(self, read_order: ReadOrder) -> bool:
        """Read in this order, from its begin. Return False, and change nothing, for one that a bag can't be read in."""
        if read_order.sort_by is ReadOrderSortBy.PublishedTimestamp:
            return False
        self._order = read_order
        if self._reader is not None:
            self._restart(self._from)
        return True

    def get_all_topics_and_types(self) -> list[TopicMetadata]:
        """Return all topics of the bag."""
        return [each.topic_metadata for each in self.get_metadata().topics_with_message_count]

    def get_metadata(self) -> BagMetadata:
        """Return what is in the bag."""
        reader = self._open()
        storage, files = stored_files(self._uri)
        starting, duration = Time(nanoseconds=reader.start_time), Duration(nanoseconds=duration_of(reader))
        return BagMetadata(
            bag_size=sum(file.stat().st_size for file in files),
            storage_identifier=storage,
            relative_file_paths=[file.name for file in files],
            files=[FileInformation(file.name, starting, duration, reader.message_count) for file in files[:1]],
            duration=duration,
            starting_time=starting,
            message_count=reader.message_count,
            topics_with_message_count=[_topic(number, each) for number, each in enumerate(reader.connections)],
            ros_distro=reader.ros_distro or "",
        )

    def _open(self) -> Any:
        if self._reader is None:
            raise RuntimeError("Bag is not open. Call open() before reading.")
        return self._reader

    def _restart(self, timestamp: int | None) -> None:
        reader, self._from = self._open(), timestamp
        self._messages: Iterator[Any]
        if self._order.reverse:
            stop = None if timestamp is None else timestamp + 1
            self._messages = reversed(list(reader.messages(stop=stop)))
        else:
            self._messages = reader.messages(start=timestamp)
        self._next = next(self._messages, None)


def _topic(number: int, connection: Any) -> TopicInformation:
    profiles = [bag_qos.to_profile([each]) for each in connection.ext.offered_qos_profiles]
    metadata = TopicMetadata(
        number, connection.topic, connection.msgtype, connection.ext.serialization_format, profiles, connection.digest
    )
    return TopicInformation(metadata, connection.msgcount)


class Info:
    """Says what is in bags."""

    def read_metadata(self, uri: str, storage_id: str) -> BagMetadata:
        """Return what is in a bag."""
        reader = SequentialReader()
        reader.open(StorageOptions(uri, storage_id))
        try:
            return reader.get_metadata()
        finally:
            reader.close()
