"""Topics, services, actions and nodes by name: waiting for one, and what the verbs that list them have in common."""

from __future__ import annotations

from collections.abc import Callable, Iterable
from typing import TYPE_CHECKING

import click

from ros_in_python.ros2.cli import CommandError, F, show_names
from ros_in_python.ros2.names import absolute, absolute_node, seen

if TYPE_CHECKING:
    from ros_in_python.ros2.graph import GraphView, TypedName

show_types_option = click.option("-t", "--show-types", is_flag=True, help="Show each one's type too.")


def listing_options(noun: str) -> Callable[[F], F]:
    """Add the options of a verb that lists names: the function gets `only_count` and `include_hidden`."""

    def add(command: F) -> F:
        count = click.option("-c", f"--count-{noun}s", "only_count", is_flag=True, help="Print only the number.")
        text = "Hidden ones too (an underscore before a part of the name)."
        hidden = click.option("-a", f"--include-hidden-{noun}s", "include_hidden", is_flag=True, help=text)
        return count(hidden(command))

    return add


def show(names: Iterable[TypedName], *, show_types: bool, only_count: bool, include_hidden: bool = True) -> None:
    """Print topics, services or actions, one per line, or only how many there are."""
    shown = [name for name in names if include_hidden or not name.hidden]
    show_names([str(name) if show_types else name.name for name in shown], only_count)


def show_of_type(
    graph: GraphView, look: Callable[[], list[TypedName]], type_name: str, only_count: bool, include_hidden: bool
) -> None:
    """Print those that have this type, once there is one; `look` is a method of `graph`."""
    graph.settle(lambda: any(type_name in name.types for name in look()))
    of_type = [name for name in look() if type_name in name.types]
    show(of_type, show_types=False, only_count=only_count, include_hidden=include_hidden)


def existing(graph: GraphView, look: Callable[[], list[TypedName]], noun: str, written: str) -> TypedName:
    """Return the topic, service or action (`noun`) of this name, once it exists; `look` is a method of `graph`.

    Raises `CommandError`, with those that there are, if it does not.
    """
    name = absolute(written, noun)
    graph.settle(lambda: any(each.name == name for each in look()))
    names = look()
    if match := next((each for each in names if each.name == name), None):
        return match
    others = (each.name for each in names if not each.hidden)
    raise CommandError(f"Unknown {noun} '{written}'", seen(f"{noun.title()}s", others))


def existing_node(graph: GraphView, look: Callable[[], list[str]], written: str, what: str = "Nodes") -> str:
    """Return the full name of a node, once `look` finds it. Raises `CommandError`, with those that it finds."""
    full = absolute_node(written)
    graph.settle(lambda: full in look())
    names = look()
    if full not in names:
        raise CommandError("Node not found", seen(what, names))
    return full
