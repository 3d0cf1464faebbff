"""A program that is never finished with one moment, because it keeps itself busy, is ended there and told why."""

from __future__ import annotations

import pytest
from runner_programs import ANSWER, FORK, THREADS, RunProgram, numbers, program

#: THREADS in place of rclpy.spin(node) in a program that is there already.
SPIN = THREADS.replace("\n", "\n" + " " * 8)

ECHO = "self.create_subscription(Float64, '/out', lambda message: self.answer(message.data), 10)"

#: Two nodes of one process: each answers on the topic that the other one listens to.
PING_PONG = program(
    init="self.there = self.create_publisher(Float64, '/there', 10)\n"
    "self.create_subscription(Float64, '/back', lambda message: self.there.publish(message), 10)",
    body="self.there.publish(message)",
    spin="other = Node('other')\n"
    "back = other.create_publisher(Float64, '/back', 10)\n"
    "other.create_subscription(Float64, '/there', lambda message: back.publish(message), 10)\n"
    "executor = MultiThreadedExecutor(2)\nexecutor.add_node(node)\nexecutor.add_node(other)\nexecutor.spin()",
)

#: The same in two processes.
PING_PONG_OF_PROCESSES = FORK + program(
    init="self.mine = self.create_publisher(Float64, '/there' if CHILD else '/back', 10)\n"
    "self.create_subscription(Float64, '/back' if CHILD else '/there', lambda message: self.mine.publish(message), 10)",
    body="self.mine.publish(message)",
)

#: A client of the node's own service that calls again as soon as it has the answer.
CALLS_ITSELF = "from std_srvs.srv import Trigger\n" + program(
    init="self.create_service(Trigger, '/again', lambda request, response: response)\n"
    "self.client = self.create_client(Trigger, '/again')\n"
    "self.call = lambda done=None: self.client.call_async(Trigger.Request()).add_done_callback(self.call)",
    body="self.call()",
)

#: Each stamped message takes a reading of the clock: without messages, time would go on after many of these.
STAMPS = program(
    init="self.nobody = self.create_publisher(Float64, '/nobody', 10)",
    body="while True:\n    for i in range(100): time.time()\n    self.nobody.publish(message)",
)

OWN = "Your node sent more than 1,500 messages at one moment, on {0}, to which it also subscribes."
ENDLESS = "Your node sent more than 1,500 messages or requests at one moment, on {0}. Is there a loop that never waits"

BUSY = {
    "answers its own messages": (program(init=ECHO), OWN.format("/out")),
    "publishes on the topic it listens to": (
        program(init="self.publisher = self.create_publisher(Float64, '/in', 10)"),
        OWN.format("/in"),
    ),
    "answers its own messages in several threads": (program(init=ECHO, spin=THREADS), OWN.format("/out")),
    "two nodes": (PING_PONG, OWN.format("/back and /there")),
    "two processes": (PING_PONG_OF_PROCESSES, OWN.format("/back and /there")),
    "calls itself": (CALLS_ITSELF, ENDLESS.format("/again")),
    "calls itself from several threads": (
        CALLS_ITSELF.replace("rclpy.spin(node)", SPIN),
        ENDLESS.format("/again"),
    ),
    "publishes without end": (program(body="while True: self.answer(1.0)"), ENDLESS.format("/out")),
    "publishes without end what nobody gets": (STAMPS, ENDLESS.format("/nobody")),
}
#: Each half of it is tested every time.
DEAR = {"calls itself from several threads": pytest.mark.soak}


@pytest.mark.parametrize(
    "name",
    [pytest.param(name, marks=[pytest.mark.soak] * (name == "calls itself from several threads")) for name in BUSY],
)
def test_a_program_that_keeps_itself_busy_is_ended_at_that_moment(run_program: RunProgram, name: str) -> None:
    source, message = BUSY[name]
    recordings = [run_program(source), run_program(source)]
    ending = recordings[0].ending
    assert (ending.outcome, ending.message[: len(message)]) == ("over-limit", message), ending
    assert len(recordings[0].sent) == 1, "it is ended at the first message"
    assert recordings[1].ending == ending


