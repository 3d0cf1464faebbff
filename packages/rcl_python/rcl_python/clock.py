"""Clocks, jumps of their time, and timers. The arithmetic is rcl's (rcl/time.c, rcl/timer.c)."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, TypeAlias

from rcl_python import participant
from rcl_python.context import Context, wake
from rcl_python.handle import Destroyable
from rcl_python.values import ClockChange, ClockType, RCLError, rcl_time_point_t

Jump: TypeAlias = "Callable[[ClockChange, int, bool], None]"
"""Called before and after a jump with: what changed, by how much (ns), and whether it is before."""

_ON_OFF = (ClockChange.ROS_TIME_ACTIVATED, ClockChange.ROS_TIME_DEACTIVATED)


class Clock(Destroyable):
    """A clock. Raises RCLError for an invalid type."""

    def __init__(self, clock_type: int) -> None:
        self._destroyed = True
        if int(clock_type) not in (1, 2, 3):
            raise RCLError("failed to initialize clock: error not set")
        super().__init__()
        self.type = ClockType(int(clock_type))
        self.overridden = False
        self._override = 0
        self._jumps: list[tuple[Any, Jump, bool, int, int]] = []

    def now(self) -> int:
        """Return the time (ns)."""
        link = participant.current().link
        if self.type is ClockType.STEADY_TIME:
            return link.steady()
        return self._override if self.overridden else link.system()

    def get_now(self) -> rcl_time_point_t:
        """Return the time."""
        return rcl_time_point_t(self.now(), self.type)

    def get_ros_time_override_is_enabled(self) -> bool:
        """Return whether the clock follows a time that is set. Raises RCLError for a clock that can't."""
        self._require_ros_time("failed to get ROS time override status")
        return self.overridden

    def set_ros_time_override_is_enabled(self, enabled: bool) -> None:
        """Follow what `set_ros_time_override` says, or the system again."""
        self._require_ros_time("failed to set ROS time override")
        if enabled == self.overridden:
            return
        change = ClockChange.ROS_TIME_ACTIVATED if enabled else ClockChange.ROS_TIME_DEACTIVATED
        self._tell(change, 0, True)
        self.overridden = enabled
        self._tell(change, 0, False)
        wake()

    def set_ros_time_override(self, point: rcl_time_point_t) -> None:
        """Set the time."""
        self._require_ros_time("failed to set ROS time override")
        delta = point.nanoseconds - self._override
        if self.overridden:
            self._tell(ClockChange.ROS_TIME_NO_CHANGE, delta, True)
        self._override = point.nanoseconds
        if self.overridden:
            self._tell(ClockChange.ROS_TIME_NO_CHANGE, delta, False)
        wake()

    def _require_ros_time(self, what: str) -> None:
        if self.type is not ClockType.ROS_TIME:
            raise RCLError(f"{what}: Clock is not of type RCL_ROS_TIME")

    def add_clock_callback(self, handle: Any, on_clock_change: bool, forward: int, backward: int) -> None:
        """Notify rclpy's JumpHandle of jumps of at least `forward` or `backward` ns, unless these are 0."""

        def jumped(change: ClockChange, delta: int, before: bool) -> None:
            if before and handle._pre_callback is not None:
                handle._pre_callback()
            elif not before and handle._post_callback is not None:
                handle._post_callback({"clock_change": change, "delta": delta})

        self.watch(handle, jumped, on_clock_change, forward, backward)

    def watch(self, key: object, jumped: Jump, on_change: bool, forward: int, backward: int) -> None:
        """Call `jumped` on jumps; `key` names it for `unwatch`. Raises RCLError for invalid thresholds."""
        if forward < 0 or backward > 0:
            raise RCLError("failed to add time jump callback: forward jump threshold must be positive or zero")
        self._jumps.append((key, jumped, on_change, forward, backward))

    def unwatch(self, key: object) -> None:
        """Forget what `key` named."""
        self._jumps = [jump for jump in self._jumps if jump[0] is not key]

    def remove_clock_callback(self, handle: Any) -> None:
        """Stop notifying rclpy's JumpHandle."""
        if all(jump[0] is not handle for jump in self._jumps):
            raise RCLError("failed to remove time jump callback: jump callback was not found")
        self.unwatch(handle)

    def _tell(self, change: ClockChange, delta: int, before: bool) -> None:
        for _, jumped, on_change, forward, backward in list(self._jumps):
            by_change = change in _ON_OFF and on_change
            by_size = (delta > 0 and forward and delta >= forward) or (delta < 0 and backward and delta <= backward)
            if by_change or by_size:
                jumped(change, delta, before)


