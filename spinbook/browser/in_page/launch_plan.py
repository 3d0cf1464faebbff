"""`ros2 launch` in a page: reads the launch file; the page starts what it describes."""

from __future__ import annotations

import json
from collections.abc import Callable, Sequence
from pathlib import Path
from types import SimpleNamespace
from typing import Any

from ros_in_python.launch import command
from ros_in_python.launch import plan as plan_module
from ros_in_python.launch.actions import Node
from ros_in_python.launch.plan import ProcessToStart, Step
from ros_in_python.ros2.cli import CommandError

_planned: list[dict[str, Any]] = []


class _LaunchRecorder:
    """Replaces `ProcessGroup`: records the processes to start instead of starting them."""

    def __init__(self, reaction: Callable[..., Any]) -> None:
        pass

    def run(self, steps: Sequence[Step]) -> int:
        """Record the steps, with the texts of their parameter files, which are removed afterwards."""
        _planned[:] = map(_step, steps)
        return 0


def _step(step: Step) -> dict[str, Any]:
    if isinstance(step, str):
        return {"say": step}
    if not isinstance(step, ProcessToStart) or not isinstance(step.action, Node) or step.action.package is None:
        raise CommandError(
            "a page starts nodes of packages at once: this launch file has timers, events or other programs.",
            "Run it in a notebook or a terminal.",
        )
    package, executable, *args = step.argv
    files = {word: Path(word).read_text(encoding="utf-8") for word in args if word.endswith((".yaml", ".yml"))}
    return {"package": package, "executable": executable, "args": args, "files": files}


def _unresolved(package: str, executable: str, cwd: Path) -> SimpleNamespace:
    """Return the package and executable unresolved: the page knows its nodes by these names."""
    return SimpleNamespace(argv=(package, executable), env={})


def plan(line: str) -> str:
    """Return what `ros2 launch …` starts, as JSON: its exit status and the steps. Errors are printed."""
    from spinbook.browser.in_page.cells import run_command

    # Processes of the page replace those of the system.
    setattr(command, "ProcessGroup", _LaunchRecorder)  # noqa: B010 - for the type checker, it is another module's import
    setattr(plan_module, "find", _unresolved)  # noqa: B010
    _planned.clear()
    status = run_command(line)
    return json.dumps({"status": status, "steps": _planned})
