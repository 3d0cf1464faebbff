"""Whatever a submission makes the grader keep or compute is bounded, and the next student's grade is as before."""

from __future__ import annotations

import contextlib
import re
import threading
from collections.abc import Iterator

import psutil
import pytest
from few_scenarios import in_scenarios
from submissions import HONEST, ON_THE_GRADER
from test_through_the_grader import FEW, shown

from grader.grading import Grade
from grader.grading.grading import Grading
from grader.submission.reader import of_source

#: What all of the grader's processes may take together (bytes), and one submission of its time (CPU seconds).
MOST_MEMORY, MOST_CPU_S = 1_000_000_000, 60.0


class GraderProcesses:
    """Watches, in a thread, the memory and CPU time of this process and its workers, without the students' own.

    Of this process only what is added counts: other tests have run in it.
    """

    def __init__(self) -> None:
        self.most_memory, self.cpu_s = 0, 0.0
        self._before = psutil.Process().memory_full_info().pss
        self._cpu = {process: seconds(process) for process in grader_processes()}
        self._ended = threading.Event()
        self._thread = threading.Thread(target=self._watch, daemon=True)

    def _watch(self) -> None:
        while not self._ended.wait(0.1):
            memory = -self._before
            for process in grader_processes():
                with contextlib.suppress(psutil.Error):
                    memory += process.memory_full_info().pss
                    before = self._cpu.get(process, 0.0)
                    self._cpu[process] = seconds(process)
                    self.cpu_s += self._cpu[process] - before
            self.most_memory = max(memory, self.most_memory)

    def __enter__(self) -> GraderProcesses:
        self._thread.start()
        return self

    def __exit__(self, *error: object) -> None:
        self._ended.set()
        self._thread.join()


def seconds(process: psutil.Process) -> float:
    times = process.cpu_times()
    return times.user + times.system


def grader_processes() -> Iterator[psutil.Process]:
    """Yield this process and its workers, down to the supervisors, whose children are students' programs.

    What other tests have started, such as a browser, is not of the grader.
    """
    yield psutil.Process()
    waiting = psutil.Process().children()
    while waiting:
        process = waiting.pop()
        with contextlib.suppress(psutil.Error):
            command = " ".join(process.cmdline())
            if "grader." in command:
                yield process
                waiting += [] if process.name() == "fork server" else process.children()


def grade_of(grading: Grading, name: str, source: str) -> Grade:
    return grading.grade(of_source(f"{name}.py", source.encode(), grading.runner.exercise))


#: They reach a limit of computing time, which takes longer.
SLOW = {
    "recipients_that_change",
    *("never_confirmed", "wakes_each_nanosecond", "names_like_the_topic", "words_without_end"),
    *("sleeps_behind_the_clocks_back", "computes_just_as_long_as_it_may"),
}


@pytest.mark.parametrize(
    "name", [pytest.param(name, marks=[pytest.mark.soak] * (name in SLOW)) for name in ON_THE_GRADER]
)
def test_an_attack_on_the_grader_is_over_within_its_limits(grading: Grading, name: str) -> None:
    program = ON_THE_GRADER[name]
    with GraderProcesses() as processes:
        grade = grade_of(grading, name, program.source)
    assert grade.outcome in program.outcome, (grade.outcome, grade.message)
    assert (grade.score == 0) if program.score == "zero" else not grade.full_marks
    assert all(re.search(words, shown(grade)) for words in program.words), shown(grade)
    assert processes.most_memory < MOST_MEMORY
    assert processes.cpu_s < MOST_CPU_S


def test_the_next_student_gets_the_same_grade_as_before(grading: Grading) -> None:
    assert grade_of(in_scenarios(grading, *FEW), "honest", HONEST.read_text()).full_marks
