"""Reads the answers of a service that go to other nodes, as DDS carries them: on the topic `rr/NAMEReply`.

rclpy can't: it puts a slash before each topic's name, and its clients only get their own answers. So this calls rmw,
the middleware's C interface, whose functions are described in rmw/rmw.h. Of the middlewares only Fast DDS (the default)
sends an answer as it is; others put a header before it, and with those nothing is read.
"""

from __future__ import annotations

import ctypes
from collections.abc import Iterator
from typing import Any

import rclpy
from rclpy.node import Node
from rclpy.serialization import deserialize_message

_FAST_DDS = "rmw_fastrtps_cpp"


class _Allocator(ctypes.Structure):
    """rcutils_allocator_t."""

    _fields_ = [(name, ctypes.c_void_p) for name in ("allocate", "deallocate", "reallocate", "zero_allocate", "state")]


class _Bytes(ctypes.Structure):
    """rcutils_uint8_array_t, which is rmw_serialized_message_t."""

    _fields_ = [
        ("buffer", ctypes.c_void_p),
        ("length", ctypes.c_size_t),
        ("capacity", ctypes.c_size_t),
        ("allocator", _Allocator),
    ]


class _Qos(ctypes.Structure):
    """rmw_qos_profile_t."""

    _fields_ = [
        ("history", ctypes.c_int),
        ("depth", ctypes.c_size_t),
        ("reliability", ctypes.c_int),
        ("durability", ctypes.c_int),
        ("deadline", ctypes.c_uint64 * 2),
        ("lifespan", ctypes.c_uint64 * 2),
        ("liveliness", ctypes.c_int),
        ("liveliness_lease_duration", ctypes.c_uint64 * 2),
        ("avoid_ros_namespace_conventions", ctypes.c_bool),
    ]


class _SubscriptionOptions(ctypes.Structure):
    """rmw_subscription_options_t."""

    _fields_ = [
        ("rmw_specific_subscription_payload", ctypes.c_void_p),
        ("ignore_local_publications", ctypes.c_bool),
        ("require_unique_network_flow_endpoints", ctypes.c_int),
        ("content_filter_options", ctypes.c_void_p),
    ]


class _Information(ctypes.Structure):
    """rmw_message_info_t: its beginning, and more space than the rest needs."""

    _fields_ = [
        ("source_timestamp", ctypes.c_int64),
        ("received_timestamp", ctypes.c_int64),
        ("rest", ctypes.c_char * 240),
    ]


#: Keep the last 100, reliable, volatile, automatic liveliness; the topic's name is used as it is.
_RELIABLE = (1, 100, 1, 2, (0, 0), (0, 0), 1, (0, 0), True)


class ServiceReplyReader:
    """Reads the answers of one service; `answer` is their class."""

    def __init__(self, node: Node, service: str, answer: Any) -> None:
        self._answer = answer
        self._subscription: int | None = None
        if rclpy.get_rmw_implementation_identifier() == _FAST_DDS:
            self._subscription = _subscribe(node, f"rr{service}Reply", answer)

    def take(self) -> Iterator[tuple[float, Any]]:
        """Yield what has arrived since the last call: (when it was sent in s since the epoch, the answer)."""
        while self._subscription is not None and (taken := _take(self._subscription)) is not None:
            yield taken[0], deserialize_message(taken[1], self._answer)


def _subscribe(node: Node, topic: str, answer: Any) -> int | None:
    rcl, rmw, core = ctypes.CDLL("librcl.so"), ctypes.CDLL(f"lib{_FAST_DDS}.so"), ctypes.CDLL("librmw.so")
    handle = _typed(rcl.rcl_node_get_rmw_handle, ctypes.c_void_p, ctypes.c_void_p)(node.handle.pointer)
    options = _typed(core.rmw_get_default_subscription_options, _SubscriptionOptions)()
    create = _typed(
        rmw.rmw_create_subscription, ctypes.c_void_p, *[ctypes.c_void_p] * 2, ctypes.c_char_p, *[ctypes.c_void_p] * 2
    )
    qos = _Qos(*_RELIABLE)
    found: int | None = create(handle, _type_support(answer), topic.encode(), ctypes.byref(qos), ctypes.byref(options))
    return found


def _type_support(answer: Any) -> int:
    kind = type(answer)
    kind.__import_type_support__()
    name = _typed(ctypes.pythonapi.PyCapsule_GetName, ctypes.c_char_p, ctypes.py_object)(kind._TYPE_SUPPORT)
    get = _typed(ctypes.pythonapi.PyCapsule_GetPointer, ctypes.c_void_p, ctypes.py_object, ctypes.c_char_p)
    pointer: int = get(kind._TYPE_SUPPORT, name)
    return pointer


def _take(subscription: int) -> tuple[float, bytes] | None:
    """Return the next message: (when it was sent in s, its bytes)."""
    rmw, utilities = ctypes.CDLL(f"lib{_FAST_DDS}.so"), ctypes.CDLL("librcutils.so")
    allocator = _typed(utilities.rcutils_get_default_allocator, _Allocator)()
    data, taken, information = _Bytes(None, 0, 0, allocator), ctypes.c_bool(False), _Information()
    take = _typed(rmw.rmw_take_serialized_message_with_info, ctypes.c_int, *[ctypes.c_void_p] * 5)
    take(subscription, ctypes.byref(data), ctypes.byref(taken), ctypes.byref(information), None)
    try:
        return (information.source_timestamp / 1e9, ctypes.string_at(data.buffer, data.length)) if taken else None
    finally:
        _typed(utilities.rcutils_uint8_array_fini, ctypes.c_int, ctypes.c_void_p)(ctypes.byref(data))


def _typed(function: Any, result: Any, *arguments: Any) -> Any:
    function.restype, function.argtypes = result, list(arguments)
    return function
