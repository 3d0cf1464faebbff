"""Determines how a student's program ended, and what the student reads about it."""

from __future__ import annotations

import contextlib
import re
from collections.abc import Mapping

from grader.recording.recording import Ending
from grader.runner.budget import Allowance, Budget, ProgramExited
from grader.runner.error_advice import advice_on, result_advice
from grader.runner.node_attributes import silently_replaced
from grader.runner.program import CannotContinue, RunningProgram
from grader.runner.tracebacks import LastError, aborting_line, error_on_interrupt, first_error, last_error
from grader.scenario.scenario import SECOND
from groundwork.process_exit import ProcessExit
from rmw_lockstep.hub import TICK_S, Hub, Violation

LIMITS = {
    "cpu": "it used more computing time than a node may",
    "memory": "it used more memory than a node may",
    "processes": "it started more processes than a node may",
    "file-size": "it wrote more to disk than a node may",
    "output": "it printed more than a node may",
    "wall": "it ran longer than a node may",
}


#: What ROS 2's C code prints before it aborts a program that gave it an object of another class (rosidl_generator_py).
OTHER_CLASS = re.compile(r'__convert_from_py: Assertion .strncmp\("(?:\w+\.)+(?P<expected>\w+)"')

#: What the same code prints before it aborts a program that gave it another type of value in a field.
OTHER_VALUE = re.compile(r"\b(?P<name>\w+)__convert_from_py: Assertion .Py(?P<kind>Float|Long|Unicode|Bool)_Check")

_VALUES = {
    "Float": "A float field of it needs a float: 2.0 instead of 2, float(value), or the data of a message",
    "Long": "An integer field of it needs an int",
    "Unicode": "A text field of it needs a str",
    "Bool": "A bool field of it needs True or False",
}


def _of_signal(signal: int, log: str, at: LastError | None) -> str:
    place = at.where if at else ""
    if other := OTHER_CLASS.search(log):
        text = f"it gave ROS 2 an object of another class than {other['expected']}{place}."
        action, _, kind = other["expected"].rpartition("_")
        return f"{text} {result_advice(action)}" if kind == "Result" else text
    if value := OTHER_VALUE.search(log):
        type_name = re.split(r"(?:action|srv|msg)__", value["name"])[-1].replace("__", " ").replace("_", " ")
        return f"it put a value of another type into a message ({type_name}){place}. {_VALUES[value['kind']]}."
    return f"it was killed by signal {signal}."


def described(last: LastError, sources: Mapping[str, str]) -> str:
    """Return an error with its line, the line's source and advice, as far as they are known."""
    advice = advice_on(last, sources)
    error = re.sub(r"\. Did you mean: '\w+'\?$", "", last.error) if advice else last.error
    return " ".join(filter(None, (f"{error}{last.where}".rstrip(".") + ".", advice)))


def of_exit(exit_: ProcessExit, log: str, sources: Mapping[str, str]) -> tuple[str, int | None]:
    """Return why a program ended, as a clause that follows "Your program ended: ", and the line to blame."""
    if exit_.limit:
        return f"{LIMITS.get(exit_.limit, exit_.limit)}.", None
    last = last_error(log, sources)
    if last and last.error:
        return described(last, sources), last.line
    if exit_.signal:
        at = aborting_line(log, sources)
        return _of_signal(exit_.signal, log, at), at.line if at else None
    if exit_.code == 0:
        once = any("spin_once(" in source for source in sources.values())
        why = " spin_once() returns after one callback; rclpy.spin(node) stays until Ctrl-C." if once else ""
        return f"it came to its end by itself, before it was asked to.{why}", None
    return f"it gave up with exit code {exit_.code}.", None


#: How long a node may take to end after Ctrl-C: CPU time and blocked time together.
MAY_TAKE_S = 2.0


def cut_short(student: RunningProgram, sources: Mapping[str, str], met: bool, when: str) -> Ending:
    """Return the ending of a program that ended by itself, `when`; `met` is whether it was ready by then."""
    exit_ = student.poll() or student.kill()
    log = student.output()
    why, line = of_exit(exit_, log, sources)
    if exit_.limit:
        return Ending("over-limit", f"Your program was ended: {why}", line)
    if not met:
        if exit_.code == 0 and not line:
            why = f"it came to its end and created no node that spins. {_not_called(sources)}"
        return Ending("did-not-start", f"Your program did not start: {why}", line)
    return Ending("crashed", f"Your program ended {when}: {why}", line)


#: A guard of main() that is never true.
_GUARD = re.compile(r"""^if[ (]+__name__ *==(?![( ]*(["'])__main__\1).*""", re.MULTILINE)


