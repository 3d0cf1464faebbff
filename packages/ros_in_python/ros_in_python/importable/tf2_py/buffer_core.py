"""The tree of frames: takes transforms, and answers where a frame is in another.

The rules are those of tf2: https://docs.ros.org/en/jazzy/Concepts/Intermediate/About-Tf2.html
"""

from __future__ import annotations

import math
import threading
from collections.abc import Callable, Container

from builtin_interfaces.msg import Time as TimeMessage
from geometry_msgs.msg import Quaternion as QuaternionMessage
from geometry_msgs.msg import Transform, TransformStamped, Vector3
from rclpy.duration import Duration
from rclpy.logging import get_logger
from rclpy.time import Time

from tf2_py.exceptions import (
    ConnectivityException,
    ExtrapolationException,
    InvalidArgumentException,
    LookupException,
    TransformException,
)
from tf2_py.frame_history import SECOND, FrameHistory
from tf2_py.rigid_motion import IDENTITY, RigidMotion, normalized

#: How much is kept, unless another duration is given (s).
DEFAULT_CACHE_TIME = 10.0

#: How far the square of a quaternion's length may be from 1.
_UNIT_TOLERANCE = 1e-6


class BufferCore:
    """Keeps the transforms of the last `cache_time` (10 s), and answers from them. May be used from several threads.

    A time is rclpy's or a message; None, or 0, is the newest that is known.
    """

    def __init__(self, cache_time: Duration | None = None) -> None:
        self._keep = cache_time.nanoseconds if cache_time else round(DEFAULT_CACHE_TIME * SECOND)
        self._histories: dict[str, FrameHistory] = {}
        self._parents: set[str] = set()
        self._lock = threading.RLock()

    # --- taking transforms

    def set_transform(self, transform: TransformStamped, authority: str) -> bool:
        """Add a transform that holds at its time. Return whether it was taken; if not, the log says why."""
        return self._set(transform, authority, is_static=False)

    def set_transform_static(self, transform: TransformStamped, authority: str) -> bool:
        """Add a transform that holds at every time. Return whether it was taken; if not, the log says why."""
        return self._set(transform, authority, is_static=True)

    def _set(self, transform: TransformStamped, authority: str, is_static: bool) -> bool:
        child, parent = transform.child_frame_id.lstrip("/"), transform.header.frame_id.lstrip("/")
        motion = _motion_of(transform.transform)
        problem = _problem_with(child, parent, motion) or self._add(
            child, parent, _nanoseconds(transform.header.stamp), motion, authority, is_static
        )
        if problem:
            get_logger("tf2").warning(f"A transform from {parent!r} to {child!r} by {authority} is ignored: {problem}.")
        return not problem

    def _add(self, child: str, parent: str, time: int, motion: RigidMotion, authority: str, is_static: bool) -> str:
        motion = RigidMotion(motion.translation, normalized(motion.rotation))
        with self._lock:
            history = self._histories.get(child)
            if history is None or history.is_static != is_static:
                history = self._histories[child] = FrameHistory(self._keep, is_static)
            history.authority = authority
            self._parents.add(parent)
            return history.add(time, parent, motion)

    def clear(self) -> None:
        """Forget all transforms that are not static."""
        with self._lock:
            self._histories = {name: history for name, history in self._histories.items() if history.is_static}

    # --- questions

    def lookup_transform_core(self, target_frame: str, source_frame: str, time: Time) -> TransformStamped:
        """Return where `source_frame` is in `target_frame`; at time 0, at the newest time that is known for both.

        Raises a `TransformException`.
        """
        with self._lock:
            self._check(target_frame, source_frame, function="lookup_transform")
            moment = _nanoseconds(time) or self._newest_common(target_frame, source_frame)
            motion = self._motion(target_frame, source_frame, moment)
        return _message(motion, target_frame, source_frame, moment)

    def lookup_transform_full_core(
        self, target_frame: str, target_time: Time, source_frame: str, source_time: Time, fixed_frame: str
    ) -> TransformStamped:
        """Return where `source_frame` was at `source_time`, in `target_frame` as that is at `target_time`.

        In between, `fixed_frame` is taken not to move. Raises a `TransformException`.
        """
        with self._lock:
            self._check(target_frame, source_frame, fixed_frame, function="lookup_transform_full")
            then = _nanoseconds(source_time) or self._newest_common(fixed_frame, source_frame)
            now = _nanoseconds(target_time) or self._newest_common(target_frame, fixed_frame)
            motion = self._motion(fixed_frame, source_frame, then).then(self._motion(target_frame, fixed_frame, now))
        return _message(motion, target_frame, source_frame, now)

    def can_transform_core(self, target_frame: str, source_frame: str, time: Time) -> tuple[bool, str]:
        """Return whether `lookup_transform_core` would have an answer, and if not, why."""
        return _attempt(lambda: self.lookup_transform_core(target_frame, source_frame, time))

    def can_transform_full_core(
        self, target_frame: str, target_time: Time, source_frame: str, source_time: Time, fixed_frame: str
    ) -> tuple[bool, str]:
        """Return whether `lookup_transform_full_core` would have an answer, and if not, why."""
        return _attempt(
            lambda: self.lookup_transform_full_core(target_frame, target_time, source_frame, source_time, fixed_frame)
        )

    def get_latest_common_time(self, target_frame: str, source_frame: str) -> Time:
        """Return the newest time at which the whole chain between both frames is known. Raises `TransformException`."""
        with self._lock:
            self._check(target_frame, source_frame, function="get_latest_common_time")
            return Time(nanoseconds=self._newest_common(target_frame, source_frame))

    def all_frames_as_string(self) -> str:
        """Return a line for each frame that has a parent."""
        with self._lock:
            lines = [f"Frame {name} exists with parent {at.parents[-1]}." for name, at in self._histories.items()]
        return "\n".join(lines) + ("\n" if lines else "")

    def all_frames_as_yaml(self, current_time: float = 0.0) -> str:
        """Return all frames as YAML, with their parents, rates (Hz) and times (s), as view_frames reads them."""
        with self._lock:
            return "".join(_as_yaml(name, at, current_time) for name, at in self._histories.items()) or "{}\n"

    # The names by which tf2's own tools call the same.
    _allFramesAsYAML = all_frames_as_yaml  # noqa: N815

    def _frameExists(self, frame: str) -> bool:  # noqa: N802
        return frame in self._histories or frame in self._parents

    def _getFrameStrings(self) -> list[str]:  # noqa: N802
        with self._lock:
            return sorted({*self._histories, *self._parents})

    # --- the way from one frame to the other

    def _check(self, *frames: str, function: str) -> None:
        for frame in frames:
            if not frame or frame.startswith("/"):
                reason = "it begins with a slash" if frame else "it is empty"
                raise InvalidArgumentException(f"{frame!r} given to {function} is not the name of a frame: {reason}")
        for frame in frames:
            if not self._frameExists(frame):
                known = ", ".join(self._getFrameStrings()) or "none yet"
                raise LookupException(
                    f'"{frame}" given to {function} does not exist: no transform with this frame has arrived '
                    f"(known frames: {known})"
                )

    def _motion(self, target: str, source: str, time: int) -> RigidMotion:
        """Return where `source` is in `target`, by way of the nearest frame above both."""
        if target == source:
            return IDENTITY
        above_source, gap = self._upwards(source, time)
        above_target, other_gap = self._upwards(target, time, until=above_source)
        meeting = next(reversed(above_target))
        if meeting in above_source:
            return above_source[meeting].then(above_target[meeting].inverse())
        if gap or other_gap:
            raise ExtrapolationException(f"{source!r} in {target!r} {gap or other_gap}")
        raise ConnectivityException(_UNCONNECTED.format(source, target))

    def _upwards(self, frame: str, time: int, until: Container[str] = ()) -> tuple[dict[str, RigidMotion], str]:
        """Return where `frame` is in itself, in its parent, in that one's, and so on to the root or to one in `until`.

        Where a frame is not known at this time, the way ends, and the text says why: the other frame's way may
        meet it below.
        """
        motions, current, motion = {frame: IDENTITY}, frame, IDENTITY
        while current not in until and (history := self._histories.get(current)):
            try:
                parent, step = history.at(time)
            except ExtrapolationException as error:
                return motions, str(error)
            if parent in motions:
                raise LookupException(f"the frames form a loop: {' -> '.join([*motions, parent])}")
            current, motion = parent, motion.then(step)
            motions[current] = motion
        return motions, ""

    def _newest_common(self, target: str, source: str) -> int:
        """Return the newest time that is known for each frame between both (ns); 0 if all of them are static."""
        chain_of_target, chain_of_source = self._chain(target), self._chain(source)
        common = set(chain_of_target) & set(chain_of_source)
        if not common:
            raise ConnectivityException(_UNCONNECTED.format(source, target))
        moving = [
            history.newest
            for chain in (chain_of_target, chain_of_source)
            for frame in chain
            if frame not in common and not (history := self._histories[frame]).is_static
        ]
        return min(moving, default=self._newest_of(target) if target == source else 0)

    def _newest_of(self, frame: str) -> int:
        history = self._histories.get(frame)
        return history.newest if history and not history.is_static else 0

    def _chain(self, frame: str) -> list[str]:
        """Return the frame, its newest parent, that one's, and so on."""
        chain = [frame]
        while history := self._histories.get(chain[-1]):
            parent = history.parents[-1]
            if parent in chain:
                raise LookupException(f"the frames form a loop: {' -> '.join([*chain, parent])}")
            chain.append(parent)
        return chain


