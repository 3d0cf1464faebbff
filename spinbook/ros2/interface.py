"""`ros2 interface`: the types, from the files that their packages installed. Needs no running node."""

from __future__ import annotations

import sys

import click

from spinbook.ros2 import interfaces
from spinbook.ros2 import interfaces as interface_files
from spinbook.ros2.cli import CONTEXT, CommandError, Entry, Menu

interface = Menu(
    name="interface",
    entries={
        "list": Entry("spinbook.ros2.interface:list_", "Every type installed here."),
        "package": Entry("spinbook.ros2.interface:package", "The types of one package."),
        "packages": Entry("spinbook.ros2.interface:packages", "The packages that have types."),
        "proto": Entry("spinbook.ros2.interface:proto", "A type's fields with their defaults, to copy into pub."),
        "show": Entry("spinbook.ros2.interface:show", "The definition of a type."),
    },
    help="""Show the fields of message, service and action types.

    \b
      ros2 interface show sensor_msgs/msg/JointState
      ros2 interface proto geometry_msgs/msg/Twist
    """,
)

_TITLES = {"msg": "Messages", "srv": "Services", "action": "Actions"}


def _kinds(only_msgs: bool, only_srvs: bool, only_actions: bool) -> list[str]:
    chosen = [kind for kind, wanted in zip(_TITLES, (only_msgs, only_srvs, only_actions), strict=True) if wanted]
    return chosen or list(_TITLES)


_only_msgs = click.option("-m", "--only-msgs", is_flag=True, help="Messages.")
_only_srvs = click.option("-s", "--only-srvs", is_flag=True, help="Services.")
_only_actions = click.option("-a", "--only-actions", is_flag=True, help="Actions.")


@click.command(context_settings=CONTEXT)
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
    for line in interface_files.unfold(full, comments=not no_comments, nested_comments=all_comments):
        click.echo(line)


@click.command(name="list", context_settings=CONTEXT)
@_only_msgs
@_only_srvs
@_only_actions
def list_(only_msgs: bool, only_srvs: bool, only_actions: bool) -> None:
    """Every type installed here.

    \b
      ros2 interface list -a
      Actions:
          test_msgs/action/Fibonacci
    """
    everything = interface_files.installed_interfaces()
    for kind in _kinds(only_msgs, only_srvs, only_actions):
        click.echo(f"{_TITLES[kind]}:")
        for package_name, names in everything.items():
            for name in names:
                if name.startswith(f"{kind}/"):
                    click.echo(f"    {package_name}/{name}")


@click.command(context_settings=CONTEXT)
@click.argument("package_name")
@_only_msgs
@_only_srvs
@_only_actions
def package(package_name: str, only_msgs: bool, only_srvs: bool, only_actions: bool) -> None:
    """The types of one package.

    \b
      ros2 interface package std_srvs
    """
    names = interface_files.interfaces_of(package_name)
    if names is None:
        raise CommandError(
            f"Unknown package '{package_name}'", "`ros2 interface packages` shows those that have types."
        )
    kinds = _kinds(only_msgs, only_srvs, only_actions)
    for name in names:
        if name.split("/")[0] in kinds:
            click.echo(f"{package_name}/{name}")


@click.command(context_settings=CONTEXT)
@_only_msgs
@_only_srvs
@_only_actions
def packages(only_msgs: bool, only_srvs: bool, only_actions: bool) -> None:
    """The packages that have types.

    \b
      ros2 interface packages -a
    """
    kinds = _kinds(only_msgs, only_srvs, only_actions)
    for package_name, names in interface_files.installed_interfaces().items():
        if any(name.split("/")[0] in kinds for name in names):
            click.echo(package_name)


@click.command(context_settings=CONTEXT)
@click.argument("type_name", metavar="TYPE")
@click.option("--no-quotes", is_flag=True, help="Without the quotes around it.")
def proto(type_name: str, no_quotes: bool) -> None:
    """A type's fields with their defaults: a message's, a service's request's, or an action's goal's.

    \b
      ros2 interface proto geometry_msgs/msg/Twist
    """
    from spinbook.ros2.message_text import to_yaml

    kind = interfaces.interface_class(_full(type_name))
    filled_in = getattr(kind, "Goal", None) or getattr(kind, "Request", None) or kind
    text = to_yaml(filled_in())
    click.echo(text if no_quotes else f'"{text}"')


def _full(type_name: str) -> str:
    """The full name of an installed type. Raises `CommandError` for any other."""
    parts = type_name.split("/")
    if len(parts) != 3 or parts[1] not in _TITLES or not all(parts):
        raise CommandError(
            f"Invalid name '{type_name}'. Expected three parts separated by '/'",
            "As in sensor_msgs/msg/JointState, std_srvs/srv/Trigger or test_msgs/action/Fibonacci.",
        )
    interfaces.check_installed(type_name)
    return type_name
