"""What every buffer can do, and how packages such as tf2_geometry_msgs teach it to transform their types."""

from __future__ import annotations

from collections.abc import Callable
from copy import deepcopy
from typing import Any, ClassVar

from geometry_msgs.msg import TransformStamped
from rclpy.duration import Duration
from rclpy.time import Time


class TypeException(Exception):
    """There is no conversion for this type: the package that has it was not imported."""


class NotImplementedException(Exception):
    """This kind of buffer can't do that."""


class Stamped:
    """Any object with a time and a frame."""

    def __init__(self, obj: Any, stamp: Time, frame_id: str) -> None:
        self.obj, self.stamp, self.frame_id = obj, stamp, frame_id


class BufferInterface:
    """Transforms objects with a header, by lookups that a subclass has."""

    def __init__(self) -> None:
        self.registration = TransformRegistration()

    def transform(
        self, object_stamped: Any, target_frame: str, timeout: Duration | None = None, new_type: Any = None
    ) -> Any:
        """Return an object with a header, such as a PointStamped, in `target_frame` at its own time.

        Its type's package has to be imported: `import tf2_geometry_msgs`. Raises `TypeException` otherwise, and a
        `TransformException` where there is no transform within `timeout`.
        """
        do_transform = self.registration.get(type(object_stamped))
        header = object_stamped.header
        found = self.lookup_transform(target_frame, header.frame_id, _time(header.stamp), timeout or Duration())
        return _as_type(do_transform(object_stamped, found), new_type)

    def transform_full(
        self,
        object_stamped: Any,
        target_frame: str,
        target_time: Time,
        fixed_frame: str,
        timeout: Duration | None = None,
        new_type: Any = None,
    ) -> Any:
        """Return an object in `target_frame` at another time; in between, `fixed_frame` is taken not to move."""
        do_transform = self.registration.get(type(object_stamped))
        header = object_stamped.header
        found = self.lookup_transform_full(
            target_frame, target_time, header.frame_id, _time(header.stamp), fixed_frame, timeout or Duration()
        )
        return _as_type(do_transform(object_stamped, found), new_type)

    def _not_implemented(self, *arguments: Any, **named: Any) -> Any:
        raise NotImplementedException

    # What a subclass has: see `Buffer`.
    lookup_transform = lookup_transform_full = can_transform = can_transform_full = _not_implemented


class TransformRegistration:
    """How each type is transformed: a function of the object and a TransformStamped."""

    _functions: ClassVar[dict[Any, Callable[[Any, TransformStamped], Any]]] = {}

    def add(self, key: Any, callback: Callable[[Any, TransformStamped], Any]) -> None:
        """Register the function for a type."""
        self._functions[key] = callback

    def get(self, key: Any) -> Callable[[Any, TransformStamped], Any]:
        """Return the function for a type. Raises `TypeException`."""
        return _registered(self._functions, key, "transformed")


class ConvertRegistration:
    """How types are converted into one another, by way of a common message."""

    _to_message: ClassVar[dict[Any, Callable[[Any], Any]]] = {}
    _from_message: ClassVar[dict[Any, Callable[[Any], Any]]] = {}
    _directly: ClassVar[dict[Any, Callable[[Any], Any]]] = {}

    def add_from_msg(self, key: Any, callback: Callable[[Any], Any]) -> None:
        """Register how a type is made from a message."""
        self._from_message[key] = callback

    def add_to_msg(self, key: Any, callback: Callable[[Any], Any]) -> None:
        """Register how a type becomes a message."""
        self._to_message[key] = callback

    def add_convert(self, key: tuple[Any, Any], callback: Callable[[Any], Any]) -> None:
        """Register how the first type of `key` becomes the second."""
        self._directly[key] = callback

    def get_from_msg(self, key: Any) -> Callable[[Any], Any]:
        """Return how a type is made from a message. Raises `TypeException`."""
        return _registered(self._from_message, key, "made from a message")

    def get_to_msg(self, key: Any) -> Callable[[Any], Any]:
        """Return how a type becomes a message. Raises `TypeException`."""
        return _registered(self._to_message, key, "made a message")

    def get_convert(self, key: tuple[Any, Any]) -> Callable[[Any], Any]:
        """Return how one type becomes another. Raises `TypeException`."""
        return _registered(self._directly, key, "converted")


def convert(a: Any, b_type: Any) -> Any:
    """Return `a` as another type. Raises `TypeException` if nobody has registered how."""
    registration = ConvertRegistration()
    if type(a) is b_type:
        return deepcopy(a)
    try:
        return registration.get_convert((type(a), b_type))(a)
    except TypeException:
        return registration.get_from_msg(b_type)(registration.get_to_msg(type(a))(a))


def _registered(functions: dict[Any, Callable[..., Any]], key: Any, done: str) -> Callable[..., Any]:
    try:
        return functions[key]
    except KeyError:
        name = getattr(key, "__name__", str(key))
        fix = "import the package that has it, such as tf2_geometry_msgs"
        raise TypeException(f"{name} can't be {done}: {fix}") from None


def _time(stamp: Any) -> Time:
    return Time.from_msg(stamp)


def _as_type(transformed: Any, new_type: Any) -> Any:
    return transformed if new_type is None else convert(transformed, new_type)