_UNCONNECTED = (
    "{!r} and {!r} are not connected: no chain of transforms joins them, there are two or more separate trees"
)


def _problem_with(child: str, parent: str, motion: RigidMotion) -> str:
    """Return why a transform can't be taken, or an empty text."""
    if not child or not parent:
        return "child_frame_id is empty" if not child else "header.frame_id is empty"
    if child == parent:
        return "a frame can't be its own parent"
    if not all(math.isfinite(value) for value in (*motion.translation, *motion.rotation)):
        return "a number in it is not finite"
    if abs(sum(value * value for value in motion.rotation) - 1.0) > _UNIT_TOLERANCE:
        return f"its rotation is not a unit quaternion: {motion.rotation}"
    return ""


def _attempt(lookup: Callable[[], TransformStamped]) -> tuple[bool, str]:
    try:
        lookup()
    except TransformException as error:
        return False, str(error)
    return True, ""


def _nanoseconds(time: Time | TimeMessage | None) -> int:
    if time is None:
        return 0
    if isinstance(time, Time):
        return int(time.nanoseconds)
    return int(time.sec) * SECOND + int(time.nanosec)


def _motion_of(transform: Transform) -> RigidMotion:
    move, turn = transform.translation, transform.rotation
    return RigidMotion((move.x, move.y, move.z), (turn.x, turn.y, turn.z, turn.w))


