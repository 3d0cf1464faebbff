"""Runs the checks in parallel, each in a process that may crash or hang without harm to the others."""

from __future__ import annotations

import dataclasses
import importlib
import json
import os
import subprocess
import sys
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import dataclass

from grader.child_process import run_program
from spinbook.doctor.finding import Finding, State, missing


@dataclass(frozen=True)
class Check:
    """One thing to look at.

    `function` is what does it, as `module:name`; it is called with `name`. `seconds` is how long it may take.
    `needs` are the words of earlier checks without which this one can only fail, so that a cause is told once.
    """

    word: str
    name: str
    function: str
    seconds: float = 15.0
    needs: tuple[str, ...] = ()


#: What every node needs.
_NODE = ("ros", "libraries", "middleware", "logs")


CHECKS = (
    Check("python", "Python", "spinbook.doctor.machine:examine_python"),
    Check("folder", "Folder", "spinbook.doctor.machine:examine_folder"),
    Check("libraries", "Library path", "spinbook.doctor.ros:examine_library_path"),
    Check("ros", "ROS 2", "spinbook.doctor.ros:examine_ros_library", 30.0, ("libraries",)),
    Check("middleware", "Middleware", "spinbook.doctor.middleware:examine_middleware", 30.0, ("ros",)),
    Check("logs", "Log folder", "spinbook.doctor.middleware:examine_log_folder"),
    Check("message", "A message", "spinbook.doctor.message:examine", 60.0, _NODE),
    Check("environment", "ROS settings", "spinbook.doctor.ros:examine_ros_settings"),
    Check("memory", "Shared memory", "spinbook.doctor.middleware:examine_shared_memory"),
    Check("kernel", "Jupyter kernel", "spinbook.doctor.machine:examine_kernel", 60.0),
    Check("colcon", "colcon", "spinbook.doctor.machine:examine_colcon", 90.0),
    Check("compiler", "Compiler", "spinbook.doctor.machine:examine_compiler"),
    Check("namespaces", "Namespaces", "spinbook.doctor.sandbox:examine_namespaces"),
    Check("sandbox", "Sandbox", "spinbook.doctor.sandbox:examine_sandbox", 150.0, _NODE),
    Check("bubblewrap", "bubblewrap", "spinbook.doctor.sandbox:examine_bubblewrap"),
    Check("lockstep", "Lockstep", "spinbook.doctor.middleware:examine_lockstep", 30.0, ("ros",)),
    Check("ros2", "ros2, turtlesim", "spinbook.doctor.machine:examine_ros2_command"),
    Check("browser", "Browser", "spinbook.doctor.machine:examine_browser", 45.0),
)


#: They mostly wait for processes to start.
_AT_ONCE = 4


def diagnose(checks: Sequence[Check], done: Callable[[Finding], None]) -> list[Finding]:
    """The findings in the order of `checks`; `done` is called with each as it comes."""

    started: dict[str, Future[Finding]] = {}

    def one(check: Check, needed: list[Future[Finding]]) -> Finding:
        amiss = [need.result().name for need in needed if need.result().state is State.MISSING]
        finding = missing(check.name, f"not tried, because of: {', '.join(amiss)}", "") if amiss else examine(check)
        done(finding)
        return finding

    with ThreadPoolExecutor(_AT_ONCE) as pool:
        # What is needed stands earlier in the list, so it never queues behind what waits for it.
        for check in checks:
            started[check.word] = pool.submit(one, check, [started[word] for word in check.needs if word in started])
        return [future.result() for future in started.values()]


def examine(check: Check) -> Finding:
    """Run one check, whatever happens to it."""
    argv = [sys.executable, "-m", "spinbook.doctor.diagnosis", check.function, check.name]
    try:
        done = run_program(argv, check.seconds)
    except subprocess.TimeoutExpired:
        return missing(
            check.name,
            f"no answer within {check.seconds:g} s",
            f"Try it alone, on a machine that is less busy: spinbook doctor {check.word}",
        )
    try:
        fields = json.loads(done.stdout)
        return Finding(fields["name"], State(fields["state"]), fields["found"], fields["fix"])
    except (ValueError, KeyError, TypeError):
        return missing(
            check.name, _how_it_ended(done.returncode, done.stderr), "See the message; docs/installing.md may help."
        )


def _how_it_ended(code: int, err: str) -> str:
    how = f"signal {-code}" if code < 0 else f"exit code {code}"
    lines = [line.strip() for line in err.splitlines() if line.strip()]
    return f"the check ended with {how}" + (f": {lines[-1]}" if lines else "")


# A process of its own, because what is examined may end it: rclpy does so where its middleware is not installed.


def main(function: str, name: str) -> None:
    """Run a check, given as `module:name`; its finding goes to stdout, what libraries print to stderr."""
    answer = os.dup(1)
    os.dup2(2, 1)
    module, _, attribute = function.partition(":")
    finding = getattr(importlib.import_module(module), attribute)(name)
    assert isinstance(finding, Finding)
    with os.fdopen(answer, "w") as out:
        json.dump(dataclasses.asdict(finding), out)


if __name__ == "__main__":
    main(*sys.argv[1:])