def _not_called(sources: Mapping[str, str]) -> str:
    if guard := next(filter(None, map(_GUARD.search, sources.values())), None):
        return f"`{guard[0].strip()[:80]}` is never true: write if __name__ == '__main__':"
    return "Is main() called, and does it call rclpy.spin()?"


#: rclpy's log line for an exception in an execute callback.
_IN_EXECUTE = re.compile(r"Error raised in execute callback: (.*?)(?:, at \S+:\d+)?$", re.MULTILINE)
#: What `ros2 launch` logs about a program that it did not ask to end.
_DIED = re.compile(r"^\[ERROR\] \[(.+)\]: process has died ", re.MULTILINE)


def survived_by(log: str, sources: Mapping[str, str]) -> str:
    """Return what went wrong in a program that still runs, for the student: the first exception in its log, or what it
    replaced in its node; "" if nothing is known.
    """
    error = first_error(log, sources)
    if error:
        return f"Your program raised an exception: {described(error, sources)}"
    if died := _DIED.search(log):
        last = last_error(log, sources)
        return f"A program of your launch file ended with an error: {died[1]}. {last.error if last else ''}".rstrip()
    match = _IN_EXECUTE.search(log)
    if not match:
        return silently_replaced(sources)
    takes = " It gets the goal handle: def execute(self, goal_handle)." if "positional argument" in match[1] else ""
    return f"Your execute callback raised an exception: {match[1]}.{takes}"


_ALLOWANCE = Allowance("", "", MAY_TAKE_S, MAY_TAKE_S)


def interrupted(hub: Hub, budget: Budget, student: RunningProgram, sources: Mapping[str, str]) -> Ending:
    """Return how the program ends. It has 2 s, of CPU time and blocked time together.

    The signal wakes the program in ways that the hub does not see. So the computer's clock goes on only while none of
    its threads runs or could run, as fast as a real clock: a program that waits for a time waits as long as it would
    in real life, and on a busy machine no time passes before it has reacted to the signal.
    """
    before = student.output()
    student.interrupt()
    budget.begin(_ALLOWANCE)
    if not _ends(hub, budget):
        return Ending("completed", interrupted=True, ended_in_time=False)
    error = error_on_interrupt(before, student.output(), sources)
    return Ending("completed", interrupted=True, traceback=error)


def _ends(hub: Hub, budget: Budget) -> bool:
    granted = budget.blocked
    with contextlib.suppress(ProgramExited):
        with contextlib.suppress(CannotContinue):
            while budget.used < MAY_TAKE_S:
                hub.pause()
                if budget.blocked - granted >= TICK_S and hub.is_idle():
                    granted = budget.blocked
                    hub.advance(hub.now + round(TICK_S * SECOND))
        return False
    return True


_MESSAGES = {
    "message": "Your node published a message of {found:,} bytes. At most {limit:,} are allowed.",
    "bytes": "Your node published more than {limit:,} bytes in one scenario.",
    "messages": "Your node sent more than {limit:,} messages in one scenario.",
    "at once": (
        "Your node sent more than {limit:,} messages or requests at one moment, on {text}. Is there a loop that never "
        "waits, a callback that creates a timer each time, or does each answer lead to the next one?"
    ),
    "own messages": (
        "Your node sent more than {limit:,} messages at one moment, on {text}, to which it also subscribes. Does it "
        "answer its own messages? Check the names of its topics."
    ),
    "nodes": "Your program created more than {limit:,} nodes.",
    "endpoints": "Your program created more than {limit:,} publishers, subscriptions, clients and services.",
    "connections": "Your program started more than {limit:,} processes.",
    "unread": (
        "Your program does not take what is sent to it, by the grader or by its own processes: more than {limit:,} "
        "bytes are waiting."
    ),
    "unanswered": "More than {limit:,} requests between your program's processes wait for an answer.",
    "wake-ups": "Your program woke up more than {limit:,} times in one scenario. Does a loop wait for no time at all?",
    "cpu": (
        "Your program kept the grader busy: what it sent took more than {limit:.1f} s of computing time to read. "
        "Does a loop send, or create and remove, something without waiting?"
    ),
    "frames": "Your program changed the ROS graph, or fell asleep, more than {limit:,} times in one scenario.",
    "protocol": "Your program disturbed the connection between ROS 2 and the grader: {text}.",
}


def message_of_violation(violation: Violation) -> str:
    """Return a message for the student."""
    message = _MESSAGES[violation.reason]
    return message.format(found=violation.found, limit=violation.limit, text=violation.text)
