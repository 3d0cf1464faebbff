"""Programs that sleep, use threads, processes, asyncio or their own loops: recorded correctly, the same each time."""

from __future__ import annotations

import signal
import time
from dataclasses import replace
from pathlib import Path

import pytest
from runner_programs import ANSWER, FORK, HARD, THREADS, RunProgram, numbers, program

from grader.recording import Recording
from grader.recording.recording import to_json
from grader.sandbox import ForkServer, Limits, ProgramSpec, choose
from grader.scenario.scenario import SECOND, START
from rmw_lockstep.hub import Hub

MS = 1_000_000


def seen(recording: Recording) -> str:
    """Return everything that counts in a recording."""
    return to_json({"": replace(recording, log="", seconds=0.0, lockstep_seconds=0.0)})


def answers(recording: Recording) -> list[float]:
    return [received.fields["data"] for received in recording.received]


def delays(recording: Recording) -> list[float]:
    """Return how long after its message each answer arrived, in ms of simulated time."""
    return [(received.at_ns - recording.sent[received.after - 1].at_ns) / MS for received in recording.received]


ANSWER_SOMETHING_ELSE = (
    *("a thread of its own", "a timer by the computer's clock", "two copies of it", "asyncio and programs"),
)


@pytest.mark.parametrize("name", HARD)
def test_a_hard_program_is_recorded_the_same_each_time(run_program: RunProgram, name: str) -> None:
    first, second = run_program(HARD[name]), run_program(HARD[name])
    assert first.ending.outcome == "completed", first.ending.message + first.log
    assert first.uses_sim_time
    assert seen(first) == seen(second)
    if name not in ANSWER_SOMETHING_ELSE:
        assert answers(first) == [2, 4, 6, 8, 10]


def test_a_sleep_takes_the_computers_time_which_goes_faster_than_simulated_time(run_program: RunProgram) -> None:
    recording = run_program(program(body=f"time.sleep(0.02)\n{ANSWER}"))
    assert delays(recording) == [16.0] * 5, "0.02 s at 80 % of real time"
    scenario = numbers(computer_time="simulated")
    assert delays(run_program(program(body=f"time.sleep(0.02)\n{ANSWER}"), scenario)) == [20.0] * 5


def test_an_answer_that_comes_after_the_next_messages_is_recorded_with_the_message_it_came_after(
    run_program: RunProgram,
) -> None:
    recording = run_program(program(body="threading.Timer(0.15, self.answer, [message.data]).start()"))
    assert [received.at_ns - START for received in recording.received] == [(i * 100 + 120) * MS for i in range(5)]
    assert [received.after for received in recording.received] == [2, 3, 4, 5, 5]


def test_who_measures_with_the_computers_clock_measures_another_time_the_same_each_time(
    run_program: RunProgram,
) -> None:
    body = "now = time.time()\nself.answer(now - getattr(self, 'before', now))\nself.before = now"
    measured = answers(run_program(program(body=body)))
    assert measured[1:] == pytest.approx([0.25] * 4, abs=1e-6), "twice 0.1 s, times 1.25"
    assert measured == answers(run_program(program(body=body)))


THREE_ANSWERS = "for i in (3, 1, 2):\n    self.answer(message.data * i)"


def test_several_answers_from_the_main_thread_keep_their_order(run_program: RunProgram) -> None:
    recording = run_program(program(body=THREE_ANSWERS))
    assert answers(recording)[:6] == [6, 2, 4, 12, 4, 8]
    assert not any(received.unordered for received in recording.received)


def test_several_answers_from_a_pool_of_threads_have_no_order_whichever_thread_had_them(
    run_program: RunProgram,
) -> None:
    # A single thread has all the work here, as one of several may have by chance.
    spin = "executor = MultiThreadedExecutor(2)\nexecutor._executor._max_workers = 1\n"
    recording = run_program(program(body=THREE_ANSWERS, spin=f"{spin}executor.add_node(node)\nexecutor.spin()"))
    assert sorted(answers(recording)[:3]) == [2, 4, 6]
    assert answers(recording) == answers(
        run_program(program(body=THREE_ANSWERS.replace("3, 1, 2", "1, 2, 3"), spin=THREADS))
    )
    assert all(received.unordered for received in recording.received)


