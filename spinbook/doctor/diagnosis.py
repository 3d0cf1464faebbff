"""The checks of this machine: runs each in its own process, and shows the findings as a table."""

from __future__ import annotations

import dataclasses
import importlib
import json
import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path

from rich.console import Console
from rich.table import Table
from rich.text import Text

from groundwork.child_process import run_program
from groundwork.clean_environment import GUARD, ignored, module_command
from groundwork.words import counted
from rmw_lockstep.ros import installed_ros
from spinbook.update.handout import BASE


class State(str, Enum):
    """How serious a finding is."""

    OK = "ok"
    """It works."""
    WARNING = "warning"
    """Something is weaker or surprising, but courses can be built and graded."""
    MISSING = "missing"
    """Without it, courses can't be built or graded."""


@dataclass(frozen=True)
class MachineFinding:
    """The result of one check, whose name `examine` puts in.

    `found` says what is there, with versions and paths. `fix` says what to do if something is wrong.
    """

    name: str
    state: State
    found: str
    fix: str = ""


def ok(found: str) -> MachineFinding:
    """Return the finding that it works."""
    return MachineFinding("", State.OK, found)


def warning(found: str, fix: str) -> MachineFinding:
    """Return the finding that it works, but not as well as it could."""
    return MachineFinding("", State.WARNING, found, fix)


def missing(found: str, fix: str) -> MachineFinding:
    """Return the finding that something needed does not work."""
    return MachineFinding("", State.MISSING, found, fix)


def last_words(ended: subprocess.CompletedProcess[str] | subprocess.CalledProcessError) -> str:
    """Return the last line that a program wrote to stderr, or else its exit code."""
    lines = (ended.stderr or "").strip().splitlines() or [f"exit code {ended.returncode}"]
    return str(lines[-1])


def in_handout() -> bool:
    """Return whether this is a handout's folder: what helps an author then helps nobody."""
    return Path(BASE).is_dir()


def only_grades() -> bool:
    """Return whether programs can only be graded here: with the extra `grade`, without Fast DDS."""
    ros = installed_ros()
    return ros is not None and ros.lacks_middleware


def set_up_again(python: str = "python3") -> str:
    """Return how the environment is set up again, here, with this Python."""
    if in_handout():
        return f"Set the environment up again: rm -r .venv, then step 1 of README.md, with {python} -m venv .venv"
    other = "" if python == "python3" else f"PYTHON={python} "
    return f"Set the environment up again, in the terminal that you want to use: make {other}setup"


SIGNS = {State.OK: ("✓", "green"), State.WARNING: ("!", "yellow"), State.MISSING: ("✗", "red")}


def show(console: Console, findings: Sequence[MachineFinding]) -> None:
    """Print every finding, then how to fix problems, then a summary."""
    table = Table(box=None, show_header=False, pad_edge=False, padding=(0, 1))
    table.add_column(width=1)
    table.add_column(no_wrap=True)
    table.add_column(overflow="fold")
    for finding in findings:
        sign, colour = SIGNS[finding.state]
        table.add_row(Text(sign, style=colour), Text(finding.name), Text(_with_tilde(finding.found)))
    console.print(table)
    for finding in findings:
        if finding.fix:
            sign, colour = SIGNS[finding.state]
            console.print()
            console.print(Text.assemble((f"{sign} {finding.name}", f"bold {colour}")))
            console.print(Text("\n".join(f"  {line}" for line in finding.fix.splitlines())), soft_wrap=True)
    console.print()
    console.print(_summary(findings), soft_wrap=True)


def is_able(findings: Sequence[MachineFinding]) -> bool:
    """Return whether everything works that is needed to build and grade."""
    return all(finding.state is not State.MISSING for finding in findings)


def _summary(findings: Sequence[MachineFinding]) -> str:
    does = "run notebooks and checks" if in_handout() else "build or grade a course"
    works = "Notebooks and checks work here" if in_handout() else "Courses can be built and graded here"
    if only_grades():
        does, works = "grade", "Programs can be graded here, and nothing else: nodes need Fast DDS (the extra ros)"
    missing_count = sum(finding.state is State.MISSING for finding in findings)
    warnings = sum(finding.state is State.WARNING for finding in findings)
    also = f" ({counted(warnings, 'warning')})" if warnings else ""
    if missing_count:
        return f"Fix every ✗ before you {does} here. Failed: {missing_count} of {len(findings)}{also}."
    return f"{works}{also}."


def _with_tilde(text: str) -> str:
    home = os.environ.get("HOME", "")
    return text.replace(f"{home}/", "~/") if Path(home).is_absolute() and home != "/" else text


@dataclass(frozen=True)
class MachineCheck:
    """A check of this machine.

    `function` runs it, as `module:name`. `seconds` is the time limit. `needs` are the words
    of earlier checks: if one of them fails, this one is not run, so that each cause is reported once.
    """

    word: str
    name: str
    function: str
    seconds: float = 15.0
    needs: tuple[str, ...] = ()


#: The checks of what a student needs.
OF_STUDENTS = (
    *("python", "folder", "libraries", "ros", "middleware", "logs", "message", "environment", "memory"),
    *("kernel", "colcon", "lockstep", "ros2"),
)
#: The checks of what grading needs, without Fast DDS.
OF_GRADING = ("python", "folder", "libraries", "compiler", "namespaces", "sandbox", "bubblewrap", "lockstep")
#: The checks of what programs find that are not Spinbook's, with the terminal's own variables.
OF_TERMINAL = ("libraries", "ros", "colcon")
#: The checks that every node depends on.
_NODE = ("ros", "libraries", "middleware", "logs")


