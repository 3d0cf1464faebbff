"""Finds names in an exercise's checks that do not exist: helpers, topics, services, fields. Nothing runs for it."""

from __future__ import annotations

import ast
import inspect
import re
from collections.abc import Collection, Iterator
from dataclasses import fields as fields_of_class
from pathlib import Path
from typing import Any, get_args

from grader.checking import known_names
from grader.checking.argument_slips import argument_slips, is_unpacked
from grader.checking.closed_loops import TRUTH
from grader.checking.graph import Kind
from grader.checking.known_names import KnownNames
from grader.checking.message import Message
from grader.checking.run import Run
from grader.exercise.exercise import Exercise, ExerciseError
from grader.exercise.imported_files import tree_in, with_modules
from grader.recording.events import STATES, Call, Goal, ParameterChange, ParameterReading
from grader.recording.recording import Endpoint, ReceivedMessage, Recording, SentMessage
from grader.scenario.scenario import Scenario
from groundwork.words import did_you_mean
from ros_in_python.field_path import steps_of

#: What an expression in a check is: a message of a type, or a record such as `Call`; a list of these.
Value = tuple[str, Any]

#: The attributes of every message, whatever its fields are.
_OF_MESSAGES = {
    *(name for kind in (ReceivedMessage, SentMessage) for name in (one.name for one in fields_of_class(kind))),
    *(name for name in dir(Message) if not name.startswith("_")),
    *("at", "at_ns", "heard", "after", "topic"),
}

_OF_RUNS = {*(name for name in dir(Run) if not name.startswith("_")), *(one.name for one in fields_of_class(Run))}

#: Methods that return lists of records.
_LISTS = {"calls": Call, "goals": Goal, "end_points": Endpoint, "publishers": Endpoint, "subscriptions": Endpoint}

#: The lists of a recording whose records have the same attributes in every exercise.
_IN_RECORDINGS = {"calls": Call, "goals": Goal, "parameters": ParameterChange, "readings": ParameterReading}

#: Functions that return the same items in a list.
_SAME_ITEMS = ("sorted", "list", "tuple", "reversed")


def misspellings(exercise: Exercise, scenarios: tuple[Scenario, ...]) -> Iterator[ExerciseError]:
    """Yield each name in the checks, and in the modules that they import, that the exercise does not have."""
    known = known_names.of(exercise, scenarios)
    constants: dict[str, str] = {}
    files = [file for file in with_modules(exercise.check_files) if file != exercise.scenarios_file]
    for file in files:
        tree = tree_in(file)
        constants |= _constants(tree)
    for file in files:
        for function in [node for node in ast.walk(tree_in(file)) if isinstance(node, ast.FunctionDef)]:
            if names := _runs_in(function, known):
                yield from _Function(file, function, names, known, constants).errors()


def _constants(tree: ast.Module) -> dict[str, str]:
    """Return the texts that a module gives names to: `OUT = "/out"`, and several in one line."""
    found: dict[str, str] = {}
    for node in tree.body:
        if isinstance(node, ast.Assign) and len(node.targets) == 1:
            target, value = node.targets[0], node.value
            names = target.elts if isinstance(target, ast.Tuple) else [target]
            values = value.elts if isinstance(value, ast.Tuple) else [value]
            for name, item in zip(names, values, strict=False):
                if isinstance(name, ast.Name) and isinstance(item, ast.Constant) and isinstance(item.value, str):
                    found[name.id] = item.value
    return found


def _runs_in(function: ast.FunctionDef, known: KnownNames) -> set[str]:
    """Return the variables of a function that are runs: scenarios of a check, parameters of a helper, loops."""
    decorated = any(
        isinstance(one, ast.Call) and getattr(one.func, "id", "") == "check" for one in function.decorator_list
    )
    names = {
        argument.arg
        for argument in function.args.args
        if (isinstance(argument.annotation, ast.Name) and argument.annotation.id == "Run")
        or (decorated and argument.arg in known.scenarios)
    }
    for node in ast.walk(function):
        if isinstance(node, (ast.For, ast.comprehension)) and isinstance(node.iter, (ast.Tuple, ast.List)):
            runs = all(isinstance(one, ast.Name) and one.id in names for one in node.iter.elts)
            if runs and isinstance(node.target, ast.Name):
                names.add(node.target.id)
    return names


