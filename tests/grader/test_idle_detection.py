"""Threads show whether a program is idle: those that it has now, and whatever they have done."""

from __future__ import annotations

import subprocess
import sys
from collections.abc import Iterator

import pytest
from small_class import wait_until

from grader.runner.fastdds.idle import Threads

PROGRAM = """
import sys, threading
ends = []
for order in sys.stdin:
    if order == "begin\\n":
        ends.append(threading.Event())
        threading.Thread(target=ends[-1].wait).start()
    elif order == "replace\\n":
        ends[-1].set()
        [thread.join() for thread in threading.enumerate() if thread is not threading.main_thread()]
        threading.Thread(target=threading.Event().wait, daemon=True).start()
    print("done", flush=True)
    while order == "compute\\n":
        pass
"""


class Program:
    """A program that does what it is told, and is idle otherwise."""

    def __init__(self) -> None:
        self.process = subprocess.Popen(
            [sys.executable, "-c", PROGRAM], stdin=subprocess.PIPE, stdout=subprocess.PIPE, text=True
        )

    def pids(self) -> tuple[int, ...]:
        return (self.process.pid,)

    def do(self, order: str) -> None:
        assert self.process.stdin is not None
        assert self.process.stdout is not None
        self.process.stdin.write(f"{order}\n")
        self.process.stdin.flush()
        assert self.process.stdout.readline() == "done\n"


@pytest.fixture
def program() -> Iterator[Program]:
    program = Program()
    program.do("nothing")
    yield program
    program.process.kill()
    program.process.communicate()


def test_a_program_at_rest_does_not_count_as_busy_until_it_does_something(program: Program) -> None:
    threads = Threads(program.pids)
    assert threads.wait_until_idle(0.0, 60.0)
    assert not threads.has_run()
    program.do("nothing")
    assert threads.has_run()
    threads.close()


def test_a_program_is_at_work_while_it_computes_and_not_while_it_waits(program: Program) -> None:
    threads = Threads(program.pids)
    assert threads.wait_until_idle(0.0, 60.0)
    assert not threads.at_work()
    program.do("compute")
    wait_until(threads.at_work, 60.0)
    threads.close()


def test_a_thread_that_begins_and_one_that_takes_the_place_of_another_are_found(program: Program) -> None:
    threads = Threads(program.pids)
    assert threads.wait_until_idle(0.0, 60.0)
    alone = threads.activity()
    program.do("begin")
    assert threads.wait_until_idle(0.0, 60.0)
    with_first = threads.activity()
    program.do("replace")
    assert threads.wait_until_idle(0.0, 60.0)
    with_second = threads.activity()
    assert alone is not None
    assert with_first is not None
    assert with_second is not None
    assert (len(alone), len(with_first), len(with_second)) == (1, 2, 2)
    assert alone.keys() < with_first.keys()
    assert alone.keys() < with_second.keys() != with_first.keys()
    threads.close()


def test_of_a_program_that_has_ended_nothing_is_left(program: Program) -> None:
    threads = Threads(program.pids)
    assert threads.wait_until_idle(0.0, 60.0)
    program.process.kill()
    program.process.wait()
    assert threads.activity() == {}
    threads.close()
