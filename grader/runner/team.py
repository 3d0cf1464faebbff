"""Several programs in one run: those of a submission, and the author's own companions."""

from __future__ import annotations

from collections.abc import Callable, Collection, Mapping, Sequence

from grader.exercise.exercise import ExerciseError
from grader.recording.events import ProgramExit
from grader.runner.program import RunningProgram, Task
from grader.runner.tracebacks import last_error
from groundwork.process_exit import ProcessExit
from rmw_lockstep.hub import Hub

#: Starts a program, which has to connect to the hub through this inherited socket.
Start = Callable[[int], RunningProgram]


class Team:
    """All programs of a run, as one program. It ends when one of the student's programs ends by itself."""

    def __init__(self, hub: Hub, task: Task, programs: Mapping[str, Start], companions: Sequence[Start]) -> None:
        """Start the companions, and those programs that run from the beginning."""
        self._task, scenario = task, task.scenario
        self._hub, self._programs = hub, programs
        self._sockets = {name: hub.add_program() for name in programs}
        self._listeners = {name: number for number, name in enumerate(programs)}
        self._running: dict[str, RunningProgram] = {}
        self._stopped: list[RunningProgram] = []
        self._interrupted = False
        self.ended = ""
        """The program that ended by itself."""
        self.exits: list[ProgramExit] = []
        later = {one.id for one in scenario.programs if one.starts > 0}
        self._companions = [start(hub.add_program()) for start in companions]
        for name in programs:
            if name not in later:
                self.start(name)
        self._see()

    def start(self, name: str) -> None:
        """Start a program of the submission, unless it runs."""
        if name not in self._running:
            self._running[name] = self._programs[name](self._sockets[name])
            self._see()

    def stop(self, name: str, now: int) -> None:
        """Kill a program of the submission, at the simulated time `now`, and wait until the hub has noticed."""
        student = self._running.pop(name, None)
        if student is None:
            return
        self._see()
        exit_ = student.kill()
        self._stopped.append(student)
        self.exits.append(ProgramExit(now, name, exit_.code, exit_.signal, "grader"))
        while any(link.listener == self._listeners[name] for link in self._hub.links):
            self._hub.pause()

    def _see(self) -> None:
        """Make the hub wait for each program's processes."""
        self._hub.mains = {one.pid for one in (*self._running.values(), *self._companions)}

    def _see_companions(self) -> None:
        """Raise `ExerciseError` if one of the author's programs has ended."""
        for companion, program in zip(self._task.scenario.companions, self._companions, strict=False):
            if exit_ := program.poll():
                file = self._task.exercise.folder / companion.file
                last = last_error(program.output(), {companion.file: companion.text})
                why = last.error if last else exit_.limit or f"exit code {exit_.code}"
                problem = f"it ended in the scenario {self._task.scenario.name}: {why}"
                fix = "A companion must go on to the end, whatever the student's program sends it."
                raise ExerciseError(file, problem, fix, last.line if last else None)

    def is_companions(self, process: int) -> bool:
        """Return whether a process, by its number on the hub, is one of the author's own."""
        first = len(self._programs)
        return any(link.number == process and link.listener >= first for link in self._hub.links)

    # --- as one program: see `RunningProgram`

    @property
    def pid(self) -> int:
        """The process id of the first program that has not ended, or 0 if all have."""
        return next((one.pid for one in self._running.values() if one.poll() is None), 0)

    def pids(self) -> Collection[int]:
        """Return the ids of all the student's processes."""
        return [pid for one in self._running.values() for pid in one.pids()]

    def output(self) -> str:
        """Return what all programs printed, one after another."""
        return "".join(program.output() for program in (*self._stopped, *self._running.values()))

    def poll(self) -> ProcessExit | None:
        """Return how a student's program ended by itself; once they were asked to end, how the last one did."""
        self._see_companions()
        first: ProcessExit | None = None
        for name, student in self._running.items():
            exit_ = student.poll()
            if exit_ is None and self._interrupted:
                return None
            if exit_ is not None and not first:
                first, self.ended = exit_, name
        return first

    def wait(self, timeout_s: float) -> ProcessExit | None:
        """Wait for the end of the first program."""
        first = next(iter(self._running.values()), None)
        return first.wait(timeout_s) if first else None

    def interrupt(self) -> None:
        """Ask all programs to end."""
        self._interrupted = True
        for one in self._running.values():
            one.interrupt()

    def cpu_seconds(self) -> float:
        """Return the CPU seconds used by all the student's programs."""
        return sum(one.cpu_seconds() for one in (*self._stopped, *self._running.values()))

    def at_limit(self) -> bool:
        """Return whether one of them is being ended because of a limit."""
        return any(one.at_limit() for one in self._running.values())

    def kill(self) -> ProcessExit:
        """Kill all; return the exit of the program that had ended by itself, or of the first."""
        exits = {name: program.kill() for name, program in self._running.items()}
        for program in self._companions:
            program.kill()
        if self.ended in exits:
            return exits[self.ended]
        return next(iter(exits.values()), None) or self._stopped[0].kill()
