"""Interface types by name, and `ros2 interface`, which shows them."""

from __future__ import annotations

import difflib
import functools
import importlib
import re
import sys
from collections.abc import Iterator
from pathlib import Path
from typing import Any, Literal, cast

import click

from interface_compiler import prefixes, shipped
from ros_in_python.ros2.cli import CommandError, F, Menu

_PRIMITIVE = re.compile(r"(bool|byte|char|float32|float64|u?int(8|16|32|64)|w?string(<=\d+)?)$")
_ARRAY = re.compile(r"\[(<=)?\d*\]$")
_SEPARATOR = "---"


def installed_interfaces() -> dict[str, list[str]]:
    """Return package -> its interfaces as `msg/String`, sorted, for every installed package that has any."""
    everything = prefixes.interfaces(prefixes.installed())
    return {package: sorted(names) for package, names in sorted(everything.items())}


def folder_of(package: str) -> Path:
    """Return the folder of an installed package's shared files."""
    prefix = prefixes.prefix_of(package, prefixes.installed())
    assert prefix is not None
    return prefix / "share" / package


def unfold(interface: str, *, comments: bool, nested_comments: bool, depth: int = 0) -> Iterator[str]:
    """Yield the lines of an interface's file, each field of a message type followed by that type's lines, indented by a
    tab per level.

    Comments and blank lines are those of the file itself, of nested files only with `nested_comments`.
    `interface` is `PACKAGE/KIND/NAME` of an installed type.
    """
    package, kind, name = interface.split("/")
    text = (folder_of(package) / kind / f"{name}.{kind}").read_text()
    for line in text.splitlines():
        raw = line.rstrip()
        shown = raw if comments else _without_comment(raw)
        if shown or comments:
            yield "\t" * depth + shown if shown else ""
        nested = _nested_type(raw, package)
        if nested is not None:
            yield from unfold(nested, comments=nested_comments, nested_comments=nested_comments, depth=depth + 1)


def _nested_type(line: str, package: str) -> str | None:
    """Return the message type of the field in this line, in full; None if it is a primitive or there is no field."""
    words = _without_comment(line).split()
    if len(words) < 2 or line == _SEPARATOR:
        return None
    base = _ARRAY.sub("", words[0])
    if _PRIMITIVE.match(base) or base == _SEPARATOR:
        return None
    owner, _, name = base.rpartition("/")
    return f"{(owner or package).split('/')[0]}/msg/{name}"


#: A line up to its comment; a '#' in a quoted default does not begin one.
_CODE = re.compile(r"""(?:[^#"']|"[^"]*"?|'[^']*'?)*""")


def _without_comment(line: str) -> str:
    code = _CODE.match(line)
    return code[0].strip() if code else ""


Kind = Literal["msg", "srv", "action"]

#: The end of the name of a feedback topic's type.
_FEEDBACK = "_FeedbackMessage"

KINDS: dict[Kind, str] = {"msg": "message", "srv": "service", "action": "action"}


def message_class(name: str) -> Any:
    """Return the class of a message type. Raises `CommandError` if no such type is installed here.

    An action's feedback topic has a type of its own, such as `turtlesim/action/RotateAbsolute_FeedbackMessage`.
    """
    action, is_feedback, _ = name.partition(_FEEDBACK)
    return action_class(action).Impl.FeedbackMessage if is_feedback else _load(name, "msg")


def service_class(name: str) -> Any:
    """Return the class of a service type, with `Request` and `Response`. Raises as `message_class` does."""
    return _load(name, "srv")


def action_class(name: str) -> Any:
    """Return the class of an action type, with `Goal`, `Result` and `Feedback`. Raises as `message_class` does."""
    return _load(name, "action")


def interface_class(name: str) -> Any:
    """Return the class of a message, service or action type, by its name with the middle part."""
    parts = name.split("/")
    if len(parts) != 3 or parts[1] not in KINDS:
        raise CommandError(
            f"The passed type '{name}' is invalid",
            "Expected PACKAGE/msg/NAME, PACKAGE/srv/NAME or PACKAGE/action/NAME.",
        )
    return _load(name, parts[1])


def _load(name: str, kind: Kind) -> Any:
    full = full_name(name, kind)
    package, _, short = full.split("/")
    check_installed(full)
    try:
        return getattr(importlib.import_module(f"{package}.{kind}"), short)
    except (ImportError, AttributeError) as error:
        raise CommandError(
            f"The type '{full}' has no Python code in this environment: {error}",
            f"Its package was found in {folder_of(package)}, built for another Python perhaps.",
        ) from None


def full_name(name: str, kind: Kind) -> str:
    """Return `std_msgs/msg/String` for `std_msgs/String`. Raises `CommandError` for what can't be a type's name."""
    parts = name.split("/")
    if len(parts) == 2:
        parts.insert(1, kind)
    if len(parts) != 3 or parts[1] != kind or not all(parts):
        raise CommandError(
            f"The passed {KINDS[kind]} type is invalid: '{name}'",
            f"Expected PACKAGE/{kind}/NAME. `ros2 interface list` shows what is installed.",
        )
    return "/".join(parts)


