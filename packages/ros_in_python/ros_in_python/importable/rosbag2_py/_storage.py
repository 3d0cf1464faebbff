"""Options and descriptions of bags. Names and fields are those of rosbag2_py, which is compiled in ROS 2."""

from __future__ import annotations

import enum
import re
from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any


@dataclass
class StorageOptions:
    """Where a bag is, and how it is stored: `mcap` or `sqlite3`. What splits or packs a bag is refused."""

    uri: str
    storage_id: str = ""
    max_bagfile_size: int = 0
    max_bagfile_duration: int = 0
    max_cache_size: int = 0
    storage_preset_profile: str = ""
    storage_config_uri: str = ""
    snapshot_mode: bool = False
    start_time_ns: int = -1
    end_time_ns: int = -1
    custom_data: dict[str, str] = field(default_factory=dict)


@dataclass
class ConverterOptions:
    """The formats of the messages' bytes. There is only `cdr` here."""

    input_serialization_format: str = ""
    output_serialization_format: str = ""


@dataclass
class StorageFilter:
    """Which topics are read: those that are named or match, all if none are; without those that are excluded."""

    topics: Sequence[str] = ()
    services_events: Sequence[str] = ()
    regex: str = ""
    exclude_topics: Sequence[str] = ()
    exclude_service_events: Sequence[str] = ()
    regex_to_exclude: str = ""

    def lets_through(self, topic: str) -> bool:
        """Return whether messages of a topic are read."""
        excluded = (*self.exclude_topics, *self.exclude_service_events)
        if topic in excluded or (self.regex_to_exclude and re.fullmatch(self.regex_to_exclude, topic)):
            return False
        named = (*self.topics, *self.services_events)
        chooses_all = not named and not self.regex
        return chooses_all or topic in named or bool(self.regex and re.fullmatch(self.regex, topic))


class ReadOrderSortBy(enum.Enum):
    """By what messages are ordered."""

    ReceivedTimestamp = 0
    PublishedTimestamp = 1
    File = 2


@dataclass
class ReadOrder:
    """In what order messages are read."""

    sort_by: ReadOrderSortBy = ReadOrderSortBy.ReceivedTimestamp
    reverse: bool = False


@dataclass
class TopicMetadata:
    """A topic of a bag. `offered_qos_profiles` are those of rclpy."""

    id: int
    name: str
    type: str
    serialization_format: str
    offered_qos_profiles: list[Any] = field(default_factory=list)
    type_description_hash: str = ""

    def equals(self, other: TopicMetadata) -> bool:
        """Return whether both are the same topic."""
        return self == other


@dataclass
class TopicInformation:
    """A topic, and how many messages it has."""

    topic_metadata: TopicMetadata
    message_count: int


@dataclass
class FileInformation:
    """A file of a bag; times are rclpy's `Time` and `Duration`."""

    path: str
    starting_time: Any
    duration: Any
    message_count: int


@dataclass
class BagMetadata:
    """What is in a bag; times are rclpy's `Time` and `Duration`."""

    version: int = 9
    bag_size: int = 0
    storage_identifier: str = ""
    relative_file_paths: list[str] = field(default_factory=list)
    files: list[FileInformation] = field(default_factory=list)
    duration: Any = None
    starting_time: Any = None
    message_count: int = 0
    topics_with_message_count: list[TopicInformation] = field(default_factory=list)
    compression_format: str = ""
    compression_mode: str = ""
    custom_data: dict[str, str] = field(default_factory=dict)
    ros_distro: str = ""


def get_default_storage_id() -> str:
    """Return how a bag is stored if nothing is said."""
    return "mcap"


def convert_rclcpp_qos_to_rclpy_qos(profile: Any) -> Any:
    """Return a profile as rclpy's, which it is here already."""
    return profile


def check_formats(options: ConverterOptions) -> None:
    """Raise RuntimeError for a format other than `cdr`."""
    for name in (options.input_serialization_format, options.output_serialization_format):
        if name not in ("", "cdr"):
            raise RuntimeError(f"The serialization format '{name}' is not supported here, only 'cdr'.")


def check_storage(options: StorageOptions) -> str:
    """Return `mcap` or `sqlite3`. Raises RuntimeError for options that have an effect in ROS 2 alone."""
    names = ("max_bagfile_size", "max_bagfile_duration", "storage_config_uri", "snapshot_mode")
    unsupported = [name for name in names if getattr(options, name)]
    if options.storage_preset_profile not in ("", "none", "fastwrite", "resilient"):
        unsupported.append("storage_preset_profile")
    if unsupported:
        raise RuntimeError(f"StorageOptions.{unsupported[0]} is not supported here.")
    storage = options.storage_id or get_default_storage_id()
    if storage not in ("mcap", "sqlite3"):
        raise RuntimeError(f"No storage '{storage}'. There are 'mcap' and 'sqlite3'.")
    return storage
