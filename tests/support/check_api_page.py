"""Makes docs/check-api.md from the docstrings of what checks use.

Run it from the project's folder: PYTHONPATH=. .venv/bin/python tests/support/check_api_page.py > docs/check-api.md
"""

from __future__ import annotations

import inspect
import re
import types
from collections.abc import Callable, Iterator
from typing import Any

from grader.checking import (
    actions,
    answers,
    closed_loops,
    graph,
    life_cycle,
    parameters,
    partial,
    series,
    services,
    verdict,
)
from grader.checking.cause import Cause
from grader.checking.message import Exchange, Message, WorldState
from grader.checking.recorded_run import RecordedRun
from grader.checking.run import Run
from grader.recording import events, recording

HEAD = """\
# What a check can use

Made from the docstrings; each example is run by a test. The [guide](writing-checks.md) says how to write a check.
`run` is the recording of one scenario, which the check's argument names.

- **Times** are in seconds after the scenario's start. A name that ends in `_ns`, such as `at_ns`, is the exact time in
  nanoseconds of simulated time, in which the start is at 100 s: 2.5 s after it is 102_500_000_000.
- **A field** is a name, `"data"`, or leads into nested messages and lists: `"pose.position.x"`, `"ranges[0]"`,
  `"transforms[0].transform.translation"`.
- **Arguments** after a `*` are given by name: `check(points=5, hint="…")`.
- **A topic, service or action** that you leave out is the only one of its kind in exercise.toml. If there are several,
  name it.
- **Types**: `Place` is a dictionary from fields to values. `Way` is a list of (seconds, (value, …)), with a tuple of
  values also for one field: `time, (value,) = run.trajectory("/in", "data")[-1]`. `Errors` is a list of (seconds,
  number). `By` is "grader" or "node", `Kind` is that of an [Endpoint](#endpoint).
- **Helpers that begin with `must_`** end the check if the node does not do so, with a sentence for the student.

```python
from grader.checking import Run, check, each, fail
from grader.checking.cause import Cause
```

The examples are about a node `worker` that subscribes to `/in`, publishes on `/out` and `/point`, serves `/add` and
`/count`, calls `/ask`, sends goals to `/climb` and has a parameter `gain`, in this scenario. The truth() of its world
returns a `level`.

```python
def scenarios(seed):
    steps = (
        numbers("/in", wave(2.0, every(0.1, 1.0))),
        at(0.5).call("/add", a=1, b=2),
        at(0.5).set_parameter("gain", 3.0),
        at(0.6).set_parameter("gain", -1.0),
        at(0.7).get_parameter("gain"),
        at(0.7).transition("activate"),
        at(1.0, 2.0, 3.0).send_goal("/count", order=3),
        at(3.1).cancel(3),
    )
    servers = (Server("/ask", replies=reply(sum=3)), ActionServer("/climb", goals=succeeds(after=1.0)))
    return (Scenario("usual", "as usual", steps, servers=servers, interrupt=True, duration=4.0),)
```
"""

#: Title -> the module whose functions are methods of a run.
SUBJECTS: dict[str, types.ModuleType] = {
    "Nodes that answer messages": answers,
    "Nodes that publish on their own": series,
    "Services": services,
    "Nodes with a life cycle": life_cycle,
    "Actions": actions,
    "Parameters": parameters,
    "Closed loops and estimates": closed_loops,
    "The program in the graph": graph,
}

RECORDS = (
    *(Message, Exchange, WorldState, recording.Recording, recording.ReceivedMessage, recording.SentMessage),
    *(events.Call, events.Goal),
    *(events.GoalState, events.Feedback, events.Cancel, events.ParameterChange, events.ParameterReading),
    *(events.ProgramExit, events.ProgramStart, events.Event, recording.Endpoint, recording.Ending, Cause),
)

_PLAIN = """\
- `run.title`: the scenario's title
- `run.seed`: what `scenarios(seed)` got
- `run.exercise`: what exercise.toml says
- `run.recording`: all that was recorded, see [Recording](#recording)
- `run.reference`: the same of the run with your solution"""

_FIELDS = """\
`Fields` is a dictionary of a message's fields: `call.response["sum"]`. Messages have them as attributes as well:
`message.data`."""