def test_two_processes_with_one_nodes_name_have_no_order_whichever_is_faster(run_program: RunProgram) -> None:
    body = "if {}:\n    sum(range(3_000_000))\nself.answer(message.data if CHILD else -message.data)"
    slow_child, slow_parent = (
        run_program(FORK + program(body=body.format(slower))) for slower in ("CHILD", "not CHILD")
    )
    assert sorted(answers(slow_child)[:2]) == [-2, 2]
    assert answers(slow_child) == answers(slow_parent)
    assert all(received.unordered for received in slow_child.received)


def test_what_was_published_before_simulated_time_began_has_no_time(run_program: RunProgram) -> None:
    recording = run_program(program(init="self.answer(21.0)"))
    assert (recording.received[0].at_ns, recording.received[0].after, answers(recording)[0]) == (0, 0, 42.0)


@pytest.mark.parametrize("last", ["os._exit(0)", "os.kill(os.getpid(), 9)", "raise RuntimeError('enough')"])
def test_what_was_published_before_a_crash_is_kept(run_program: RunProgram, last: str) -> None:
    recording = run_program(program(body=f"{ANSWER}\nif message.data == 3.0:\n    {last}"))
    assert recording.ending.outcome == "crashed"
    assert "message 3" in recording.ending.message
    assert answers(recording) == [2, 4, 6]
    assert {end_point.topic for end_point in recording.end_points} >= {"/in", "/out"}


#: It subscribes at the second tick of a timer; the first is when simulated time begins.
LATE = program(
    init="self.destroy_subscription(next(s for s in self.subscriptions if s.topic_name == '/in'))\n"
    "self.ticks = 0\nself.timer = self.create_timer(0.25, self.begin)",
).replace(
    "    def answer",
    "    def begin(self):\n        self.ticks += 1\n        if self.ticks == 2:\n"
    "            self.create_subscription(Float64, '/in', self.on_number, QOS)\n\n    def answer",
    1,
)


def test_a_subscription_that_is_made_late_hears_from_then_on(run_program: RunProgram) -> None:
    recording = run_program(LATE.replace("QOS", "10"))
    assert [sent.heard for sent in recording.sent] == [False, False, False, True, True]
    assert answers(recording) == [8, 10]


def test_a_late_subscription_of_latched_messages_gets_what_came_before(run_program: RunProgram) -> None:
    assert answers(run_program(LATE.replace("QOS", "LATCHED"))) == [2, 4, 6, 8, 10]


def test_simulated_time_is_what_ros_shows(run_program: RunProgram) -> None:
    recording = run_program(program(body="self.answer(self.get_clock().now().nanoseconds / 1e9)"))
    assert answers(recording) == [2 * sent.at_ns / SECOND for sent in recording.sent]


def test_on_ctrl_c_it_has_two_seconds(run_program: RunProgram) -> None:
    scenario = numbers(interrupt=True)
    good = run_program(program(), scenario).ending
    assert (good.interrupted, good.ended_in_time, good.traceback) == (True, True, "")
    slow = program().replace("    rclpy.try_shutdown()", "    time.sleep(0.2)\n    rclpy.try_shutdown()")
    assert run_program(slow, scenario).ending.ended_in_time
    deaf = program(before="import signal\nsignal.signal(signal.SIGINT, signal.SIG_IGN)").replace(
        "rclpy.init()", "rclpy.init(signal_handler_options=rclpy.signals.SignalHandlerOptions.NO)"
    ).replace("import rclpy\n", "import rclpy, rclpy.signals\n")  # fmt: skip
    assert not run_program(deaf, scenario).ending.ended_in_time


def test_a_program_has_been_sent_ctrl_c_when_the_call_returns(fork_server: ForkServer) -> None:
    block = "import signal\nsignal.pthread_sigmask(signal.SIG_BLOCK, [signal.SIGINT])\nprint('blocked', flush=True)\n"
    with Hub() as hub:
        program = ProgramSpec("node.py", {"node.py": f"{block}signal.pause()".encode()}, hub=hub.add_program())
        with fork_server.start(program, choose(None), Limits()) as student:
            deadline = time.monotonic() + 60
            while "blocked" not in student.output():
                assert time.monotonic() < deadline
                hub.pause()
            student.interrupt()
            status = Path(f"/proc/{student.pid}/status").read_text()
    pending = next(line.split()[1] for line in status.splitlines() if line.startswith("ShdPnd:"))
    assert int(pending, 16) & 1 << (signal.SIGINT - 1)