class _Function:
    """One function of a file of checks, and what its variables are."""

    def __init__(
        self, file: Path, function: ast.FunctionDef, runs: set[str], known: KnownNames, constants: dict[str, str]
    ) -> None:
        self._file, self._function, self._runs = file, function, runs
        self._known, self._constants = known, constants
        self._values: dict[str, Value | None] = {}
        self._lists: dict[str, Value | None] = {}
        self._bind()

    def errors(self) -> Iterator[ExerciseError]:
        """Yield each unknown name."""
        for node in ast.walk(self._function):
            if isinstance(node, ast.Attribute):
                yield from self._attribute(node)
            elif isinstance(node, ast.Subscript) and isinstance(node.value, ast.Attribute):
                yield from self._key(node, node.value)
            if isinstance(node, ast.Call) and self._is_method(node.func):
                yield from self._call(node)
            elif isinstance(node, ast.Expr) and isinstance(node.value, ast.Attribute) and self._is_method(node.value):
                yield from self._not_called(node.value)

    # --- variables

    def _bind(self) -> None:
        for node in ast.walk(self._function):
            if isinstance(node, ast.Assign) and len(node.targets) == 1:
                self._remember(node.targets[0], self._value(node.value), self._items(node.value))
            elif isinstance(node, (ast.For, ast.comprehension)):
                self._remember(node.target, self._items(node.iter), None)
            elif isinstance(node, ast.Call) and getattr(node.func, "id", "") == "each" and len(node.args) == 2:
                items, judge = node.args
                for argument in judge.args.args if isinstance(judge, ast.Lambda) else ():
                    self._remember(ast.Name(argument.arg), self._items(items), None)

    def _remember(self, target: ast.expr, value: Value | None, items: Value | None) -> None:
        """Note what a variable is; None if it is unknown, or different things at different places."""
        if not isinstance(target, ast.Name):
            for one in ast.walk(target):
                if isinstance(one, ast.Name):
                    self._values[one.id] = self._lists[one.id] = None
            return
        for known, now in ((self._values, value), (self._lists, items)):
            known[target.id] = now if known.get(target.id, now) == now else None

    def _value(self, node: ast.expr) -> Value | None:
        if isinstance(node, ast.Name):
            return self._values.get(node.id)
        if isinstance(node, ast.Subscript) and not isinstance(node.slice, ast.Slice):
            return self._items(node.value)
        if isinstance(node, ast.Attribute) and self._is_method(node) and node.attr in ("recording", "reference"):
            return "record", Recording
        if isinstance(node, ast.Attribute) and (owner := self._value(node.value)) and owner[0] == "message":
            nested = known_names.nested(owner[1], node.attr)
            return ("message", nested) if nested and node.attr not in _OF_MESSAGES else None
        return None

    def _items(self, node: ast.expr) -> Value | None:
        """Return what the items of a list are."""
        if isinstance(node, ast.Name):
            return self._lists.get(node.id)
        if isinstance(node, ast.Subscript) and isinstance(node.slice, ast.Slice):
            return self._items(node.value)
        if isinstance(node, ast.Attribute) and self._is_method(node) and node.attr in ("sent", "received"):
            types = self._known.sent if node.attr == "sent" else self._known.received
            return ("message", types[0]) if len(types) == 1 else None
        if isinstance(node, ast.Attribute) and self._value(node.value) == ("record", Recording):
            return ("record", _IN_RECORDINGS[node.attr]) if node.attr in _IN_RECORDINGS else None
        if isinstance(node, ast.Attribute) and (owner := self._value(node.value)) and owner[0] == "message":
            element = known_names.element(owner[1], node.attr)
            return ("message", element) if element else None
        if isinstance(node, ast.Call) and getattr(node.func, "id", "") in _SAME_ITEMS and node.args:
            return self._items(node.args[0])
        if isinstance(node, ast.Call) and self._is_method(node.func):
            return self._returned(node, node.func)
        return None

    def _returned(self, node: ast.Call, function: ast.expr) -> Value | None:
        assert isinstance(function, ast.Attribute)
        if function.attr in _LISTS:
            return "record", _LISTS[function.attr]
        if function.attr not in ("messages_on", "published_on"):
            return None
        topic = self._text(self._arguments(node, function.attr).get("topic"))
        type_ = self._known.topics.get(topic, "") if topic else ""
        if not topic and len(self._known.received) == 1:
            type_ = self._known.received[0]
        return ("message", type_) if type_ else None

    def _is_method(self, node: ast.expr) -> bool:
        return isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name) and node.value.id in self._runs

    def _text(self, node: ast.expr | None) -> str:
        """Return a text that the source says, directly or by a constant; otherwise an empty one."""
        if isinstance(node, ast.Name):
            return "" if node.id in self._values else self._constants.get(node.id, "")
        return node.value if isinstance(node, ast.Constant) and isinstance(node.value, str) else ""

    # --- what is wrong

    def _error(self, node: ast.expr, problem: str, name: str, known: Collection[str]) -> ExerciseError:
        fix = did_you_mean(name, known, f"There are: {', '.join(sorted(known)) or 'none'}.")
        return ExerciseError(self._file, problem, fix, node.lineno)

    def _attribute(self, node: ast.Attribute) -> Iterator[ExerciseError]:
        if self._is_method(node):
            if node.attr not in _OF_RUNS:
                yield self._error(node, f"a run has no {node.attr}", node.attr, _OF_RUNS)
            return
        value = self._value(node.value)
        if value is None:
            return
        kind, type_ = value
        known = _names_in(type_) if kind == "message" else _names_of(type_)
        if node.attr not in known and (kind == "record" or known_names.fields(type_)):
            subject = type_ if kind == "message" else f"the record {type_.__name__}"
            candidates = known_names.fields(type_) if kind == "message" else known
            yield self._error(node, f"{subject} has no {node.attr}", node.attr, candidates)

    def _key(self, node: ast.Subscript, owner: ast.Attribute) -> Iterator[ExerciseError]:
        """Yield the error for `message.fields["dat"]`."""
        value, name = self._value(owner.value), self._text(node.slice)
        if value and value[0] == "message" and owner.attr == "fields" and name:
            known = known_names.fields(value[1])
            if known and name not in known:
                yield self._error(node, f"{value[1]} has no field {name!r}", name, known)

    def _not_called(self, node: ast.Attribute) -> Iterator[ExerciseError]:
        if callable(getattr(Run, node.attr, None)):
            written = ast.unparse(node)
            yield ExerciseError(self._file, f"{written} is not called", f"Write {written}(…).", node.lineno)

    def _arguments(self, node: ast.Call, method: str) -> dict[str, Any]:
        """Return the arguments of a call by the names of the parameters; none if the source does not say."""
        function = getattr(Run, method, None)
        if not callable(function) or is_unpacked(node):
            return {}
        keywords = {str(keyword.arg): keyword.value for keyword in node.keywords}
        try:
            return dict(inspect.signature(function).bind_partial(None, *node.args, **keywords).arguments)
        except TypeError:
            return {}

    def _call(self, node: ast.Call) -> Iterator[ExerciseError]:
        assert isinstance(node.func, ast.Attribute)
        method = node.func.attr
        if method not in _OF_RUNS or not callable(getattr(Run, method, None)):
            return
        parameters = set(inspect.signature(getattr(Run, method)).parameters) - {"run", "self"}
        unknown = [keyword.arg for keyword in node.keywords if keyword.arg and keyword.arg not in parameters]
        for name in unknown:
            yield self._error(node, f"{method} has no argument {name}", name, parameters)
        for problem, fix in () if unknown else argument_slips(method, getattr(Run, method), node):
            yield ExerciseError(self._file, problem, fix, node.lineno)
        arguments = self._arguments(node, method)
        topic = self._text(arguments.get("topic"))
        for name, argument in arguments.items():
            yield from self._argument(node, method, topic, name, argument)

    def _argument(self, node: ast.Call, method: str, topic: str, name: str, argument: Any) -> Iterator[ExerciseError]:
        known, word = self._candidates(method, name)
        for text in self._texts(argument) if word else ():
            if text not in known:
                yield self._error(node, f"there is no {word} {text!r}", text, known)
        for text in self._of_truth(method, topic, name, argument):
            if self._known.truth and re.split(r"[.\[]", text)[0] not in self._known.truth:
                yield self._error(node, f"the world's truth has no {text!r}", text, self._known.truth)
        if name in ("field", "fields", "per", "place"):
            types = self._types(method, topic)
            for path in self._texts(argument):
                if problem := _unreadable(path):
                    yield ExerciseError(
                        self._file, problem, "Write for example position[0] or header.stamp.", node.lineno
                    )
                elif types and not any(known_names.has(type_, path) for type_ in types):
                    every = {known for type_ in types for known in known_names.fields(type_)}
                    yield self._error(node, f"{' and '.join(types)} has no field {path!r}", path, every)

    def _of_truth(self, method: str, topic: str, name: str, argument: Any) -> list[str]:
        """Return the names of an argument that are names in the world's truth."""
        if method == "must_estimate" and name == "fields" and isinstance(argument, ast.Dict):
            return [text for value in argument.values if (text := self._text(value))]
        return self._texts(argument) if name in ("field", "fields", "place") and topic == TRUTH else []

    def _texts(self, argument: Any) -> list[str]:
        """Return the texts of an argument: one, the keys of a dictionary, or several positional ones."""
        nodes = argument if isinstance(argument, tuple) else [argument]
        nodes = [key for one in nodes for key in (one.keys if isinstance(one, ast.Dict) else [one])]
        return [text for one in nodes if (text := self._text(one))]

    def _candidates(self, method: str, name: str) -> tuple[Collection[str], str]:
        """Return what a parameter may be, and its word; nothing if it may be anything."""
        known = self._known
        anything: dict[str, tuple[Collection[str], str]] = {
            "topic": (known.topics, "topic" if known.complete else ""),
            "service": (known.services, "service"),
            "action": (known.actions, "action"),
            "subscriber": (known.subscribers, "subscriber"),
            "program": (known.programs, "program"),
            "status": (STATES, "state"),
            "states": (STATES, "state"),
            "kind": (get_args(Kind), "kind of endpoint"),
            "by": (("grader", "node"), "caller"),
        }
        if name == "name" and method in ("must_take", "must_refuse", "must_have_parameter"):
            return known.parameters, "parameter"
        return anything.get(name, ((), ""))

    def _types(self, method: str, topic: str) -> list[str]:
        """Return the types whose fields a call is about; none if they are unknown."""
        known = self._known
        if topic:
            return [known.topics[topic]] if known.topics.get(topic) else []
        parts = {
            "must_match_responses": known.parts("service", "Response"),
            "must_match_requests": known.parts("client", "Request"),
            "must_match_results": known.parts("action", "Result"),
            "must_match_feedback": known.parts("action", "Feedback"),
            "must_match_goals": known.parts("action_client", "Goal"),
        }
        if method in parts:
            return parts[method]
        on_outputs = ("must_match", "must_vary", "must_match_series", "must_stamp")
        return list(known.received) if method in on_outputs else []


def _unreadable(path: str) -> str:
    try:
        steps_of(path)
    except ValueError as error:
        return str(error).partition(". Write")[0]
    return ""


def _names_in(message: str) -> set[str]:
    """Return the attributes of a message of this type. One without a header has no stamp."""
    fields = {*known_names.fields(message)}
    return fields | (_OF_MESSAGES if fields & {"header", "stamp"} else _OF_MESSAGES - {"stamp", "stamp_ns"})


def _names_of(record: type) -> set[str]:
    return {one.name for one in fields_of_class(record)} | {name for name in dir(record) if not name.startswith("_")}