CHECKS = (
    MachineCheck("python", "Python", "spinbook.doctor.machine:examine_python"),
    MachineCheck("folder", "Folder", "spinbook.doctor.machine:examine_folder"),
    MachineCheck("libraries", "Library path", "spinbook.doctor.ros:examine_library_path"),
    MachineCheck("ros", "ROS 2", "spinbook.doctor.ros:examine_ros_library", 30.0, ("libraries",)),
    MachineCheck("middleware", "Middleware", "spinbook.doctor.middleware:examine_middleware", 30.0, ("ros",)),
    MachineCheck("logs", "Log folder", "spinbook.doctor.middleware:examine_log_folder"),
    MachineCheck("message", "A message", "spinbook.doctor.middleware:examine_message", 60.0, _NODE),
    MachineCheck("environment", "ROS settings", "spinbook.doctor.ros:examine_ros_settings"),
    MachineCheck("memory", "Shared memory", "spinbook.doctor.middleware:examine_shared_memory"),
    MachineCheck("kernel", "Jupyter kernel", "spinbook.doctor.machine:examine_kernel", 60.0),
    MachineCheck("colcon", "colcon", "spinbook.doctor.machine:examine_colcon", 90.0),
    MachineCheck("compiler", "Compiler", "spinbook.doctor.machine:examine_compiler"),
    MachineCheck("namespaces", "Namespaces", "spinbook.doctor.sandbox:examine_namespaces"),
    MachineCheck("sandbox", "Sandbox", "spinbook.doctor.sandbox:examine_sandbox", 150.0, _NODE),
    MachineCheck("bubblewrap", "bubblewrap", "spinbook.doctor.sandbox:examine_bubblewrap"),
    MachineCheck("lockstep", "Lockstep", "spinbook.doctor.middleware:examine_lockstep", 30.0, ("ros",)),
    MachineCheck("ros2", "ros2, turtlesim", "spinbook.doctor.machine:examine_ros2_command"),
    MachineCheck("browser", "Browser", "spinbook.doctor.machine:examine_browser", 45.0),
)


#: Checks that run at once: they mostly wait for processes to start.
_AT_ONCE = 4


def diagnose(checks: Sequence[MachineCheck], done: Callable[[MachineFinding], None]) -> list[MachineFinding]:
    """Run the checks; return the findings in the order of `checks`. Call `done` with each as soon as it is known."""
    started: dict[str, Future[MachineFinding]] = {}

    def run(check: MachineCheck, needed: list[Future[MachineFinding]]) -> MachineFinding:
        failed = ", ".join(need.result().name for need in needed if need.result().state is State.MISSING)
        why = f"not checked, because this failed: {failed}"
        finding = MachineFinding(check.name, State.MISSING, why) if failed else examine(check)
        done(finding)
        return finding

    with ThreadPoolExecutor(_AT_ONCE) as pool:
        # The checks that one needs are earlier in the list, so they never queue behind it.
        for check in checks:
            started[check.word] = pool.submit(run, check, [started[word] for word in check.needs if word in started])
        return [future.result() for future in started.values()]


def examine(check: MachineCheck) -> MachineFinding:
    """Run one check in a process of its own; a crash or a timeout is a finding, too."""
    return replace(_examined(check), name=check.name)


def _examined(check: MachineCheck) -> MachineFinding:
    argv = module_command("spinbook.doctor.diagnosis", check.function)
    try:
        done = run_program(argv, check.seconds, env=_of_terminal() if check.word in OF_TERMINAL else None)
        if ignored() and not _reported(done.stdout):
            # It can't even start with the terminal's variables: the check of variables says which these are.
            done = run_program(argv, check.seconds)
    except subprocess.TimeoutExpired:
        return missing(
            f"the check did not finish within {check.seconds:g} s",
            f"Run it alone, when the machine is less busy: spinbook doctor {check.word}",
        )
    more = "README.md" if in_handout() else "docs/installing.md"
    return _reported(done.stdout) or missing(
        _how_it_ended(done.returncode, done.stderr), f"See the message, and {more}."
    )


def _reported(output: str) -> MachineFinding | None:
    try:
        fields = json.loads(output.splitlines()[-1])
        return MachineFinding("", State(fields["state"]), fields["found"], fields["fix"])
    except (ValueError, KeyError, TypeError, IndexError):
        return None


def _of_terminal() -> dict[str, str]:
    """Return the terminal's variables: this command has been started again without those of another installation."""
    values = ignored()
    terminal = {**os.environ, **values}
    if GUARD in values and "LD_LIBRARY_PATH" not in values:
        terminal.pop("LD_LIBRARY_PATH", None)
    return terminal


def _how_it_ended(code: int, err: str) -> str:
    how = f"signal {-code}" if code < 0 else f"exit code {code}"
    lines = [line.strip() for line in err.splitlines() if line.strip()]
    return f"the check ended with {how}" + (f": {lines[-1]}" if lines else "")


# Each check runs in its own process, because it may end that: rclpy does so if its middleware is not installed.


def main() -> None:
    """Run a check, given as `module:name`.

    Its finding goes to stdout; what libraries print goes to stderr.
    """
    original_stdout = os.dup(1)
    os.dup2(2, 1)
    module, _, attribute = sys.argv[1].partition(":")
    finding = getattr(importlib.import_module(module), attribute)()
    with os.fdopen(original_stdout, "w") as out:
        json.dump(dataclasses.asdict(finding), out)


if __name__ == "__main__":
    main()
