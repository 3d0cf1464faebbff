"""CDR of ROS messages, from the SLOT_TYPES of their generated classes.

Plain CDR, little endian, as Fast DDS writes it for ROS 2 (OMG Common Data Representation, version 1): four bytes of
header, then the fields, each aligned to its own size, counted from the end of the header. If a C converter reads a
value of the wrong Python type (an int for a double), this reads what it would find in memory.
"""

from __future__ import annotations

import array
import functools
import importlib
import struct
import sys
from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, TypeAlias

HEADER = b"\x00\x01\x00\x00"
PADDING = b"\x00"
"""The padding before a field that has to be aligned. Fast DDS leaves whatever the memory held."""

Writer: TypeAlias = Callable[[bytearray, Any], None]
Reader: TypeAlias = "Callable[[Cursor], Any]"

#: IDL type -> (format of struct, type code of array).
_BASIC = {
    "boolean": "?", "octet": "B", "char": "B", "wchar": "I", "float": "f", "double": "d", "long double": "d",
    "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I", "int64": "q", "uint64": "Q",
}  # fmt: skip
#: The Python type of a sequence of these: array.array; of others: list.
_ARRAYS = {"float", "double", "int8", "uint8", "int16", "uint16", "int32", "uint32", "int64", "uint64"}
_UTF16 = "utf-16-le" if sys.byteorder == "little" else "utf-16-be"
_NUMPY = {"float": "float32", "double": "float64"}


class Cursor:
    """A position in the bytes of a message."""

    __slots__ = ("at", "data")

    def __init__(self, data: bytes) -> None:
        self.data = memoryview(data)
        self.at = len(HEADER)

    def align(self, size: int) -> None:
        """Go to the next multiple of `size`."""
        self.at += -(self.at - 4) % size

    def count(self) -> int:
        """Read a length."""
        self.align(4)
        (value,) = struct.unpack_from("<I", self.data, self.at)
        self.at += 4
        return int(value)

    def take(self, size: int) -> bytes:
        """Read bytes. Raises ValueError if there are too few."""
        found = bytes(self.data[self.at : self.at + size])
        if len(found) < size:
            raise ValueError("the message ends too early")
        self.at += size
        return found


@dataclass(frozen=True)
class Codec:
    """How values of one IDL type are written and read."""

    write: Writer
    read: Reader


def serialize(message: Any) -> bytes:
    """Return the bytes of a message."""
    out = bytearray(HEADER)
    _write_fields(out, message, type(message))
    return bytes(out)


def deserialize(data: bytes, message_class: type) -> Any:
    """Return the message in the bytes `data`. Raises ValueError or struct.error if they are not of this class."""
    return _read_fields(Cursor(data), message_class)


def _write_fields(out: bytearray, message: Any, kind: Any) -> None:
    fields = _fields(kind)
    if not fields:
        out += b"\0"
    for name, codec in fields:
        codec.write(out, getattr(message, name if type(message) is kind else name.removeprefix("_")))


def _read_fields(cursor: Cursor, kind: Any) -> Any:
    fields = _fields(kind)
    message = kind()
    if not fields:
        cursor.take(1)
    for name, codec in fields:
        setattr(message, name, codec.read(cursor))
    return message


@functools.cache
def _fields(kind: Any) -> list[tuple[str, Codec]]:
    """Return the fields of a message class: the slot's name, and how its values are written and read."""
    names = [name for name in kind.__slots__ if name != "_check_fields"]
    return [(name, _codec(slot)) for name, slot in zip(names, kind.SLOT_TYPES, strict=True)]


def _codec(slot: Any) -> Codec:
    kind = type(slot).__name__
    if kind == "BasicType":
        return Codec(_basic_writer(slot.typename), _basic_reader(slot.typename))
    if kind.endswith("WString"):
        return Codec(_write_wide, _read_wide)
    if kind.endswith("String"):
        return Codec(_write_text, _read_text)
    if kind in ("NamespacedType", "NamedType"):
        return Codec(_message_writer(slot), _message_reader(slot))
    element = _codec(slot.value_type)
    fixed = kind == "Array"
    return Codec(_sequence_writer(slot, element.write, fixed), _sequence_reader(slot, element.read, fixed))


def _message_writer(slot: Any) -> Writer:
    package = ".".join(slot.namespaces)
    # As the wheels' compiled code does, this takes the fields of whatever object is there.
    return lambda out, value: _write_fields(out, value, _class(package, slot.name))


