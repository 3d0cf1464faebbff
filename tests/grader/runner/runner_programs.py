"""Programs for the runner's tests: what a student may submit, and what no one should."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path
from typing import TypeAlias

from grader.exercise import Exercise
from grader.exercise.exercise import Topic
from grader.recording import Recording
from grader.scenario import Message, Scenario
from grader.scenario.scenario import SECOND, START

FLOAT = "std_msgs/msg/Float64"

#: Answers each number on /in with its double on /out.
EXERCISE = Exercise(
    "doubler", Path(), "", 10.0, "doubler.py", "Doubler", "doubler", "",
    (Topic("/in", FLOAT, "subscribe"), Topic("/out", FLOAT, "publish")), None,
)  # fmt: skip

RunProgram: TypeAlias = Callable[..., Recording]


def numbers(count: int = 5, period: float = 0.1, topic: str = "/in", **options: object) -> Scenario:
    """Return the numbers from 1 on."""
    messages = tuple(
        Message(START + round(i * period * SECOND), topic, FLOAT, {"data": float(i + 1)}) for i in range(count)
    )
    return Scenario("numbers", "numbers", messages, **options)  # type: ignore[arg-type]


#: Doubles each number. `{before}` is before the node is created, `{init}` in its constructor, `{body}` in its callback
#: and `{spin}` replaces rclpy.spin(node).
NODE = """
import os, subprocess, sys, threading, time
import rclpy
from rclpy.executors import ExternalShutdownException, MultiThreadedExecutor
from rclpy.callback_groups import MutuallyExclusiveCallbackGroup, ReentrantCallbackGroup
from rclpy.node import Node
from rclpy.qos import DurabilityPolicy, QoSProfile
from std_msgs.msg import Float64

LATCHED = QoSProfile(depth=10, durability=DurabilityPolicy.TRANSIENT_LOCAL)


class Doubler(Node):
    def __init__(self):
        super().__init__('doubler')
        self.publisher = self.create_publisher(Float64, '/out', 10)
        self.create_subscription(Float64, '/in', self.on_number, 10)
        self.got = []
        {init}

    def on_number(self, message):
        self.got.append(message.data)
        {body}

    def answer(self, number):
        self.publisher.publish(Float64(data=2 * number))


def main():
    {before}
    rclpy.init()
    node = Doubler()
    try:
        {spin}
    except (KeyboardInterrupt, ExternalShutdownException):
        pass
    rclpy.try_shutdown()


