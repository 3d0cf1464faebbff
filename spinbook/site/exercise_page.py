"""The page of an exercise: task, interface, starter, how to check it, and the public checks with their points."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from grader.exercise.exercise import Exercise, Parameter, Topic


@dataclass(frozen=True)
class PublicCheck:
    """A check's title and its points."""

    title: str
    points: float


def public_checks(file: Path) -> tuple[PublicCheck, ...]:
    """Return the checks of an exercise's checks.py, in order, without running it; () if it can't be read."""
    try:
        tree = ast.parse(file.read_text(encoding="utf-8"))
    except (OSError, SyntaxError, UnicodeDecodeError):
        return ()
    checks = (_check(node) for node in tree.body if isinstance(node, ast.FunctionDef))
    return tuple(check for check in checks if check)


def _check(function: ast.FunctionDef) -> PublicCheck | None:
    for decorator in function.decorator_list:
        if not isinstance(decorator, ast.Call) or ast.unparse(decorator.func).split(".")[-1] != "check":
            continue
        points = next((word.value for word in decorator.keywords if word.arg == "points"), None)
        if isinstance(points, ast.Constant) and isinstance(points.value, (int, float)):
            title = (ast.get_docstring(function) or function.name).split("\n\n")[0]
            return PublicCheck(" ".join(title.split()), float(points.value))
    return None


def exercise_markdown(exercise: Exercise, task: str, starter: str, checks: Sequence[PublicCheck], download: str) -> str:
    """Return the page in MyST Markdown. `task` is the text of task.md from `rich`, so its line numbers are unchanged.

    `download` is the address of the starter's file, relative to the page.
    """
    sections = [task.rstrip("\n"), _interface(exercise)]
    if starter:
        sections.append(_starter(exercise, starter, download))
    sections += [_how_to_check(exercise), _points(exercise, checks)]
    return "\n\n".join(sections) + "\n"


def _interface(exercise: Exercise) -> str:
    parts = [f"## Interface\n\n{_programs(exercise)}"]
    if exercise.topics:
        rows = [_topic_row(topic) for topic in exercise.topics]
        parts.append(_table("| The node | Topic | Type | QoS | Units |", rows))
    if exercise.endpoints:
        rows = [
            f"| {_VERBS[end.role]} | `{end.name}` | `{end.type}` | {_units(end.units)} |" for end in exercise.endpoints
        ]
        parts.append(_table("| The node | Name | Type | Units |", rows))
    if exercise.parameters:
        rows = [_parameter_row(parameter) for parameter in exercise.parameters]
        parts.append(_table("| Parameter | Type | Default | Range |", rows))
    return "\n\n".join(parts)


def _table(head: str, rows: Sequence[str]) -> str:
    return "\n".join([head, "| --- " * (head.count("|") - 1) + "|", *rows])


def _programs(exercise: Exercise) -> str:
    if exercise.nodes:
        nodes = ", ".join(f"`{node}`" for node in exercise.nodes)
        return f"The launch file `{exercise.file_name}` starts: {nodes}."
    if exercise.programs:
        programs = [f"`{program.node}` in `{program.file}`" for program in exercise.programs]
        return f"There are {len(programs)} programs, each with its own node: {', '.join(programs)}."
    name = f" is the class `{exercise.class_name}`" if exercise.class_name else " is"
    return f"The node `{exercise.node_name}`{name} in the file `{exercise.file_name}`."


def _topic_row(topic: Topic) -> str:
    verb = "subscribes to" if topic.direction == "subscribe" else "publishes on"
    quality = f"keep last {topic.depth}, {topic.reliability}, {topic.durability}".replace("_", " ")
    return f"| {verb} | `{topic.name}` | `{topic.type}` | {quality} | {_units(topic.units)} |"


_VERBS = {
    "service": "serves the service",
    "client": "calls the service",
    "action": "serves the action",
    "action_client": "sends goals to the action",
}


def _parameter_row(parameter: Parameter) -> str:
    unit = f" {parameter.unit}" if parameter.unit else ""
    default = "none" if parameter.default is None else f"`{parameter.default}`{unit}"
    limits = f"from {parameter.range[0]:g} to {parameter.range[1]:g}{unit}" if parameter.range else "any"
    return f"| `{parameter.name}` | {parameter.type.replace('_', ' ')} | {default} | {limits} |"


def _units(units: dict[str, str]) -> str:
    return ", ".join(f"`{field}` in {unit}" for field, unit in units.items()) or "none"


def _starter(exercise: Exercise, starter: str, download: str) -> str:
    return f"""\
## Starter

Start from this file. Comments mark the places for your code.

<p><a class="button button-quiet" href="{download}" download>Download {exercise.file_name}</a></p>

```python
{starter.rstrip()}
```"""


def _how_to_check(exercise: Exercise) -> str:
    return f"""\
## Check your node

Save your node as `{exercise.file_name}`, then run this in the course's folder:

```bash
spinbook grade {exercise.name} {exercise.file_name}
```

The command starts your node, publishes to it, listens to what it publishes, and says what is right and what is not yet.
You may run it as often as you like. In the handout's notebook, `%check {exercise.name}` does the same for the
exercise's cell. [About this course](../about.md) says how to install what you need."""


def _points(exercise: Exercise, checks: Sequence[PublicCheck]) -> str:
    shown = sum(check.points for check in checks)
    rows = [f"| {check.title} | {check.points:g} |" for check in checks]
    rest = exercise.points - shown
    if rest > 0:
        rows.append(f"| The rules of the task, in hidden cases | {rest:g} |")
    table = "\n".join(
        ["| What is checked | Points |", "| --- | ---: |", *rows, f"| **All** | **{exercise.points:g}** |"]
    )
    return f"## Points\n\n{table}"
