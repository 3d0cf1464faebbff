"""Reads the interface of an exercise's program from exercise.toml, and refuses unknown keys."""

from __future__ import annotations

import contextlib
import re
import sys
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NoReturn, get_args

from grader.exercise.exercise import (
    PUBLIC_FILE,
    Durability,
    Elements,
    ExerciseError,
    Parameter,
    ProgramFile,
    Reliability,
    Role,
    ServiceOrAction,
    Topic,
)
from interface_compiler import prefixes, shipped

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

#: Types of parameters: those of rcl_interfaces/msg/ParameterType.
PARAMETER_TYPES = {
    "bool": (bool,),
    "integer": (int,),
    "double": (float,),
    "string": (str,),
    **{f"{name}_array": (list,) for name in ("byte", "bool", "integer", "double", "string")},
}

#: A table for grading a class: grader/classroom/deadline.py reads it.
DEADLINE = "deadline"

#: The keys of exercise.toml, of its tables, and whether a table's key is required.
KEYS: dict[str, dict[str, bool]] = {
    "": dict.fromkeys(
        (
            *("title", "points", "file", "class", "node", "reference_node", "advice", "count_hints", "packages"),
            *("many_answers", "nodes"),
        ),
        False,
    ),
    **{
        direction: {
            "topic": True,
            "type": True,
            "depth": False,
            "reliability": False,
            "durability": False,
            "units": False,
            "elements": False,
        }
        for direction in ("subscribe", "publish")
    },
    **{role: {"name": True, "type": True, "units": False} for role in get_args(Role)},
    "parameter": {"name": True, "type": True, "default": False, "unit": False, "range": False},
    "program": {"file": True, "node": True, "class": False},
}

_FROM_HANDOUT = (
    "It comes with the handout. In the handout's folder: .venv/bin/pip install -r requirements.txt. "
    "If it is still missing then, send this message to your instructor."
)

_NAME = re.compile(r"[A-Za-z_][A-Za-z0-9_.]*")
_FULL_NAME = re.compile(r"(/[A-Za-z_][A-Za-z0-9_]*)+")
_PYTHON_FILE = re.compile(r"[a-z_][a-z0-9_]*\.py")


def read_toml(file: Path) -> dict[str, Any]:
    """Return what is in a TOML file of an author's. Raises `ExerciseError` if it is missing or can't be read."""
    try:
        entries: dict[str, Any] = tomllib.loads(file.read_text(encoding="utf-8-sig"))
        return entries
    except FileNotFoundError:
        raise ExerciseError(file, "there is no such file", "An exercise is a folder with an exercise.toml.") from None
    except (tomllib.TOMLDecodeError, UnicodeDecodeError) as error:
        place = re.search(r"at line (\d+)", str(error))
        line = int(place[1]) if place else None
        raise ExerciseError(file, f"it can't be read: {error}", "Write it as TOML, in UTF-8.", line) from None


