"""Programs that attack the connection to the hub: nothing hangs, nothing is believed, and the message is true."""

from __future__ import annotations

import textwrap

import pytest
from runner_programs import ANSWER, RunProgram, numbers, program

from rmw_lockstep.hub import HubLimits
from rmw_lockstep.hub.frames import VERSION

#: The process's own connection, and how to make another one.
TOOLS = """
import array, os, socket, struct, threading, time
frame = lambda kind, payload=b'': struct.pack('<IB', len(payload) + 1, kind[0]) + payload
text = lambda value: struct.pack('<I', len(value)) + value
hello = frame(b'H', struct.pack('<IIIB', VERSION, os.getpid(), 1, 1))
idle = lambda handled: frame(b'I', struct.pack('<QqqIIIBQH', handled, 0, -1, 1, 0, 0, 0, 0, 0))
def own():
    for number in range(3, 100):
        try:
            if os.readlink(f'/proc/self/fd/{number}').startswith('socket:'):
                return socket.socket(fileno=number)
        except OSError:
            pass
def another():
    asking, sent = socket.socketpair()
    with socket.socket(fileno=os.dup(1000)) as hub, sent:
        socket.send_fds(hub, [b'+'], [sent.fileno()])
    return socket.socket(fileno=socket.recv_fds(asking, 1, 1)[1][0])
""".replace("VERSION", str(VERSION))


def attack(code: str) -> str:
    """Return a node that does this when the third message arrives, and answers all."""
    indented = textwrap.indent(code.strip(), " " * 4).strip()
    return TOOLS + program(body=f"{ANSWER}\nif message.data == 3.0:\n    {indented}")


@pytest.mark.parametrize(
    ("code", "outcome", "text"),
    [
        ("own().sendall(b'\\xff' * 100)", "over-limit", "disturbed the connection"),
        ("own().sendall(frame(b'T', b'\\0' * 9))", "over-limit", "disturbed the connection"),
        ("own().sendall(frame(b'N', struct.pack('<Q', 1 << 32 | 99) + text(b'a\\0b') + text(b'/')))",
         "over-limit", "not valid as a node's name"),
        ("own().sendall(frame(b'N', struct.pack('<Q', 7) + text(b'runner') + text(b'/')))",
         "over-limit", "not the process's own"),
        ("own().sendall(struct.pack('<IB', 2_000_000_000, 68))", "over-limit", "message of 2,000,000,000 bytes"),
        ("for i in range(100_000): self.answer(1.0)", "over-limit", "more than 1,500 messages or requests"),
        ("for i in range(10_000):\n    self.answer(1.0)\n    time.sleep(1e-6)",
         "over-limit", "more than 5,000 messages"),
        ("connection = own()\nwhile True: connection.sendall(idle(0))", "over-limit", "more than 20,000 times"),
        ("for i in range(10_000): self.create_publisher(Float64, f'/topic_{i}', 10)",
         "over-limit", "more than 400 publishers"),
        ("kept = [another() for i in range(20)]", "over-limit", "more than 16 processes"),
        ("kept = another(); kept.sendall(b'GET / HTTP/1.1')", "over-limit", "disturbed the connection"),
        ("another().sendall(hello + hello)", "over-limit", "disturbed the connection"),
    ],
)  # fmt: skip
def test_an_attack_ends_the_run_with_a_true_message(
    run_program: RunProgram, code: str, outcome: str, text: str
) -> None:
    recording = run_program(attack(code), limits=HubLimits(frames=20_000, endpoints=400, connections=16))
    assert (recording.ending.outcome, text in recording.ending.message) == (outcome, True), recording.ending
    assert [received.fields["data"] for received in recording.received][:2] == [2, 4]


@pytest.mark.parametrize(
    "code",
    [
        "os.closerange(3, 256)",
        "own().shutdown(socket.SHUT_RDWR)",
        "os.kill(os.getpid(), 19)",
        "global kept; kept = another()",
        "global kept; kept = another(); kept.sendall(hello)",
    ],
    ids=["closes everything", "shuts the connection down", "stops itself", "says nothing", "never reads"],
)
def test_a_program_that_goes_silent_is_waited_for_three_seconds(run_program: RunProgram, code: str) -> None:
    recording = run_program(attack(code))
    assert recording.ending.outcome in ("timed-out", "crashed"), recording.ending
    assert recording.ending.message


def test_a_lie_about_being_idle_harms_only_the_liar(run_program: RunProgram) -> None:
    lie = "for handled in range(200):\n    connection.sendall(idle(handled))\n    self.answer(9.0)\n"
    recording = run_program(attack(f"connection = own()\n{lie}connection.detach()"))
    assert [received.fields["data"] for received in recording.received][:3] == [2, 4, 6]
    assert recording.ending.outcome in ("completed", "over-limit")


def test_a_connection_that_is_handed_on_to_a_child_is_one_process(run_program: RunProgram) -> None:
    child = "if os.fork() == 0:\n    connection.sendall(idle(3) * 50)\n    os._exit(0)\n"
    recording = run_program(attack(f"connection = own()\n{child}connection.detach()"))
    assert recording.ending.outcome in ("completed", "over-limit", "timed-out")
    assert [received.fields["data"] for received in recording.received][:2] == [2, 4]


@pytest.mark.parametrize(
    ("source", "outcome", "text"),
    [
        (program(body="while message.data == 2.0: time.monotonic()"), "timed-out", "never responds"),
        (program(body="time.sleep(3600)"), "timed-out", "never responds"),
        (program(body="threading.Event().wait()"), "timed-out", "never responds"),
        (program(before="time.sleep(11)"), "timed-out", "waits and creates no node"),
        (program(before="threading.Event().wait()"), "did-not-start", "waits and creates no node"),
        (program(before="sys.exit('no')"), "did-not-start", "gave up with exit code 1"),
    ],
    ids=["reads the clock", "sleeps", "waits", "sleeps before", "waits before", "gives up"],
)
def test_a_program_that_does_not_go_on_is_told_why(
    run_program: RunProgram, source: str, outcome: str, text: str
) -> None:
    ending = run_program(source).ending
    assert (ending.outcome, text in ending.message) == (outcome, True), ending


def test_a_program_that_sleeps_two_seconds_before_it_makes_a_node_is_not_too_late(run_program: RunProgram) -> None:
    recording = run_program(program(before="time.sleep(2)"))
    assert len(recording.received) == 5


def test_what_reading_all_that_it_sends_may_cost_is_bounded(run_program: RunProgram) -> None:
    ending = run_program(program(), limits=HubLimits(cpu_s=0.0)).ending
    assert (ending.outcome, "kept the grader busy" in ending.message) == ("over-limit", True), ending


def test_how_much_it_publishes_is_bounded_in_bytes_before_it_takes_any_memory(run_program: RunProgram) -> None:
    recording = run_program(program(body=f"for i in range(100): {ANSWER}"), numbers(20), HubLimits(data_bytes=10_000))
    assert recording.ending.outcome == "over-limit"
    assert "more than 10,000 bytes" in recording.ending.message
    assert recording.received, "what came before is kept"
