"""Long lists of numbers in messages, such as images and maps: kept in a few bytes each, and written once.

A check sees them as lists: they have the same elements, slices and lengths, and equal a list with the same numbers.
"""

from __future__ import annotations

import base64
import json
import zlib
from array import array
from collections.abc import Callable
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    _Array = array[Any]
else:
    _Array = array

#: Shorter ones are lists.
LONG = 256

#: The type code of Python's array for each of ROS's types of numbers. Both floats have the code that loses nothing.
CODES = {
    **{"octet": "B", "uint8": "B", "int8": "b", "uint16": "H", "int16": "h", "uint32": "I", "int32": "i"},
    **{"uint64": "Q", "int64": "q", "float": "d", "double": "d"},
}


class LongArray(_Array):
    """A long list of numbers of one type."""

    def __eq__(self, other: object) -> bool:
        if isinstance(other, (list, tuple)):
            return self.tolist() == list(other)
        return super().__eq__(other)

    def __ne__(self, other: object) -> bool:
        return not self == other

    __hash__ = None

    def __getitem__(self, index: Any) -> Any:
        found = super().__getitem__(index)
        return found.tolist() if isinstance(index, slice) else found

    def __repr__(self) -> str:
        return f"[{', '.join(map(str, self[:3]))}, … {len(self)} numbers]"


def plain_array(code: str, values: Any) -> list[Any] | LongArray:
    """Return numbers, or bytes that contain them, as a list if there are few. `code` is a type code of `array`.

    Raises OverflowError or TypeError if a number is none of that type.
    """
    found = LongArray(code, values)
    return found if len(found) >= LONG else found.tolist()


_ARRAY, _AGAIN = "spinbook/array", "spinbook/again"  # no field of a message has such a name


class ArrayEncoder(json.JSONEncoder):
    """Writes each long array compressed, and only once in a text, however often it occurs."""

    def __init__(self, **options: Any) -> None:
        super().__init__(**options)
        self._numbers: dict[tuple[str, bytes], int] = {}

    def default(self, value: Any) -> Any:
        """Return a long array as what `ArrayReader` reads."""
        if not isinstance(value, LongArray):
            return super().default(value)
        content = value.typecode, value.tobytes()
        if content in self._numbers:
            return {_AGAIN: self._numbers[content]}
        self._numbers[content] = len(self._numbers)
        return {_ARRAY: value.typecode, **_compressed(content[1])}


def read_arrays() -> Callable[[dict[str, Any]], Any]:
    """Return an `object_hook` for one text of `ArrayEncoder`. It raises ValueError, KeyError or TypeError."""
    arrays: list[LongArray] = []

    def read(entries: dict[str, Any]) -> Any:
        if _AGAIN in entries:
            return arrays[entries[_AGAIN]]
        if _ARRAY not in entries:
            return entries
        arrays.append(LongArray(entries[_ARRAY], _decompressed(entries)))
        return arrays[-1]

    return read


#: The bytes of a pixel in most colour images: what is this far apart differs little.
_PIXEL = 3

#: How many bytes tell which of two forms is the shorter one.
_SAMPLE = 8_192


def _compressed(content: bytes) -> dict[str, Any]:
    """Return bytes compressed, as they are or as differences: 35 times as short for an image with smooth colours."""
    differences, middle = _differences(content), len(content) // 2
    sample = slice(middle - _SAMPLE // 2, middle + _SAMPLE // 2) if middle > _SAMPLE else slice(None)
    shorter = len(zlib.compress(differences[sample])) < len(zlib.compress(content[sample]))
    text = base64.b64encode(zlib.compress(differences if shorter else content)).decode()
    return {"zlib": text, "apart": _PIXEL} if shorter else {"zlib": text}


def _decompressed(entries: dict[str, Any]) -> bytes:
    try:
        content = zlib.decompress(base64.b64decode(entries["zlib"]))
    except zlib.error as error:
        raise ValueError(f"an array can't be read: {error}") from None
    return _sums(content, entries["apart"]) if "apart" in entries else content


def _differences(content: bytes, apart: int = _PIXEL) -> bytes:
    """Return each byte XOR the one that is `apart` bytes before it."""
    number = int.from_bytes(content, "little")
    return _bytes(number ^ number << 8 * apart, len(content))


def _sums(content: bytes, apart: int) -> bytes:
    """Return the bytes of which `content` has the differences: each is the XOR of all differences up to it."""
    size, number = len(content), int.from_bytes(content, "little")
    while apart < size:
        number = int.from_bytes(_bytes(number ^ number << 8 * apart, size), "little")
        apart *= 2
    return number.to_bytes(size, "little")


def _bytes(number: int, size: int) -> bytes:
    return (number & (1 << 8 * size) - 1).to_bytes(size, "little")