@dataclass(frozen=True)
class TomlTable:
    """One table of exercise.toml: its `kind` such as "subscribe", its number among those of the kind, and its
    entries.
    """

    file: Path
    kind: str
    number: int
    entries: dict[str, Any]

    def fault(self, key: str, problem: str, fix: str) -> NoReturn:
        """Raise `ExerciseError` for the value of `key`, with its line."""
        raise ExerciseError(self.file, problem, fix, line_of(self.file, self.kind, self.number, key))

    def see_keys(self) -> None:
        """Raise `ExerciseError` for an unknown key, or for a missing one."""
        known = KEYS[self.kind]
        for key in self.entries:
            if key not in known and not (not self.kind and key in (*KEYS, DEADLINE)):
                allowed = sorted({*known, *(() if self.kind else (k for k in (*KEYS, DEADLINE) if k))})
                self.fault(key, f"the key {key!r} is not known {self._place}", f"Known are: {', '.join(allowed)}.")
        for key, needed in known.items():
            if needed and key not in self.entries:
                self.fault("", f"there is no {key} {self._place}", f'Add a line such as {key} = "…".')

    @property
    def _place(self) -> str:
        return f"in [[{self.kind}]]" if self.kind else "here"

    def text(self, key: str, default: str = "") -> str:
        """Return a text."""
        value = self.entries.get(key, default)
        if not isinstance(value, str):
            self.fault(key, f"{key} = {value!r}", f'Give {key} as a text, such as {key} = "…".')
        return value

    def one_of(self, key: str, choice: tuple[str, ...], default: str) -> Any:
        """Return one of some texts."""
        value = self.entries.get(key, default)
        if value not in choice:
            self.fault(key, f"{key} = {value!r}", f"Give one of: {', '.join(choice)}.")
        return value

    def name(self, key: str) -> str:
        """Return the full name of a topic, a service or an action."""
        value = self.text(key)
        if not _FULL_NAME.fullmatch(value):
            fix = f"Write the full name of the {self._what}, beginning with '/', in letters, digits and _."
            self.fault(key, f"{key} = {value!r}", fix)
        return value

    @property
    def _what(self) -> str:
        return {"client": "service", "action_client": "action"}.get(
            self.kind, "topic" if "topic" in KEYS[self.kind] else self.kind
        )

    def type(self, kind: str, example: str) -> str:
        """Return the type of an interface of this kind ("msg", "srv", "action"). It must be installed."""
        value = self.text("type")
        if not re.fullmatch(rf"[a-z][a-z0-9_]*/{kind}/[A-Z][A-Za-z0-9]*", value):
            self.fault("type", f"type = {value!r}", f"Write a type as {example!r}.")
        package, _, rest = value.partition("/")
        known = prefixes.interfaces_of(package, prefixes.installed())
        if not known:
            self.fault("type", f"type = {value!r}: the package {package} is not installed here", self._install(package))
        if rest not in known:
            fix = "Check its name. If the course has just defined it, run: spinbook build"
            self.fault("type", f"type = {value!r}: the package {package} has no {rest}", fix)
        return value

    def _install(self, package: str) -> str:
        if (self.file.parent / PUBLIC_FILE).exists():
            return _FROM_HANDOUT
        if remedy := shipped.how_to_add(package):
            return remedy
        return "If the course defines it, compile it: spinbook build. If not, install it, or check its name."

    def units(self) -> dict[str, str]:
        """Return the unit of each field."""
        return self.texts("units", '{ x = "m" }')

    def flag(self, key: str) -> bool:
        """Return true or false; false if it is not there."""
        value = self.entries.get(key, False)
        if not isinstance(value, bool):
            self.fault(key, f"{key} = {value!r}: it is not true or false", f"Write {key} = true.")
        return value

    def texts(self, key: str, example: str) -> dict[str, str]:
        """Return a table whose values are all texts."""
        value = self.entries.get(key, {})
        if not isinstance(value, dict) or not all(isinstance(text, str) for text in value.values()):
            self.fault(key, f"{key} = {value!r}", f"Give a table of texts, such as {key} = {example}.")
        return value


def tables(entries: dict[str, Any], kind: str, file: Path) -> list[TomlTable]:
    """Return every `[[kind]]`, with its keys checked."""
    items = entries.get(kind, [])
    if not isinstance(items, list) or not all(isinstance(item, dict) for item in items):
        raise ExerciseError(file, f"{kind} is not a list of tables", f"Write [[{kind}]] above each.")
    all_tables = [TomlTable(file, kind, number, item) for number, item in enumerate(items)]
    for table in all_tables:
        table.see_keys()
    _see_names(all_tables)
    return all_tables


def _see_names(all_tables: list[TomlTable]) -> None:
    """Raise `ExerciseError` if two tables of a kind are about the same thing."""
    names: list[Any] = []
    for table in all_tables:
        key = next(one for one in ("topic", "name", "file") if one in KEYS[table.kind])
        if table.entries[key] in names:
            table.fault(key, f"there are two [[{table.kind}]] for {table.entries[key]!r}", "Leave one of them out.")
        names.append(table.entries[key])


def topics(entries: dict[str, Any], file: Path) -> tuple[Topic, ...]:
    """Return the topics that the program subscribes to and publishes."""
    return tuple(_topic(table) for direction in ("subscribe", "publish") for table in tables(entries, direction, file))


def _topic(table: TomlTable) -> Topic:
    depth = table.entries.get("depth", 10)
    if isinstance(depth, bool) or not isinstance(depth, int) or depth < 1:
        table.fault("depth", f"depth = {depth!r}", "Give a whole number of messages, such as depth = 10.")
    return Topic(
        table.name("topic"),
        table.type("msg", "sensor_msgs/msg/JointState"),
        table.kind,  # type: ignore[arg-type]  # "subscribe" or "publish"
        depth,
        table.units(),
        table.one_of("reliability", get_args(Reliability), "reliable"),
        table.one_of("durability", get_args(Durability), "volatile"),
        _elements(table),
    )


def _elements(table: TomlTable) -> Elements | None:
    value = table.entries.get("elements")
    if value is None:
        return None
    if not isinstance(value, dict) or set(value) != {"called", "named_by"}:
        table.fault("elements", f"elements = {value!r}", 'Write elements = { called = "wheel", named_by = "name" }.')
    return Elements(str(value["called"]), str(value["named_by"]))


def endpoints(entries: dict[str, Any], file: Path) -> tuple[ServiceOrAction, ...]:
    """Return the services and actions that the program serves or calls."""
    declared = []
    for role in get_args(Role):
        kind, example = ("action", "example_interfaces/action/Fibonacci"), ("srv", "std_srvs/srv/SetBool")
        interface = kind if role.startswith("action") else example
        for table in tables(entries, role, file):
            declared.append(ServiceOrAction(table.name("name"), table.type(*interface), role, table.units()))
    return tuple(declared)