def _basic_writer(name: str) -> Writer:
    form = _BASIC[name]
    size, pack = struct.calcsize(form), struct.Struct("<" + form).pack
    convert: Callable[[Any], Any] | None = {"octet": _octet, "boolean": lambda flag: flag is True}.get(name)
    if form in "fd":
        convert = _as_double

    def write(out: bytearray, value: Any) -> None:
        out += PADDING * (-(len(out) - 4) % size)
        out += pack(value if convert is None else convert(value))

    return write


def _octet(value: Any) -> int:
    return int(value[0]) if isinstance(value, (bytes, bytearray)) else int(value)


def _as_double(value: Any) -> float:
    if isinstance(value, float):
        return value
    return int_as_double(value) if isinstance(value, int) else float(value)


def int_as_double(value: int) -> float:
    """Return what C finds if it reads a Python int as a float: the int's own bookkeeping (CPython's longintrepr.h)."""
    digits = -(-abs(value).bit_length() // 30)
    if sys.version_info >= (3, 12):
        word = digits << 3 | (2 if value < 0 else 1 if value == 0 else 0)
        if value == 0:
            word = 1
    else:
        word = (-digits if value < 0 else digits) & (2**64 - 1)
    return float(struct.unpack("<d", struct.pack("<Q", word))[0])


def _write_text(out: bytearray, value: str) -> None:
    # C ends a text at its first zero.
    data = value.encode().partition(b"\0")[0]
    out += PADDING * (-(len(out) - 4) % 4)
    out += struct.pack("<I", len(data) + 1) + data + b"\0"


def _write_wide(out: bytearray, value: str) -> None:
    """Write a text as Fast DDS does, which gives each unit of UTF-16 the four bytes of a wchar_t."""
    units = array.array("H", value.encode(_UTF16))
    out += PADDING * (-(len(out) - 4) % 4)
    out += struct.pack(f"<I{len(units)}I", len(units), *units)


def _sequence_writer(slot: Any, write_element: Writer, fixed: bool) -> Writer:
    code, size = _packed(slot)

    def write(out: bytearray, values: Any) -> None:
        if not fixed:
            out += PADDING * (-(len(out) - 4) % 4)
            out += struct.pack("<I", len(values))
        if code and isinstance(values, array.array) and values.typecode == code:
            _write_packed(out, values, size)
        else:
            for value in values:
                write_element(out, value)

    return write


def _write_packed(out: bytearray, values: array.array[Any], size: int) -> None:
    if values:
        out += PADDING * (-(len(out) - 4) % size)
        out += values.tobytes()


def _packed(slot: Any) -> tuple[str, int]:
    """Return the type code and size of the elements of a sequence that is one block of memory; "" for any other."""
    name = getattr(slot.value_type, "typename", "")
    if name in _ARRAYS:
        return _BASIC[name], struct.calcsize(_BASIC[name])
    return "", 0


def _basic_reader(name: str) -> Reader:
    form = struct.Struct("<" + _BASIC[name])

    def read(cursor: Cursor) -> Any:
        cursor.align(form.size)
        (value,) = form.unpack_from(cursor.data, cursor.at)
        cursor.at += form.size
        return bytes((value,)) if name == "octet" else value

    return read


def _read_text(cursor: Cursor) -> str:
    return cursor.take(cursor.count())[:-1].decode()


def _read_wide(cursor: Cursor) -> str:
    count = cursor.count()
    units = struct.unpack(f"<{count}I", cursor.take(4 * count))
    return array.array("H", units).tobytes().decode(_UTF16)


def _message_reader(slot: Any) -> Reader:
    package = ".".join(slot.namespaces)
    # The class is looked up when it is needed: it may be defined after the one that refers to it.
    return lambda cursor: _read_fields(cursor, _class(package, slot.name))


@functools.cache
def _class(package: str, name: str) -> type:
    """Return a message class by its name. Parts of services and actions are only in the module of the whole."""
    whole = getattr(importlib.import_module(package), name.split("_")[0])
    kind: type = getattr(sys.modules[whole.__module__], name)
    return kind


def _sequence_reader(slot: Any, read_element: Reader, fixed: bool) -> Reader:
    code, size = _packed(slot)

    def read(cursor: Cursor) -> Any:
        count = slot.size if fixed else cursor.count()
        if not code:
            return [read_element(cursor) for _ in range(count)]
        values = array.array(code)
        if count:
            cursor.align(size)
            values.frombytes(cursor.take(count * size))
        return _numbers(values, slot.value_type.typename) if fixed else values

    return read


def _numbers(values: array.array[Any], name: str) -> Any:
    """Read a fixed number of numbers, which the generated classes hold as numpy arrays."""
    import numpy

    return numpy.array(values, dtype=getattr(numpy, _NUMPY.get(name, name)))