def check_installed(full: str) -> None:
    """Raise `CommandError` if the type `PACKAGE/KIND/NAME` is not installed, with how to get it or similar names."""
    package, kind, short = full.split("/")
    known = prefixes.interfaces_of(package, prefixes.installed())
    if f"{kind}/{short}" in known:
        return
    if known:
        raise CommandError(f"The package '{package}' has no type '{kind}/{short}'.", _alike(full))
    advice = shipped.how_to_add(package) or _alike(full)
    raise CommandError(f"Unknown package '{package}': the type '{full}' is not installed here.", advice)


def _alike(full: str) -> str:
    everything = [f"{package}/{name}" for package, names in installed_interfaces().items() for name in names]
    short = full.rpartition("/")[2]
    alike = [name for name in everything if name.rpartition("/")[2].lower() == short.lower()]
    alike += difflib.get_close_matches(full, everything, n=3, cutoff=0.85)
    if alike:
        return f"Did you mean {' or '.join(list(dict.fromkeys(alike))[:3])}?"
    return "`ros2 interface list` shows what is installed."


interface = Menu(
    name="interface",
    help="""Show the fields of message, service and action types.

    \b
      ros2 interface show sensor_msgs/msg/JointState
      ros2 interface proto geometry_msgs/msg/Twist
    """,
)

_TITLES = {"msg": "Messages", "srv": "Services", "action": "Actions"}


def _with_kinds(command: F) -> F:
    """Give a command `kinds`: those that its options name, or all."""

    @click.option("-m", "--only-msgs", "msg", is_flag=True, help="Messages.")
    @click.option("-s", "--only-srvs", "srv", is_flag=True, help="Services.")
    @click.option("-a", "--only-actions", "action", is_flag=True, help="Actions.")
    @functools.wraps(command)
    def run(**named: Any) -> Any:
        chosen = [kind for kind in _TITLES if named.pop(kind)]
        return command(kinds=chosen or list(_TITLES), **named)

    return cast("F", run)


@interface.command()
@click.argument("type_name", metavar="TYPE")
@click.option("--all-comments", is_flag=True, help="Comments of nested types too.")
@click.option("--no-comments", is_flag=True, help="No comments and no blank lines.")
def show(type_name: str, all_comments: bool, no_comments: bool) -> None:
    """The definition of a type; `-` reads its name from standard input.

    \b
      ros2 interface show geometry_msgs/msg/Twist
      ros2 topic type /joint_commands | ros2 interface show -
    """
    if all_comments and no_comments:
        raise click.UsageError("--all-comments and --no-comments exclude each other")
    if type_name == "-":
        type_name = sys.stdin.readline().strip()
    full = _full(type_name)
    for line in unfold(full, comments=not no_comments, nested_comments=all_comments):
        click.echo(line)


@interface.command(name="list")
@_with_kinds
def list_(kinds: list[str]) -> None:
    """Every type installed here.

    \b
      ros2 interface list -a
      Actions:
          test_msgs/action/Fibonacci
    """
    everything = installed_interfaces()
    for kind in kinds:
        click.echo(f"{_TITLES[kind]}:")
        for package_name, names in everything.items():
            for name in names:
                if name.startswith(f"{kind}/"):
                    click.echo(f"    {package_name}/{name}")


@interface.command()
@click.argument("package_name")
@_with_kinds
def package(package_name: str, kinds: list[str]) -> None:
    """The types of one package.

    \b
      ros2 interface package std_srvs
    """
    names = sorted(prefixes.interfaces_of(package_name, prefixes.installed()))
    if not names:
        advice = shipped.how_to_add(package_name) or "`ros2 interface packages` shows those that have types."
        raise CommandError(f"Unknown package '{package_name}'", advice)
    for name in names:
        if name.split("/")[0] in kinds:
            click.echo(f"{package_name}/{name}")


@interface.command()
@_with_kinds
def packages(kinds: list[str]) -> None:
    """The packages that have types.

    \b
      ros2 interface packages -a
    """
    for package_name, names in installed_interfaces().items():
        if any(name.split("/")[0] in kinds for name in names):
            click.echo(package_name)


@interface.command()
@click.argument("type_name", metavar="TYPE")
@click.option("--no-quotes", is_flag=True, help="Without the quotes around it.")
def proto(type_name: str, no_quotes: bool) -> None:
    """A type's fields with their defaults: a message's, a service's request's, or an action's goal's.

    \b
      ros2 interface proto geometry_msgs/msg/Twist
    """
    from ros_in_python.ros2.messages import to_yaml

    kind = interface_class(_full(type_name))
    filled_in = getattr(kind, "Goal", None) or getattr(kind, "Request", None) or kind
    text = to_yaml(filled_in())
    click.echo(text if no_quotes else f'"{text}"')


def _full(type_name: str) -> str:
    """Return the full name of an installed type. Raises `CommandError` for any other."""
    parts = type_name.split("/")
    if len(parts) != 3 or parts[1] not in _TITLES or not all(parts):
        raise CommandError(
            f"Invalid name '{type_name}'. Expected three parts separated by '/'",
            "As in sensor_msgs/msg/JointState, std_srvs/srv/Trigger or test_msgs/action/Fibonacci.",
        )
    check_installed(type_name)
    return type_name
