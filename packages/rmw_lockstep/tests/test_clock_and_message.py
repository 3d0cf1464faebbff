"""A message behind a barrier comes after all that the time before it has caused, and no executor wakes in vain."""

from __future__ import annotations

from textwrap import dedent
from typing import Any

import pytest
from builtin_interfaces.msg import Time
from programs import Watch, serialized
from rclpy.serialization import serialize_message
from rosgraph_msgs.msg import Clock

from rmw_lockstep.hub import QosPolicies

#: A node that takes its time from /clock and says what it hears, and when.
LISTENER = """
    from rclpy.clock import JumpThreshold
    from rclpy.duration import Duration
    from rclpy.parameter import Parameter
    from rclpy.task import Future
    sim_time = [Parameter('use_sim_time', value=True)]
    def seconds(): return node.get_clock().now().nanoseconds / 1e9
    def hear(message): say(f'{message.data} at {seconds():g}')
    node.create_subscription(String, '/heard', hear, 10)
    node.set_parameters(sim_time)
    def at_each_jump(callback):
        steps = JumpThreshold(min_forward=Duration(nanoseconds=1), min_backward=None, on_clock_change=False)
        return node.get_clock().create_jump_callback(steps, post_callback=lambda jump: callback())
"""

EXECUTOR = """
executor = SingleThreadedExecutor()
executor.add_node(node)
"""


class Robot:
    """What sends the time on /clock, and messages on /heard."""

    def __init__(self, watch: Watch) -> None:
        self._watch = watch
        self._clock = watch.node.publisher("/clock", "rosgraph_msgs/msg/Clock", QosPolicies(depth=10))
        self._heard = watch.node.publisher("/heard", "std_msgs/msg/String", QosPolicies(depth=10))

    def step(self, second: int) -> None:
        """Send the time (s), and behind a barrier a message."""
        message: Any = Clock(clock=Time(sec=second))
        self._clock.publish(bytes(serialize_message(message)))
        self._watch.hub.barrier()
        self._heard.publish(serialized(f"message {second}"))
        self._watch.go_on(0)


@pytest.fixture
def robot(watch: Watch) -> Robot:
    return Robot(watch)


CAUSED = {
    "a timer of a node that the executor looks at later": """
        other = rclpy.create_node('other')
        other.set_parameters(sim_time)
        executor.add_node(other)
        other.create_timer(1.0, lambda: say('caused'))
    """,
    "a task": "jumps = at_each_jump(lambda: executor.create_task(lambda: say('caused')))",
    "a coroutine that awaits the jump": """
        jumped = Future()
        async def wait():
            await jumped
            say('caused')
        executor.create_task(wait)
        jumps = at_each_jump(lambda: jumped.set_result(None))
    """,
    "a coroutine that awaits another one, which awaits the jump": """
        first, second = Future(), Future()
        async def one():
            await first
            second.set_result(None)
        async def two():
            await second
            say('caused')
        executor.create_task(one)
        executor.create_task(two)
        jumps = at_each_jump(lambda: first.set_result(None))
    """,
    "a task of another thread": """
        jumped = threading.Event()
        def work():
            jumped.wait()
            executor.create_task(lambda: say('caused'))
        threading.Thread(target=work, daemon=True).start()
        jumps = at_each_jump(jumped.set)
    """,
    "a guard condition": """
        guard = node.create_guard_condition(lambda: say('caused'))
        jumps = at_each_jump(guard.trigger)
    """,
    "a message of its own": """
        node.create_subscription(String, '/own', lambda message: say('caused'), 10)
        own = node.create_publisher(String, '/own', 10)
        jumps = at_each_jump(lambda: own.publish(String()))
    """,
}


@pytest.mark.parametrize("cause", CAUSED)
def test_what_the_time_causes_comes_before_the_message(watch: Watch, robot: Robot, cause: str) -> None:
    watch.start(dedent(LISTENER) + EXECUTOR + dedent(CAUSED[cause]) + "\nexecutor.spin()")
    watch.go_on(0)
    for second in (10, 20):
        robot.step(second)
    said = [text for _, text in watch.said()]
    assert said.index("caused") < said.index("message 20 at 20")
    if "timer" not in cause:  # which begins at the first time
        assert said.index("caused") < said.index("message 10 at 10")


#: Counts how often the executor waits.
COUNTS_WAITS = """
import rclpy.executors
class Waits:
    made = 0
    def __getattr__(self, name):
        Waits.made += name == 'WaitSet'
        return getattr(real, name)
real, rclpy.executors._rclpy = rclpy.executors._rclpy, Waits()
"""


def waits_per_step(watch: Watch, robot: Robot, more: str = "") -> float:
    """Let a program hear 30 messages; return how often its executor waits for each, with the time before it."""
    hear = """
def hear(message): say(f'{message.data} at {seconds():g} after {Waits.made}')
node.create_subscription(String, '/heard', hear, 10)
"""
    watch.start(dedent(LISTENER) + COUNTS_WAITS + hear + EXECUTOR + dedent(more) + "\nexecutor.spin()")
    watch.go_on(0)
    for second in range(1, 31):
        robot.step(second)
    said = [text.split(" after ") for _, text in watch.said() if " after " in text]
    assert [text for text, _ in said] == [f"message {second} at {second}" for second in range(1, 31)]
    return (int(said[-1][1]) - int(said[0][1])) / 29


def test_an_executor_that_only_runs_callbacks_does_not_wake_itself(watch: Watch, robot: Robot) -> None:
    assert waits_per_step(watch, robot) == 2.0


def test_an_executor_with_a_coroutine_wakes_itself_after_each_callback(watch: Watch, robot: Robot) -> None:
    coroutine = """
        async def wait_for_ever(): await Future()
        executor.create_task(wait_for_ever)
    """
    assert waits_per_step(watch, robot, coroutine) == 4.0


def test_a_callback_that_awaits_goes_on_as_soon_as_what_it_awaits_is_there(watch: Watch, robot: Robot) -> None:
    watch.start(
        dedent(LISTENER)
        + dedent("""
            from rclpy.callback_groups import ReentrantCallbackGroup
            waiting = []
            async def relay(message):
                before, own = (waiting[-1] if waiting else None), Future()
                waiting.append(own)
                if before: await before
                say('relayed ' + message.data)
                own.set_result(None)
            async def begin(message):
                first = Future()
                waiting.append(first)
                await jumped
                first.set_result(None)
                say('begun')
            jumped = Future()
            def jump():
                if seconds() >= 4 and not jumped.done(): jumped.set_result(None)
            jumps = at_each_jump(jump)
            groups = ReentrantCallbackGroup()
            calls = iter([begin, relay, relay, relay, relay])
            async def chain(message): await next(calls)(message)
            node.create_subscription(String, '/heard', chain, 10, callback_group=groups)
            rclpy.spin(node)
        """)
    )
    watch.go_on(0)
    for second in range(1, 5):
        robot.step(second)
    said = [text for _, text in watch.said() if not text.endswith(f"at {text.split()[-1]}")]
    assert said == ["begun", "relayed message 2", "relayed message 3", "relayed message 4"]
