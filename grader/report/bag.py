"""A grade's recordings as rosbag2 (MCAP), to open in Foxglove or PlotJuggler."""

from __future__ import annotations

import dataclasses
import json
import shutil
from pathlib import Path
from typing import Any

from grader.grading.grade import Grade
from grader.recording.events import Event
from grader.recording.recording import Fields, ReceivedMessage, Recording, SentMessage
from interface_compiler import prefixes

#: The solution's messages are also in the bag, with this name before the topic's.
REFERENCE = "/reference"

#: Each call, goal, parameter and end of a program is a message on this topic, as JSON text.
EVENTS, TEXT = "/spinbook/events", "std_msgs/msg/String"


class NoBagWriter(Exception):
    """Raised when the library that writes bags is not installed."""


def write_bags(grade: Grade, folder: Path) -> list[Path]:
    """Write one bag per scenario into `folder`, and return their paths. A bag of the same name is replaced.

    Raises `NoBagWriter` without the package rosbags, and OSError when the folder can't be written.
    """
    try:
        from rosbags.rosbag2 import StoragePlugin, Writer
        from rosbags.typesys import Stores, get_typestore
    except ImportError:
        raise NoBagWriter("Bags are written by the package rosbags: pip install rosbags") from None
    folder.mkdir(parents=True, exist_ok=True)
    types = get_typestore(Stores.ROS2_JAZZY)
    written = []
    for name, recording in grade.recordings.items():
        bag = folder / name
        if (bag / "metadata.yaml").exists():
            shutil.rmtree(bag)
        with Writer(bag, version=9, storage_plugin=StoragePlugin.MCAP) as writer:
            connections: dict[str, Any] = {}
            for at, topic, kind, fields in _in_order(recording, grade.references[name]):
                _learn(types, kind)
                if topic not in connections:
                    connections[topic] = writer.add_connection(topic, kind, typestore=types)
                writer.write(connections[topic], at, types.serialize_cdr(_message(types, kind, fields), kind))
        written.append(bag)
    return written


def _in_order(recording: Recording, reference: Recording) -> list[tuple[int, str, str, Fields]]:
    messages = [(sent.at_ns, sent.topic, sent.type, sent.fields) for sent in recording.sent]
    messages += [(got.at_ns, got.topic, got.type, got.fields) for got in recording.received]
    messages += [(got.at_ns, REFERENCE + got.topic, got.type, got.fields) for got in reference.received]
    for prefix, source in (("", recording), (REFERENCE, reference)):
        others = [event for event in source.timeline if not isinstance(event.item, (SentMessage, ReceivedMessage))]
        messages += [(event.at_ns, prefix + EVENTS, TEXT, {"data": _as_json(event)}) for event in others]
    return sorted(messages, key=lambda message: (message[0], message[1]))


def _as_json(event: Event) -> str:
    return json.dumps({"what": event.what, **dataclasses.asdict(event.item)}, default=list, ensure_ascii=False)


def _learn(types: Any, kind: str) -> None:
    """Register a type that rosbags does not know, from the package that defines it."""
    from rosbags.typesys import get_types_from_msg

    if kind in types.fielddefs:
        return
    package, _, name = kind.partition("/")
    prefix = prefixes.prefix_of(package, prefixes.installed())
    assert prefix
    learned: dict[str, Any] = get_types_from_msg(prefixes.definitions_of(package, prefix)[f"{name}.msg"], kind)
    types.register(learned)
    for _, (node, detail) in learned[kind][1]:
        inner, what = detail[0] if node.name not in ("BASE", "NAME") else (node, detail)
        if inner.name == "NAME":
            _learn(types, what)


def _message(types: Any, kind: str, fields: Fields) -> Any:
    """Return a message as rosbags represents it: with every field, and with sequences of numbers as arrays."""
    import numpy as np

    values: Fields = {}
    for name, (node, detail) in types.get_msgdef(kind).fields:
        value = fields.get(name)
        if node.name == "NAME":
            values[name] = _message(types, detail, value or {})
        elif node.name == "BASE":
            values[name] = value if value is not None else ("" if detail[0] == "string" else 0)
        else:
            inner, what = detail[0]
            items = value or []
            if inner.name == "NAME":
                values[name] = [_message(types, what, item) for item in items]
            elif what[0] == "string":
                values[name] = items
            else:
                values[name] = np.array(items, dtype=what[0])
    return types.types[kind](**values)