main()
"""

ANSWER = "self.answer(message.data)"


def program(body: str = ANSWER, init: str = "pass", before: str = "pass", spin: str = "rclpy.spin(node)") -> str:
    """Return the node, with pieces of it replaced."""
    filled = NODE
    for name, text, indent in (("body", body, 8), ("init", init, 8), ("before", before, 4), ("spin", spin, 8)):
        filled = filled.replace(f"{{{name}}}", text.strip().replace("\n", f"\n{' ' * indent}"))
    return filled


THREADS = "executor = MultiThreadedExecutor(4)\nexecutor.add_node(node)\nexecutor.spin()"

#: Answers by timer: every 30 ms of the computer's time, what it has received until then.
TIMER_THREAD = program(
    body="pass",
    init="def loop():\n    while rclpy.ok():\n        time.sleep(0.03)\n        self.answer(float(len(self.got)))\n"
    "threading.Thread(target=loop, daemon=True).start()",
)

ASYNCIO = program(
    spin="import asyncio\n"
    "async def turn():\n    while rclpy.ok():\n        rclpy.spin_once(node, timeout_sec=0)\n"
    "        await asyncio.sleep(0.005)\n"
    "asyncio.run(turn())"
)

#: Two nodes in one process: the second doubles what the first has doubled.
TWO_NODES = program(
    init="self.inner = self.create_publisher(Float64, '/inner', 10)",
    body="self.inner.publish(Float64(data=message.data))",
    spin="other = Node('other')\n"
    "other.create_subscription(Float64, '/inner', lambda message: node.answer(message.data), 10)\n"
    "executor = MultiThreadedExecutor(2)\nexecutor.add_node(node)\nexecutor.add_node(other)\nexecutor.spin()",
)

#: Makes two processes of the program that follows.
FORK = "import os\nCHILD = os.fork() == 0\n"

#: Two processes: the second answers.
TWO_PROCESSES = FORK + program(
    init="self.inner = self.create_publisher(Float64, '/inner', 10)\n"
    "if CHILD:\n"
    "    self.create_subscription(Float64, '/inner', lambda message: self.answer(message.data), 10)",
    body="if not CHILD:\n    self.inner.publish(Float64(data=message.data))",
)

#: The same node in two processes: each answers.
TWO_COPIES = FORK + program(
    body="self.answer(message.data if CHILD else -message.data)\nself.answer(7.0 if CHILD else 6.0)"
)

#: A child answers as soon as its parent writes into a pipe, whether or not it has received the message itself by then.
TWO_PROCESSES_AND_A_PIPE = (
    "import os\nREAD, WRITE = os.pipe()\n"
    + FORK
    + program(
        init="def loop():\n    while True:\n        self.answer(float(os.read(READ, 1)[0]))\n"
        "if CHILD:\n    threading.Thread(target=loop, daemon=True).start()",
        body="if not CHILD:\n    os.write(WRITE, bytes([int(message.data)]))",
    )
)

#: Each result comes through a pipe that Python looks at again and again without waiting.
POOL_OF_PROCESSES = "import concurrent.futures, multiprocessing\n" + program(
    init="fork = multiprocessing.get_context('fork')\n"
    "self.pool = concurrent.futures.ProcessPoolExecutor(2, mp_context=fork)",
    body="self.answer(sum(self.pool.map(abs, [message.data - 1.0, 1.0])))",
)

#: Starts a program each time the one before has ended: 40 ms later, when the loop looks as well.
ASYNCIO_AND_PROGRAMS = program(
    body="pass",
    spin="import asyncio\n"
    "async def programs():\n    while rclpy.ok():\n"
    "        await (await asyncio.create_subprocess_exec('sleep', '0.04')).wait()\n"
    "        node.answer(float(len(node.got)))\n"
    "async def turn():\n    task = asyncio.ensure_future(programs())\n    while rclpy.ok():\n"
    "        rclpy.spin_once(node, timeout_sec=0)\n        await asyncio.sleep(0.005)\n"
    "asyncio.run(turn())",
)

#: One callback in a group of its own sleeps before it answers, while the other continues.
SLOW_GROUP = program(
    init="group = ReentrantCallbackGroup()\n"
    "self.create_subscription(Float64, '/in', self.slow, 10, callback_group=group)",
    body="pass",
    spin=THREADS,
).replace(
    "    def answer",
    "    def slow(self, message):\n        time.sleep(0.02)\n        self.answer(message.data)\n\n    def answer",
    1,
)

#: The hard programs: each has to give the same recording each time. What they answer to 1, 2, 3, 4, 5.
HARD = {
    "plain": program(),
    "several threads": program(spin=THREADS),
    "a group of its own that sleeps": SLOW_GROUP,
    "a thread of its own": TIMER_THREAD,
    "asyncio": ASYNCIO,
    "a timer of threading": program(body="threading.Timer(0.025, self.answer, [message.data]).start()"),
    "two nodes": TWO_NODES,
    "two processes": TWO_PROCESSES,
    "two copies of it": TWO_COPIES,
    "two processes and a pipe": TWO_PROCESSES_AND_A_PIPE,
    "a pool of processes": POOL_OF_PROCESSES,
    "asyncio and programs": ASYNCIO_AND_PROGRAMS,
    "a subprocess": program(body="subprocess.run(['sleep', '0.005'])\nself.answer(message.data)"),
    "its own loop": program(
        spin="while rclpy.ok():\n    rclpy.spin_once(node, timeout_sec=0.002)\n    time.sleep(0.003)"
    ),
    "a timer by the computer's clock": program(
        init="from rclpy.clock import Clock, ClockType\n"
        "clock = Clock(clock_type=ClockType.STEADY_TIME)\n"
        "self.create_timer(0.04, lambda: self.answer(float(len(self.got))), clock=clock)",
        body="pass",
    ),
    "latched": program(init="self.publisher = self.create_publisher(Float64, '/out', LATCHED)"),
}  # fmt: skip
