"""`ros2 launch` in a page: reads the launch file; the page starts what it describes."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from ros_in_python.launch import command
from ros_in_python.launch import plan as plan_module
from ros_in_python.launch.actions import Node
from ros_in_python.launch.events import (
    ExecutionComplete,
    OnStateTransition,
    ProcessExited,
    ProcessStarted,
    ShutdownRequested,
)
from ros_in_python.launch.plan import LaunchPlan
from ros_in_python.launch.steps import Emission, EventStep, Later, ProcessToStart, Step
from ros_in_python.ros2.cli import CommandError

_planned: list[dict[str, Any]] = []


#: What else a page can't do.
_ELSEWHERE = "Run it in a notebook or a terminal."
#: Steps of handlers that start programs whose handlers start programs are not followed any deeper than this.
_DEEPEST = 10


class _LaunchRecorder:
    """Replaces `ProcessGroup`: records the processes to start instead of starting them."""

    def __init__(self, plan: LaunchPlan) -> None:
        pass

    def run(self, steps: Sequence[Step]) -> int:
        """Record the steps, with the texts of their parameter files, which are removed afterwards."""
        _planned[:] = _StepReader(steps).read(steps)
        return 0


class _StepReader:
    """Turns steps into what the page carries out. Raises `CommandError` for what it can't."""

    def __init__(self, steps: Sequence[Step]) -> None:
        self._handlers = [step for step in _all(steps) if isinstance(step, EventStep)]
        for step in self._handlers:
            if step.steps is None or step.handler.handle_once or isinstance(step.handler, OnStateTransition):
                raise _refusal(f"{type(step.handler).__name__} with a function, a state or handle_once")

    def read(self, steps: Sequence[Step], depth: int = 0) -> list[dict[str, Any]]:
        """Return what the page does, in order."""
        if depth > _DEEPEST:
            raise _refusal("programs that start one another for ever")
        return [self._step(step, depth) for step in steps if not isinstance(step, EventStep)]

    def _step(self, step: Step, depth: int) -> dict[str, Any]:
        if isinstance(step, str):
            return {"say": step}
        if isinstance(step, Later) and step.is_cancelled_at_end:
            return {"after": step.seconds, "steps": self.read(step.steps, depth)}
        if isinstance(step, Emission) and isinstance(step.event, ShutdownRequested):
            return {"shutdown": True}
        if not isinstance(step, ProcessToStart):
            raise _refusal(f"a step of the kind {type(step).__name__}")
        action = step.action
        return {
            **_program(step),
            "onStart": self._reactions(ProcessStarted(action, step.name, 0), depth),
            "onExit": [
                *self._reactions(ProcessExited(action, step.name, 0, 0), depth),
                *self._reactions(ExecutionComplete(action), depth),
            ],
        }

    def _reactions(self, event: Any, depth: int) -> list[dict[str, Any]]:
        reacting = [step.steps or () for step in self._handlers if step.handler.matcher(event)]
        return [item for steps in reacting for item in self.read(steps, depth + 1)]


def _all(steps: Sequence[Step]) -> Iterator[Step]:
    for step in steps:
        yield step
        if isinstance(step, Later | EventStep):
            yield from _all(step.steps or ())


def _program(step: ProcessToStart) -> dict[str, Any]:
    action = step.action
    if not isinstance(action, Node) or action.package is None:
        raise _refusal("a program that is not a node of a package")
    if action.prefix or step.cwd or step.respawn_s is not None or set(step.env) - {"PYTHONUNBUFFERED"}:
        raise _refusal("a prefix, a folder, an environment variable or a respawn")
    package, executable, *args = step.argv
    files = {word: Path(word).read_text(encoding="utf-8") for word in args if word.endswith((".yaml", ".yml"))}
    return {"package": package, "executable": executable, "args": args, "files": files}


def _refusal(feature: str) -> CommandError:
    return CommandError(f"a page can't do what this launch file asks for: {feature}.", _ELSEWHERE)


def _unresolved(package: str, executable: str, cwd: Path) -> SimpleNamespace:
    """Return the package and executable unresolved: the page knows its nodes by these names."""
    return SimpleNamespace(argv=(package, executable), env={})


def plan(line: str) -> dict[str, Any]:
    """Return what `ros2 launch …` starts: its exit status and the steps. Errors are printed."""
    from spinbook.browser.in_page.cells import run_command

    # Processes of the page replace those of the system.
    setattr(command, "ProcessGroup", _LaunchRecorder)  # noqa: B010 - for the type checker, it is another module's import
    setattr(plan_module, "find", _unresolved)  # noqa: B010
    _planned.clear()
    status = run_command(line)
    return {"status": status, "steps": _planned}