def _message(motion: RigidMotion, target: str, source: str, time: int) -> TransformStamped:
    (x, y, z), (i, j, k, w) = motion
    message = TransformStamped(child_frame_id=source)
    message.header.frame_id = target
    message.header.stamp = TimeMessage(sec=time // SECOND, nanosec=time % SECOND)
    message.transform = Transform(translation=Vector3(x=x, y=y, z=z), rotation=QuaternionMessage(x=i, y=j, z=k, w=w))
    return message


def _as_yaml(name: str, history: FrameHistory, now: float) -> str:
    oldest, newest = history.times[0] / SECOND, history.newest / SECOND
    span = newest - oldest
    # tf2 gives 10000 Hz for a frame with one transform.
    rate = (len(history.times) - 1) / span if span > 0 else 10000.0
    values = {
        "parent": f"'{history.parents[-1]}'",
        "broadcaster": f"'{history.authority}'",
        "rate": f"{rate:.3f}",
        "most_recent_transform": f"{newest:.6f}",
        "oldest_transform": f"{oldest:.6f}",
        **({"transform_delay": f"{now - newest:.6f}"} if now > 0 else {}),
        "buffer_length": f"{span:.3f}",
    }
    return f"{name}: \n" + "".join(f"  {key}: {value}\n" for key, value in values.items())
