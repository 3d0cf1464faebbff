"""A buffer of transforms that answers at once, waits, or gives a future."""

from __future__ import annotations

import threading
from collections.abc import Callable
from time import sleep
from typing import Any

from geometry_msgs.msg import TransformStamped
from rclpy.clock import Clock
from rclpy.duration import Duration
from rclpy.node import Node
from rclpy.task import Future
from rclpy.time import Time
from tf2_py import BufferCore, TransformException

from tf2_ros.buffer_interface import BufferInterface

#: How long to sleep between two looks, while a thread waits for a transform (s).
_LOOK = 0.02


class Buffer(BufferCore, BufferInterface):
    """Keeps transforms, usually those that a `TransformListener` puts into it.

    With a `node`, its clock decides how long a lookup waits, and the service `tf2_frames` tells all frames.
    """

    def __init__(self, cache_time: Duration | None = None, node: Node | None = None) -> None:
        BufferCore.__init__(self, cache_time)
        BufferInterface.__init__(self)
        self._clock = node.get_clock() if node else Clock()
        self._waiting: dict[Future, Callable[[], TransformStamped]] = {}
        self._waiting_lock = threading.Lock()
        self.srv = _frames_service(node, self) if node else None

    # --- taking transforms

    def set_transform(self, transform: TransformStamped, authority: str) -> bool:
        """Add a transform, and answer those who wait for it."""
        taken = super().set_transform(transform, authority)
        self._answer_waiting()
        return taken

    def set_transform_static(self, transform: TransformStamped, authority: str) -> bool:
        """Add a transform that holds at every time, and answer those who wait for it."""
        taken = super().set_transform_static(transform, authority)
        self._answer_waiting()
        return taken

    # --- answers, at once or after waiting

    def lookup_transform(
        self, target_frame: str, source_frame: str, time: Time, timeout: Duration | None = None
    ) -> TransformStamped:
        """Return where `source_frame` is in `target_frame` at `time`; `Time()` is the newest that is known.

        Waits up to `timeout`: only while another thread spins the node. Raises a `TransformException`.
        """
        if timeout:
            self.can_transform(target_frame, source_frame, time, timeout)
        return self.lookup_transform_core(target_frame, source_frame, time)

    def lookup_transform_full(
        self,
        target_frame: str,
        target_time: Time,
        source_frame: str,
        source_time: Time,
        fixed_frame: str,
        timeout: Duration | None = None,
    ) -> TransformStamped:
        """Return where `source_frame` was at `source_time`, in `target_frame` as that is at `target_time`."""
        if timeout:
            self.can_transform_full(target_frame, target_time, source_frame, source_time, fixed_frame, timeout)
        return self.lookup_transform_full_core(target_frame, target_time, source_frame, source_time, fixed_frame)

    def can_transform(
        self,
        target_frame: str,
        source_frame: str,
        time: Time,
        timeout: Duration | None = None,
        return_debug_tuple: bool = False,
    ) -> Any:
        """Return whether there is a transform, after waiting up to `timeout`; as a tuple, also why not."""
        answer = self._wait(lambda: self.can_transform_core(target_frame, source_frame, time), timeout)
        return answer if return_debug_tuple else answer[0]

    def can_transform_full(
        self,
        target_frame: str,
        target_time: Time,
        source_frame: str,
        source_time: Time,
        fixed_frame: str,
        timeout: Duration | None = None,
        return_debug_tuple: bool = False,
    ) -> Any:
        """Return whether there is a transform between two times, after waiting up to `timeout`."""
        answer = self._wait(
            lambda: self.can_transform_full_core(target_frame, target_time, source_frame, source_time, fixed_frame),
            timeout,
        )
        return answer if return_debug_tuple else answer[0]

    def _wait(self, look: Callable[[], tuple[bool, str]], timeout: Duration | None) -> tuple[bool, str]:
        answer = look()
        if not timeout or not timeout.nanoseconds:
            return answer
        until = self._clock.now() + timeout
        while not answer[0] and self._clock.now() < until and self._clock_goes_on():
            sleep(_LOOK)
            answer = look()
        return answer

    def _clock_goes_on(self) -> bool:
        # A simulated clock that has not begun would keep a thread waiting for ever.
        return bool(self._clock.now().nanoseconds)

    # --- answers later

    async def lookup_transform_async(self, target_frame: str, source_frame: str, time: Time) -> TransformStamped:
        """Wait for a transform in a coroutine, and return it."""
        await self.wait_for_transform_async(target_frame, source_frame, time)
        return self.lookup_transform(target_frame, source_frame, time)

    async def lookup_transform_full_async(
        self, target_frame: str, target_time: Time, source_frame: str, source_time: Time, fixed_frame: str
    ) -> TransformStamped:
        """Wait for a transform between two times in a coroutine, and return it."""
        await self.wait_for_transform_full_async(target_frame, target_time, source_frame, source_time, fixed_frame)
        return self.lookup_transform_full(target_frame, target_time, source_frame, source_time, fixed_frame)

    def wait_for_transform_async(self, target_frame: str, source_frame: str, time: Time) -> Future:
        """Return a future that gets the transform when it can be looked up."""
        return self._future(lambda: self.lookup_transform_core(target_frame, source_frame, time))

    def wait_for_transform_full_async(
        self, target_frame: str, target_time: Time, source_frame: str, source_time: Time, fixed_frame: str
    ) -> Future:
        """Return a future that gets the transform between two times when it can be looked up."""
        return self._future(
            lambda: self.lookup_transform_full_core(target_frame, target_time, source_frame, source_time, fixed_frame)
        )

    def _future(self, look: Callable[[], TransformStamped]) -> Future:
        future = Future()
        with self._waiting_lock:
            self._waiting[future] = look
        self._answer_waiting()
        return future

    def _answer_waiting(self) -> None:
        with self._waiting_lock:
            waiting = list(self._waiting.items())
        for future, look in waiting:
            try:
                answer = look()
            except TransformException:
                if not future.cancelled():
                    continue
            else:
                future.set_result(answer)
            with self._waiting_lock:
                self._waiting.pop(future, None)


def _frames_service(node: Node, buffer: BufferCore) -> Any:
    """Return the service by which view_frames asks for all frames; None where tf2_msgs is not compiled."""
    try:
        from tf2_msgs.srv import FrameGraph
    except ImportError:
        return None

    def answer(_: Any, response: Any) -> Any:
        response.frame_yaml = buffer.all_frames_as_yaml()
        return response

    return node.create_service(FrameGraph, "tf2_frames", answer)
