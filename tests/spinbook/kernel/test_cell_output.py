"""How long a cell shows a process: counted from its first line, or from when it joined ROS."""

from __future__ import annotations

import os
import socket
import sys
import time
from dataclasses import dataclass
from pathlib import Path

import pytest

from ros_in_python.ros2.domain import participants, participates
from spinbook.kernel.cell_output import Countdown, DisplayLimit, OutputPrinter
from spinbook.kernel.process import KeptProcess


@dataclass
class Machine:
    """A clock that a test sets, and whether the process has joined ROS."""

    now: float = 0.0
    joined: bool = False

    def countdown(self, seconds: float) -> Countdown:
        return Countdown(DisplayLimit(seconds), lambda: self.joined, lambda: self.now)


def test_the_seconds_count_from_the_first_line_however_late_it_comes() -> None:
    machine = Machine()
    countdown = machine.countdown(3.0)
    for now, printed, over in ((9.0, False, False), (10.0, True, False), (12.9, True, False), (13.0, True, True)):
        machine.now = now
        assert countdown.is_over(printed) is over


def test_a_character_that_arrives_in_two_pieces_is_one_character(capsys: pytest.CaptureFixture[str]) -> None:
    shown = OutputPrinter()
    for byte in "Größe: 3 µm\n".encode():
        shown.add(bytes([byte]))
    assert (capsys.readouterr().out, shown.seen) == ("Größe: 3 µm\n", "Größe: 3 µm\n")


def test_a_silent_node_is_shown_from_when_it_joined_for_at_least_as_long_as_it_took_to_start() -> None:
    for joined_at, end in ((1.0, 4.0), (8.0, 16.0)):
        machine = Machine()
        countdown = machine.countdown(3.0)
        assert not countdown.is_over(False)
        machine.now, machine.joined = joined_at, True
        assert not countdown.is_over(False)
        machine.now = end - 0.1
        assert not countdown.is_over(False)
        machine.now = end
        assert countdown.is_over(False)
        assert countdown.silent_s == end - joined_at


def test_a_program_that_neither_prints_nor_joins_does_not_hold_the_cell_for_ever() -> None:
    machine = Machine()
    countdown = machine.countdown(3.0)
    assert not countdown.is_over(False)
    machine.now = 60.0
    assert countdown.is_over(False)


#: Binds the second discovery port of a domain, as a participant does, and prints so.
BINDS = """
import socket, sys, time
bound = socket.socket(socket.AF_INET, socket.SOCK_DGRAM)
bound.bind(("127.0.0.1", int(sys.argv[1])))
print("bound", flush=True)
time.sleep(60)
"""


def started(tmp_path: Path, *argv: str) -> KeptProcess:
    """Start a process that has printed its first line."""
    process = KeptProcess([sys.executable, "-u", "-c", *argv], os.environ, tmp_path)
    while process.status.running and not process.read_all()[0]:
        time.sleep(0.01)
    return process


def test_only_a_process_itself_and_what_it_starts_join_a_domain_for_it(ros_domain: int, tmp_path: Path) -> None:
    first_port = 7400 + 250 * ros_domain + 10
    with socket.socket(socket.AF_INET, socket.SOCK_DGRAM) as somebody_else:
        somebody_else.bind(("127.0.0.1", first_port))
        starts_it = f"import subprocess, sys; subprocess.run([sys.executable, '-c', {BINDS!r}, *sys.argv[1:]])"
        idle = started(tmp_path, "import time; print('up', flush=True); time.sleep(60)")
        joined = started(tmp_path, starts_it, str(first_port + 2))
        try:
            assert participants(ros_domain) == 2
            assert not participates(ros_domain, idle.descendants())
            assert participates(ros_domain, joined.descendants())
            assert participates(ros_domain, [os.getpid()])
        finally:
            idle.close()
            joined.close()
    assert not participates(ros_domain, [os.getpid()])
