"""Bags as files, over the library rosbags: MCAP and sqlite3, with the definitions of all types."""

from __future__ import annotations

import re
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ros_in_python.ros2 import interfaces
from ros_in_python.ros2.cli import CommandError

if TYPE_CHECKING:
    from collections.abc import Iterator


@contextmanager
def writing(folder: Path, storage: str) -> Iterator[Any]:
    """Write a new bag in `mcap` or `sqlite3`, which is whole after an error or Ctrl-C, too."""
    writer = open_writer(folder, storage)
    try:
        yield writer
    finally:
        close_writer(writer, folder)


def open_writer(folder: Path, storage: str) -> Any:
    """Return the library's writer of a new bag."""
    rosbag2 = _library()
    writer = rosbag2.Writer(folder, version=9, storage_plugin=rosbag2.StoragePlugin[storage.upper()])
    writer.open()
    return writer


def close_writer(writer: Any, folder: Path) -> None:
    """Finish a bag, and name its file as ROS 2 does, which begins a new one when it is large: NAME_0.mcap."""
    writer.close()
    metadata = folder / "metadata.yaml"
    text = metadata.read_text(encoding="utf-8")
    for file in stored_files(folder)[1]:
        numbered = file.with_name(f"{file.stem}_0{file.suffix}")
        text = re.sub(rf"\b{re.escape(file.name)}$", numbered.name, text, flags=re.MULTILINE)
        file.rename(numbered)
    metadata.write_text(text, encoding="utf-8")


@contextmanager
def reading(folder: Path) -> Iterator[Any]:
    """Read a bag. Raises `CommandError` for what is none."""
    reader = open_reader(folder)
    try:
        yield reader
    finally:
        reader.close()


def open_reader(folder: Path) -> Any:
    """Return the library's reader of a bag. Raises `CommandError` for what is none."""
    rosbag2 = _library()
    try:
        reader = rosbag2.Reader(folder)
        reader.open()
    except Exception as error:  # whatever a damaged file leads the library to
        raise CommandError(
            f"'{folder}' can't be read as a bag: {error}", "Name the folder that `ros2 bag record` made."
        ) from None
    return reader


def duration_of(reader: Any) -> int:
    """Return the time from a bag's first message to its last (ns); the library counts to the moment after it."""
    return max(0, int(reader.duration) - 1)


def _library() -> Any:
    try:
        from rosbags import rosbag2
    except ImportError:
        raise CommandError("Bags need the package rosbags: pip install rosbags") from None
    return rosbag2


def message_types() -> Any:
    """Return the library's table of message types, with those that ROS 2 has."""
    from rosbags.typesys import Stores, get_typestore

    return get_typestore(Stores.ROS2_JAZZY)


def know_type(types: Any, kind: str) -> None:
    """Register a type that does not come with ROS 2 itself, and the types of its fields, with the library."""
    from rosbags.typesys import get_types_from_msg

    if kind in types.types:
        return
    package, _, name = kind.split("/")
    text = (interfaces.folder_of(package) / "msg" / f"{name}.msg").read_text(encoding="utf-8")
    definitions = get_types_from_msg(text, kind)
    for used in _types_used(definitions):
        if used not in definitions:
            know_type(types, used)
    types.register({name: fields for name, fields in definitions.items() if name not in types.types})


def _types_used(definitions: Any) -> list[str]:
    """Return the message types of these definitions' fields, and of the elements of those that are arrays."""
    fields = [field for _, fields in definitions.values() for _, field in fields]
    elements = [detail[0] for node, detail in fields if node.name in ("ARRAY", "SEQUENCE")]
    return [detail for node, detail in (*fields, *elements) if node.name == "NAME"]


def stored_files(bag: Path) -> tuple[str, list[Path]]:
    """Return how a bag is stored, and its files."""
    storages = {".mcap": "mcap", ".db3": "sqlite3"}
    files = [file for file in sorted(bag.iterdir()) if file.suffix in storages] if bag.is_dir() else [bag]
    return (storages.get(files[0].suffix, "unknown") if files else "unknown"), files
