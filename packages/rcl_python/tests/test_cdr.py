"""Messages become the same bytes as in Fast DDS, for every message type that is installed."""

from __future__ import annotations

import re
import struct
from typing import Any

import pytest
from geometry_msgs.msg import Point, Twist
from hypothesis import HealthCheck, Phase, given, settings
from hypothesis import strategies as st
from random_messages import message_classes, messages
from rclpy.serialization import deserialize_message, serialize_message

from rcl_python import cdr

CLASSES = list(message_classes())
#: Hypothesis itself takes longest, so each type gets few values here and many in the soak.
FEW, MANY = 2, 60


def written(message: Any, padding: bytes) -> bytes:
    """Return the message's bytes, with this byte wherever the format does not specify one."""
    before, cdr.PADDING = cdr.PADDING, padding
    try:
        return cdr.serialize(message)
    finally:
        cdr.PADDING = before


def same(ours: bytes, blank: bytes, theirs: bytes) -> bool:
    """Return whether the bytes are equal. Fast DDS leaves garbage where `blank` differs from `ours`, and at the end."""
    equal = all(mine == other for mine, empty, other in zip(ours, blank, theirs, strict=False) if mine == empty)
    return equal and len(ours) <= len(theirs)


def compare(kind: Any, data: st.DataObject) -> None:
    """Draw a message of this class; compare both ways."""
    message = data.draw(messages(kind))
    ours, theirs = written(message, b"\0"), serialize_message(message)
    assert same(ours, written(message, b"\xff"), theirs), (kind, ours.hex(" "), theirs.hex(" "))
    assert written(cdr.deserialize(theirs, kind), b"\0") == ours
    assert written(deserialize_message(ours, kind), b"\0") == ours


def examples(count: int) -> settings:
    """Return a setting for this many messages per type."""
    silent = [HealthCheck.too_slow, HealthCheck.data_too_large, HealthCheck.large_base_example]
    phases = (Phase.generate, Phase.shrink)
    return settings(max_examples=count, deadline=None, suppress_health_check=silent, database=None, phases=phases)


def compare_with(kind: Any, count: int) -> None:
    """Compare this many messages of this class."""

    @examples(count)
    @given(st.data())
    def check(data: st.DataObject) -> None:
        compare(kind, data)

    check()


def test_all_interface_packages_are_compared() -> None:
    packages = {kind.__module__.partition(".")[0] for kind in CLASSES}
    assert {"std_msgs", "sensor_msgs", "geometry_msgs", "rcl_interfaces", "action_msgs", "test_msgs"} <= packages
    assert len(CLASSES) > 250


@pytest.mark.parametrize("package", sorted({kind.__module__.partition(".")[0] for kind in CLASSES}))
def test_a_package_s_messages_become_the_same_bytes(package: str) -> None:
    for kind in CLASSES:
        if kind.__module__.partition(".")[0] == package:
            compare_with(kind, FEW)


@pytest.mark.soak
@pytest.mark.timeout(3600)
@pytest.mark.parametrize("kind", CLASSES, ids=lambda kind: kind.__name__)
def test_many_messages_of_a_type_become_the_same_bytes(kind: Any) -> None:
    compare_with(kind, MANY)


def test_a_field_takes_the_fields_of_whatever_object_is_there() -> None:
    alike = Twist()
    alike.linear = Point(x=1.0, y=2.0, z=3.0)
    assert cdr.serialize(alike) == serialize_message(alike)[: len(cdr.serialize(alike))]
    for value in (3.0, None):
        other = Twist()
        other.linear = value
        with pytest.raises(AttributeError) as theirs:
            serialize_message(other)
        with pytest.raises(AttributeError, match=re.escape(str(theirs.value))):
            cdr.serialize(other)


def test_a_text_ends_where_c_would_end_it() -> None:
    from std_msgs.msg import String

    assert cdr.serialize(String(data="left\0knee")) == serialize_message(String(data="left\0knee"))


@pytest.mark.parametrize("value", [0, 1, -1, 7, 2**30, -(2**31), 2**63])
def test_an_int_in_a_field_for_floats_is_read_as_c_reads_it(value: int) -> None:
    from std_msgs.msg import Float64

    message = Float64()
    message._data = value
    assert cdr.serialize(message) == serialize_message(message)


@pytest.mark.parametrize("end", range(4, 11))
def test_a_message_that_ends_too_early_is_refused(end: int) -> None:
    from std_msgs.msg import String

    with pytest.raises((ValueError, struct.error)):
        cdr.deserialize(cdr.serialize(String(data="knee"))[:end], String)