#: Has always something to do, and sends nothing: the time of an executor that is never done goes on all the same.
STEADY = "from rclpy.clock import Clock, ClockType\nclock = Clock(clock_type=ClockType.STEADY_TIME)\n"
GUARD = "self.guard = self.create_guard_condition(lambda: self.guard.trigger())\nself.guard.trigger()"
TASK = "def turn():\n    executor.create_task(turn)\n{0}\nexecutor.add_node(node)\nturn()\nexecutor.spin()"
ONE = "from rclpy.executors import SingleThreadedExecutor\nexecutor = SingleThreadedExecutor()"
NEVER_DONE = {
    "a timer without a period": program(init="self.create_timer(0.0, lambda: None)"),
    "a steady timer without a period": program(init=f"{STEADY}self.create_timer(0.0, lambda: None, clock=clock)"),
    "a guard condition": program(init=GUARD),
    "a task": program(spin=TASK.format(ONE)),
}
NEVER_DONE |= {
    f"{name} and several threads": source.replace("rclpy.spin(node)", SPIN).replace(
        "executor = SingleThreadedExecutor()", "executor = MultiThreadedExecutor(4)"
    )
    for name, source in NEVER_DONE.items()
}


@pytest.mark.parametrize("name", NEVER_DONE)
def test_a_program_that_is_never_done_but_sends_nothing_answers_on_time(run_program: RunProgram, name: str) -> None:
    recording = run_program(NEVER_DONE[name])
    assert recording.ending.outcome == "completed", recording.ending
    assert [received.fields["data"] for received in recording.received] == [2, 4, 6, 8, 10]
    assert [received.at for received in recording.received] == [sent.at for sent in recording.sent]


@pytest.mark.parametrize(
    "body",
    ["for i in range(1_400): self.inner.publish(message)", "for i in range(3_000): self.get_logger().debug('no end')"],
    ids=["messages", "log"],
)
def test_many_messages_at_each_of_many_moments_are_not_too_much(run_program: RunProgram, body: str) -> None:
    source = program(
        init="self.inner = self.create_publisher(Float64, '/inner', 10)\n"
        "self.create_subscription(Float64, '/inner', lambda message: None, 10)\n"
        "rclpy.logging.set_logger_level('doubler', rclpy.logging.LoggingSeverity.DEBUG)",
        body=f"{body}\n{ANSWER}",
    )
    recording = run_program(source, numbers(3))
    assert recording.ending.outcome == "completed", recording.ending
    assert len(recording.received) == 3


def test_a_timer_of_1_khz_is_not_one_moment_though_its_time_is_granted_in_one_piece(run_program: RunProgram) -> None:
    source = program(
        init="self.inner = self.create_publisher(Float64, '/inner', 10)\n"
        "self.create_subscription(Float64, '/inner', lambda message: None, 10)\n"
        "from rclpy.clock import Clock, ClockType\n"
        "clock, self.count = Clock(clock_type=ClockType.STEADY_TIME), 0\n"
        "def tick():\n    self.count += 1\n    self.inner.publish(Float64())\n"
        "self.create_timer(0.001, tick, clock=clock)",
        body="self.answer(float(self.count))",
    )
    recording = run_program(source, numbers(2, 2.0))
    assert recording.ending.outcome == "completed", recording.ending
    assert recording.received[-1].fields["data"] > 2 * 2_000, "the computer's clock goes faster than simulated time"


def test_what_a_program_published_before_it_kept_itself_busy_is_recorded(run_program: RunProgram) -> None:
    source = program(
        init="self.back = self.create_publisher(Float64, '/in', 10)",
        body=f"if len(self.got) < 4: {ANSWER}\nif len(self.got) >= 3: self.back.publish(message)",
    )
    recording = run_program(source)
    assert recording.ending.outcome == "over-limit"
    assert [received.fields["data"] for received in recording.received] == [2, 4, 6]