def parameters(entries: dict[str, Any], file: Path) -> tuple[Parameter, ...]:
    """Return the parameters of the program's node."""
    return tuple(_parameter(table) for table in tables(entries, "parameter", file))


def _parameter(table: TomlTable) -> Parameter:
    name, kind = table.text("name"), table.one_of("type", tuple(PARAMETER_TYPES), "")
    if not _NAME.fullmatch(name):
        table.fault("name", f"name = {name!r}", "Write the parameter's name, such as max_speed.")
    default = table.entries.get("default")
    if default is not None and type(default) not in PARAMETER_TYPES[kind]:
        problem = f"default = {default!r}, but the parameter {name} is of type {kind}"
        table.fault("default", problem, "Write the default as that type, such as 1.0 for a double.")
    limits = table.entries.get("range")
    if limits is not None and not _is_range(limits):
        table.fault("range", f"range = {limits!r}", "Give the lowest and the highest value: range = [0.0, 10.0].")
    return Parameter(name, kind, default, table.text("unit"), (limits[0], limits[1]) if limits else None)


def _is_range(limits: Any) -> bool:
    is_pair = isinstance(limits, list) and len(limits) == 2
    return is_pair and all(isinstance(limit, (int, float)) for limit in limits) and limits[0] <= limits[1]


def programs(entries: dict[str, Any], file: Path) -> tuple[ProgramFile, ...]:
    """Return the files of a submission with several programs."""
    declared = []
    for table in tables(entries, "program", file):
        name = table.text("file")
        if not _PYTHON_FILE.fullmatch(name):
            table.fault("file", f"file = {name!r}", "Give a Python file name, such as 'leader.py'.")
        declared.append(ProgramFile(name, table.text("node"), table.text("class")))
    return tuple(declared)


def nodes(top: TomlTable, several: bool) -> tuple[str, ...]:
    """Return the nodes that a launch file must start; empty if the submission is not a launch file.

    `several` is whether there are tables of programs.
    """
    names = top.entries.get("nodes", [])
    if not isinstance(names, list) or not all(isinstance(name, str) and name.startswith("/") for name in names):
        top.fault(
            "nodes", f"nodes = {names!r}", 'Give a list of full names, such as nodes = ["/left/arm", "/right/arm"].'
        )
    if names and (several or "node" in top.entries or "class" in top.entries):
        fix = "With `nodes`, the submission is a launch file, which starts the programs: leave the others out."
        top.fault("nodes", "nodes is given next to node, class or [[program]]", fix)
    return tuple(names)


def packages(top: TomlTable) -> tuple[str, ...]:
    """Return the packages that programs may use, each with the version that is installed here."""
    names = top.entries.get("packages", [])
    if not isinstance(names, list) or not all(isinstance(name, str) for name in names):
        top.fault("packages", f"packages = {names!r}", 'Give a list of texts, such as packages = ["scipy"].')
    return tuple(_pinned(top, name) for name in names)


def _pinned(top: TomlTable, text: str) -> str:
    from importlib import metadata  # it takes long

    from packaging.requirements import InvalidRequirement, Requirement  # a web page does not have it

    package = None
    with contextlib.suppress(InvalidRequirement):
        package = Requirement(text)
    if package is None or package.url or package.marker or [s.operator for s in package.specifier] not in ([], ["=="]):
        fix = 'Write a name on PyPI, such as "scipy" or "scipy==1.16.3".'
        top.fault("packages", f"packages has {text!r}", fix)
    remedy = _FROM_HANDOUT if (top.file.parent / PUBLIC_FILE).exists() else f"Install it: pip install {text}"
    try:
        version = metadata.version(package.name)
    except metadata.PackageNotFoundError:
        top.fault("packages", f"the package {package.name}, which programs may use, is not installed here", remedy)
    if version not in package.specifier:
        top.fault("packages", f"{package.name} is installed in version {version}, not as {text}", remedy)
    return f"{package.name}=={version}"


def line_of(file: Path, kind: str, number: int, key: str) -> int | None:
    """Return the line of `key` in table `number` (from 0) of this kind.

    Without a key, or if the key is missing, return the line of the table's header. A key at the top may itself be a
    table.
    """
    header: int | None = None
    here, count = "", -1
    for index, line in enumerate(file.read_text(encoding="utf-8-sig").splitlines(), start=1):
        if match := re.match(r"\s*\[\[?\s*([A-Za-z_]+)", line):
            here = match[1]
            if not kind and here == key:
                return index
            count += here == kind
            if here == kind and count == number:
                header = index
        elif here == kind and (not kind or count == number) and key and re.match(rf'\s*"?{re.escape(key)}"?\s*=', line):
            return index
    return header
