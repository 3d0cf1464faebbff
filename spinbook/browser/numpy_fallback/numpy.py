"""The part of numpy that generated message classes need: one-dimensional arrays of a fixed number of numbers.

There is no numpy for web pages without a package repository of their own. rclpy itself needs none.
"""

from __future__ import annotations

import array as _array
import operator
from collections.abc import Iterable, Iterator
from typing import Any


class generic:  # noqa: N801
    """The base class of numpy's numbers: here numbers are Python's own, so nothing is an instance of it."""


class dtype:  # noqa: N801
    """A type of numbers."""

    def __init__(self, name: str, code: str, kind: type) -> None:
        self.__name__ = self.name = name
        self.code, self.kind = code, kind

    def __call__(self, value: Any = 0) -> Any:
        return self.kind(value)

    def __repr__(self) -> str:
        return f"dtype('{self.name}')"


float64, float32 = dtype("float64", "d", float), dtype("float32", "f", float)
int8, uint8 = dtype("int8", "b", int), dtype("uint8", "B", int)
int16, uint16 = dtype("int16", "h", int), dtype("uint16", "H", int)
int32, uint32 = dtype("int32", "i", int), dtype("uint32", "I", int)
int64, uint64 = dtype("int64", "q", int), dtype("uint64", "Q", int)


class ndarray:  # noqa: N801
    """A fixed number of numbers."""

    def __init__(self, values: Iterable[Any], kind: dtype) -> None:
        self._values = _array.array(kind.code, values)
        self.dtype = kind

    @property
    def size(self) -> int:
        """The number of elements."""
        return len(self._values)

    @property
    def shape(self) -> tuple[int]:
        """The shape in numpy's form."""
        return (len(self._values),)

    @property
    def ndim(self) -> int:
        """Always one."""
        return 1

    def __len__(self) -> int:
        return len(self._values)

    def __getitem__(self, index: Any) -> Any:
        found = self._values[index]
        return ndarray(found, self.dtype) if isinstance(index, slice) else found

    def __setitem__(self, index: int, value: Any) -> None:
        self._values[index] = value

    def __iter__(self) -> Iterator[Any]:
        return iter(self._values)

    def __eq__(self, other: object) -> Any:
        return list(map(operator.eq, self, other)) if isinstance(other, Iterable) else False

    def __ne__(self, other: object) -> Any:
        return list(map(operator.ne, self, other)) if isinstance(other, Iterable) else True

    __hash__ = None  # type: ignore[assignment]

    def __repr__(self) -> str:
        return f"array({list(self._values)})"

    def tolist(self) -> list[Any]:
        """Return the numbers as a list."""
        return self._values.tolist()

    def tobytes(self) -> bytes:
        """Return the bytes of the numbers in memory."""
        return self._values.tobytes()

    def copy(self) -> ndarray:
        """Return a copy."""
        return ndarray(self._values, self.dtype)


def array(values: Iterable[Any], dtype: dtype = float64) -> ndarray:
    """Return an array of these numbers."""
    return ndarray(values, dtype)


def zeros(shape: int | tuple[int, ...], dtype: dtype = float64) -> ndarray:
    """Return an array of zeros."""
    return ndarray([0] * (shape if isinstance(shape, int) else shape[0]), dtype)


def __getattr__(name: str) -> Any:
    if name.startswith("__"):
        raise AttributeError(name)
    text = (
        f"There is no numpy.{name}: a web page does not have numpy. The program runs in a notebook and in the grader."
    )
    raise AttributeError(text)
