"""Runs a student's program through a scenario, in simulated time and in one interpreter with the grader's own runner.

The program's threads take turns. When all of them wait, it is the turn of the thread in which grader/runner follows
the scenario. So nothing depends on timing, and every run gives the same recording, in the grader's own form.
"""

from __future__ import annotations

import gc
import io
import os
import re
import signal
import sys
import time
import traceback
import types
from collections.abc import Callable, Collection, Iterator
from contextlib import contextmanager, redirect_stderr, redirect_stdout
from dataclasses import dataclass

from grader.exercise.exercise import Exercise
from grader.recording.recording import Recording
from grader.runner.program import Task
from grader.runner.run import ScenarioRun
from grader.scenario.command_line import arguments
from grader.scenario.scenario import Scenario
from groundwork.process_exit import ProcessExit
from rcl_python import logs
from spinbook.browser.in_page import program_imports, threads
from spinbook.browser.in_page.hub import PageHub, RunFinished, Turns
from spinbook.browser.in_page.process import become_main, exit_status, run_main
from spinbook.browser.in_page.program_link import ProgramLink, join


@dataclass(frozen=True)
class ProgramText:
    """A student's program: the file's name and its text."""

    file: str
    source: str


class PageProgram:
    """The program as the grader's runner sees it: see grader/runner/program.py."""

    pid = 0

    def __init__(self, turns: Turns, log: io.StringIO) -> None:
        self._turns, self._log = turns, log
        self.code = 0

    def pids(self) -> Collection[int]:
        """Return its process ids: none, because it runs in this process."""
        return ()

    def output(self) -> str:
        """Return what it has printed."""
        return self._log.getvalue()

    def poll(self) -> ProcessExit | None:
        """Return how it ended; None if it still runs."""
        return ProcessExit(self.code) if self._turns.has_ended else None

    def wait(self, timeout_s: float) -> ProcessExit | None:
        """Return the same as `poll`: the program does not run while the grader's thread does."""
        return self.poll()

    def interrupt(self) -> None:
        """Make it receive SIGINT when it continues."""
        self._turns.signal = "SIGINT"

    def cpu_seconds(self) -> float:
        """Return the CPU time of everything here (s)."""
        return time.process_time()

    def at_limit(self) -> bool:
        """Return whether it has hit a limit: there are none."""
        return False

    def kill(self) -> ProcessExit:
        """End the program, and return how it ended."""
        if not self._turns.has_ended:
            self._turns.is_over = True
            self._turns.let_program_go_on()
        return ProcessExit(self.code)


def run(exercise: Exercise, scenario: Scenario, program: ProgramText) -> Recording:
    """Run the program. The recording shows every fault of the program; faults of the grader are raised."""
    gc.collect()  # otherwise, nodes of the previous program might be collected during this run, and leave its graph
    turns, log = Turns(), io.StringIO()
    hub, running = PageHub(turns), PageProgram(turns, log)
    link = join(hub, turns)
    task = Task(exercise, scenario, program.file, program.source)
    outcome: list[Recording | BaseException] = []

    over = threads.raw_lock()
    over.acquire()

    def grade() -> None:
        try:
            outcome.append(ScenarioRun(task, running, hub).run(time.monotonic()))
        except BaseException as fault:
            outcome.append(fault)
            running.kill()
        over.release()

    threads.raw_start(grade)
    with _as_main(program, scenario, log, link):
        link.run(lambda: _main(program, running, log))
    over.acquire()
    program_imports.show_all()
    if isinstance(outcome[0], BaseException):
        raise outcome[0]
    return outcome[0]


def _main(program: ProgramText, running: PageProgram, log: io.StringIO) -> None:
    """Run the program as Python runs a script, up to its exit status."""
    program_imports.begin_program()
    try:
        run_main(program.source, program.file)
    except RunFinished:
        raise
    except SystemExit as error:
        running.code = exit_status(error.code)
    except BaseException as error:
        traceback.print_exception(type(error), error, _without_runner(error.__traceback__), file=log)
        running.code = 130 if isinstance(error, KeyboardInterrupt) else 1
    if running.code:
        gc.collect()  # only the traceback held its nodes: they leave the graph now, as when a process ends


def _without_runner(trace: types.TracebackType | None) -> types.TracebackType | None:
    while trace is not None and re.search(r"in_page[/\\](runner|process)\.py$", trace.tb_frame.f_code.co_filename):
        trace = trace.tb_next
    return trace


def _reset_rclpy() -> None:
    """Reset rclpy's globals to their state after import: a signal ends contexts without rclpy noticing."""
    import rclpy
    import rclpy.utilities

    rclpy.try_shutdown()
    rclpy.utilities.g_default_context = None
    vars(rclpy)["__executor"] = None


@contextmanager
def _as_main(program: ProgramText, scenario: Scenario, log: io.StringIO, link: ProgramLink) -> Iterator[None]:
    """Make the program `__main__`, with the grader's arguments, and keep what it prints; clean up afterwards."""
    before = sys.modules["__main__"], sys.argv, logs.write, dict(os.environ)
    handlers = {number: signal.getsignal(number) for number in (signal.SIGINT, signal.SIGTERM)}
    become_main(program.source, program.file, arguments(scenario))
    logs.write = lambda line: print(line, file=log)
    threads.use_scheduler(link.scheduler)
    try:
        with redirect_stdout(log), redirect_stderr(log), _time_of(link):
            yield
    finally:
        sys.modules["__main__"], sys.argv, logs.write, environment = before
        with redirect_stdout(io.StringIO()), redirect_stderr(io.StringIO()):
            link.scheduler.close()
        os.environ.clear()
        os.environ.update(environment)
        for number, handler in handlers.items():
            signal.signal(number, handler)
        _reset_rclpy()


@contextmanager
def _time_of(link: ProgramLink) -> Iterator[None]:
    """Make the program's threads see the hub's time in Python's clocks; the grader's threads see the real time."""
    ours = {name: getattr(time, name) for name in ("sleep", "time", "time_ns", "monotonic", "monotonic_ns")}
    theirs: dict[str, Callable[..., float | None]] = {
        "sleep": link.sleep,
        "time": lambda: link.system() / 1e9,
        "time_ns": link.system,
        "monotonic": lambda: link.steady() / 1e9,
        "monotonic_ns": link.steady,
    }

    def choose(name: str) -> Callable[..., float | None]:
        def clock(*args: float) -> float | None:
            return (theirs if link.scheduler.schedules(threads.get_ident()) else ours)[name](*args)

        return clock

    for name in ours:
        setattr(time, name, choose(name))
    try:
        yield
    finally:
        for name, original in ours.items():
            setattr(time, name, original)