#: What helpers share, and checks do not need.
_INTERNAL = ("observed", "waits", "only", "existing", "output", "published_on")


def page() -> str:
    """Return the text of the page."""
    return "\n".join([HEAD, *_page()]).rstrip() + "\n"


def examples() -> dict[str, str]:
    """Return each example by the heading under which it stands."""
    entries = [re.match(r"`(.*)`\n.*?^```python\n(.*?)\n```", text, re.M | re.S) for text in page().split("\n### ")]
    return {entry[1]: entry[2] for entry in entries if entry}


def _page() -> Iterator[str]:
    yield "## A check\n"
    for function in (verdict.check, verdict.fail, partial.each):
        yield from _function(function.__name__, function)
    yield "## A run\n"
    for name in [*vars(RecordedRun), "on"]:
        entry = inspect.getattr_static(Run, name)
        if name.startswith("_") or name in _INTERNAL or not inspect.getdoc(entry) or name in ("title", "seed"):
            continue
        if isinstance(entry, types.FunctionType):
            yield from _function(f"run.{name}", entry)
        else:
            documented = _documented(entry)
            yield from _entry(f"run.{name}{_returned(documented)}", documented)
    yield f"{_PLAIN}\n"
    for title, module in SUBJECTS.items():
        yield f"## {title}\n"
        for name, function in vars(Run).items():
            if inspect.isfunction(function) and function.__module__ == module.__name__:
                yield from _function(f"run.{name}", function)
    yield "## Records\n"
    yield f"{_FIELDS}\n"
    for record in RECORDS:
        yield from _record(record)


def _documented(entry: Any) -> Any:
    return entry.fget if isinstance(entry, property) else entry.func


def _function(name: str, function: Callable[..., Any]) -> Iterator[str]:
    parameters = [one for key, one in inspect.signature(function).parameters.items() if key not in ("self", "run")]
    returned = _returned(function) if name != "check" else ""
    written = [_parameter(one) for one in parameters]
    by_name = [place for place, one in enumerate(parameters) if one.kind is one.KEYWORD_ONLY]
    if by_name and not any(one.kind is one.VAR_POSITIONAL for one in parameters):
        written.insert(by_name[0], "*")
    yield from _entry(f"{name}({', '.join(written)}){returned}", function)


def _returned(function: Callable[..., Any]) -> str:
    """Return what a function returns, as Python writes it; nothing for one that only checks."""
    returned = str(inspect.signature(function).return_annotation)
    return "" if returned in ("None", "NoReturn") else f" -> {returned}"


def _parameter(one: inspect.Parameter) -> str:
    """Return a parameter as Python writes it; a default that is an object of the grader's is …"""
    star = "*" if one.kind is one.VAR_POSITIONAL else ""
    if one.default is one.empty:
        return f"{star}{one.name}: {one.annotation}"
    plain = isinstance(one.default, (str, int, float, tuple, type(None)))
    default = repr(one.default).replace("'", '"') if plain else "…"
    return f"{one.name}: {one.annotation} = {default}"


def _entry(heading: str, documented: Any) -> Iterator[str]:
    text, _, example = (inspect.getdoc(documented) or "").partition("\n\nExample: `")
    yield f"### `{heading}`\n"
    yield f"{text}\n"
    if example:
        yield f"```python\n{example.removesuffix('`')}\n```\n"


def _record(record: type) -> Iterator[str]:
    yield f"### `{record.__name__}`\n"
    yield f"{inspect.getdoc(record)}\n"
    names = {name: f"`: {type_}" for name, type_ in inspect.get_annotations(record).items()}
    for name, entry in _members(record):
        if isinstance(entry, property):
            names[name] = f"`: {_what(entry)}"
        elif inspect.isfunction(entry):
            names[name] = f"(…)`: {_what(entry)}"
    names = {name: text for name, text in names.items() if not name.startswith("_")}
    yield "\n".join(f"- `{name}{text}" for name, text in names.items()) + "\n"


def _what(entry: Any) -> str:
    return (inspect.getdoc(entry) or "").removeprefix("Return ")


def _members(record: type) -> Iterator[tuple[str, Any]]:
    """Yield what a record and its bases define, without what Python itself adds."""
    for kind in record.__mro__[:-1]:
        yield from vars(kind).items()


if __name__ == "__main__":
    print(page(), end="")