class ClockEvent:
    """An event that a program can wait for, up to a time."""

    def __init__(self) -> None:
        self._set = False

    def is_set(self) -> bool:
        """Return whether it has been set."""
        return self._set

    def set(self) -> None:
        """Set it, and wake those who wait."""
        self._set = True
        wake()

    def clear(self) -> None:
        """Unset it."""
        self._set = False

    def wait_until_steady(self, clock: Clock, until: rcl_time_point_t) -> None:
        """Wait until it is set, or until that time."""
        self._wait(clock, until.nanoseconds)

    wait_until_system = wait_until_steady
    wait_until_ros = wait_until_steady

    def _wait(self, clock: Clock, until: int) -> None:
        interrupted: KeyboardInterrupt | None = None
        here = participant.current()
        with here.link.lock:
            while not self._set:
                left = None if clock.overridden else until - clock.now()
                if left is not None and left <= 0:
                    break
                try:
                    here.link.wait(left)
                except KeyboardInterrupt as error:
                    interrupted = error  # what waits in C hears of it only afterwards
                here.pump()
        if interrupted is not None:
            raise interrupted


class Timer(Destroyable):
    """A timer of `period` ns."""

    def __init__(self, clock: Clock, context: Context, period: int, autostart: bool = True) -> None:
        self._destroyed = True
        if period < 0:
            raise RCLError("failed to create timer: timer period must be non-negative")
        context.require_valid("failed to create timer", "rcl/timer.c:153")
        self.clock = clock
        self.period = period
        self.canceled = not autostart
        self._credit = 0
        self._last = clock.now()
        self._next = self._last + period
        clock.watch(self, self._jumped, True, 1, -1)
        super().__init__()

    def _destroy(self) -> None:
        self.clock.unwatch(self)

    def _jumped(self, change: ClockChange, delta: int, before: bool) -> None:
        """Keep what was left of the period when ROS time starts or ends; after a jump back, start again."""
        now = self.clock.now()
        if change in _ON_OFF:
            self._keep_credit(now, before)
        elif not before and now < self._last and now < self._next:
            self._next, self._last = now + self.period, now

    def _keep_credit(self, now: int, before: bool) -> None:
        if now == 0:
            return
        if before:
            self._credit = self._next - now
        elif self._credit:
            self._next, self._last = now - self._credit + self.period, now - self._credit
            self._credit = 0

    def is_timer_ready(self) -> bool:
        """Return whether it is due."""
        return not self.canceled and self.clock.now() >= self._next

    is_ready = is_timer_ready

    def due(self) -> int | None:
        """Return how long until it is due (ns); None if waiting does not make it due."""
        if self.canceled or self.clock.overridden:
            return None
        return self._next - self.clock.now()

    def call_timer(self) -> None:
        """Begin the next period. Raises RCLError for a canceled timer."""
        if self.canceled:
            raise RCLError("failed to call timer: timer is canceled")
        now = self.clock.now()
        self._last = now
        self._next += self.period
        if self._next <= now:
            # Periods that have passed meanwhile are left out; one that is due at this very moment has passed, too.
            self._next = now if not self.period else self._next + self.period * (1 + (now - self._next) // self.period)

    def cancel_timer(self) -> None:
        """Cancel it: it no longer fires."""
        self.canceled = True

    def is_timer_canceled(self) -> bool:
        """Return whether it is canceled."""
        return self.canceled

    def reset_timer(self) -> None:
        """Start a new period now."""
        self._next = self.clock.now() + self.period
        self.canceled = False
        wake()

    def change_timer_period(self, period: int) -> None:
        """Make the periods after this one longer or shorter (ns)."""
        self.period = period

    def get_timer_period(self) -> int:
        """Return the period (ns)."""
        return self.period

    def time_since_last_call(self) -> int:
        """Return how long ago the period began (ns)."""
        return self.clock.now() - self._last

    def time_until_next_call(self) -> int | None:
        """Return how long until it is due (ns); None for a canceled timer."""
        return None if self.canceled else self._next - self.clock.now()

    def expire_at(self, moment: int) -> None:
        """Let it fire once, at a time of its clock (ns)."""
        self._next, self.canceled = moment, False
