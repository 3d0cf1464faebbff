"""Arrays, bounded sequences, bytes and characters of real messages, as they are after serialization."""

from __future__ import annotations

from typing import Any

import pytest
from rclpy.serialization import deserialize_message, serialize_message
from test_msgs.msg import Arrays, BasicTypes, BoundedSequences, Strings, UnboundedSequences

from grader.checking.comparator import difference
from grader.runner.message import to_fields


def through_the_wire(message: Any) -> dict[str, Any]:
    return to_fields(deserialize_message(serialize_message(message), type(message)))


@pytest.mark.parametrize(
    ("got", "expected", "path"),
    [
        (BasicTypes(float32_value=0.1), BasicTypes(float32_value=0.1), None),
        (BasicTypes(float32_value=0.1), BasicTypes(float32_value=0.1 + 1e-9), None),
        (BasicTypes(uint8_value=255), BasicTypes(uint8_value=254), "uint8_value"),
        (BasicTypes(int64_value=-(2**63)), BasicTypes(int64_value=-(2**63) + 1), "int64_value"),
        (BasicTypes(byte_value=b"\x01"), BasicTypes(byte_value=b"\x02"), "byte_value"),
        (BasicTypes(bool_value=True), BasicTypes(), "bool_value"),
        (Arrays(float64_values=[1.0, 2.0, 3.0]), Arrays(float64_values=[1.0, 2.0, 3.0]), None),
        (Arrays(float64_values=[1.0, 2.0, 3.0]), Arrays(float64_values=[1.0, 2.0, 4.0]), "float64_values[2]"),
        (BoundedSequences(), BoundedSequences(), None),
        (BoundedSequences(uint8_values=[]), BoundedSequences(uint8_values=[0]), "uint8_values"),
        (BoundedSequences(bool_values=[True, False]), BoundedSequences(bool_values=[True, True]), "bool_values[1]"),
        (
            BoundedSequences(basic_types_values=[BasicTypes(), BasicTypes(int8_value=1)]),
            BoundedSequences(basic_types_values=[BasicTypes(), BasicTypes(int8_value=2)]),
            "basic_types_values[1].int8_value",
        ),
        (UnboundedSequences(string_values=["ä", ""]), UnboundedSequences(string_values=["ä", ""]), None),
        (UnboundedSequences(string_values=["ä"]), UnboundedSequences(string_values=["a"]), "string_values[0]"),
        (Strings(string_value="1.0"), Strings(string_value="1.00"), "string_value"),
    ],
)
def test_where_two_messages_differ(got: Any, expected: Any, path: str | None) -> None:
    found = difference(through_the_wire(got), through_the_wire(expected))
    assert (found.path if found else None) == path
