"""`ros2`: the nouns, and what happens around every verb."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click

from interface_compiler.near import use_near
from ros_in_python.ros2 import cli
from ros_in_python.ros2.cli import Menu, MenuEntry
from ros_in_python.ros2.executables import hand_over

NOUNS = {
    "action": MenuEntry("ros_in_python.ros2.action:action", "List actions, send a goal to one."),
    "bag": MenuEntry("ros_in_python.ros2.bag:bag", "Record topics into a file, play them again."),
    "daemon": MenuEntry("ros_in_python.ros2.command:daemon", "Say that there is no daemon."),
    "interface": MenuEntry(
        "ros_in_python.ros2.interfaces:interface", "Show what messages, services and actions contain."
    ),
    "launch": MenuEntry("ros_in_python.launch.command:launch", "Start the nodes of a launch file."),
    "lifecycle": MenuEntry(
        "ros_in_python.ros2.lifecycle:lifecycle", "Look at nodes with a life cycle, change their state."
    ),
    "multicast": MenuEntry("ros_in_python.ros2.multicast:multicast", "Try whether multicast gets through."),
    "node": MenuEntry("ros_in_python.ros2.node:node", "List running nodes, show what one offers."),
    "param": MenuEntry("ros_in_python.ros2.param:param", "Read and change parameters of running nodes."),
    "pkg": MenuEntry("ros_in_python.ros2.pkg:pkg", "List packages and their executables, make a package."),
    "run": MenuEntry("ros_in_python.ros2.executables:run", "Start an executable of a package."),
    "service": MenuEntry("ros_in_python.ros2.service:service", "List services, call one."),
    "topic": MenuEntry("ros_in_python.ros2.topic:topic", "Watch, measure and publish topics."),
}


class Ros2(Menu):
    """The whole command: hands over to the real one where it is installed, and ends quietly on a signal."""

    def parse_args(self, ctx: click.Context, args: list[str]) -> list[str]:
        if not ctx.resilient_parsing:
            hand_over(args)
            # A course's own types are known in its folder; nothing has to be sourced.
            use_near(Path.cwd())
        if not args or args[0] not in NOUNS:
            self.entries = {**NOUNS, **_nouns_of_others()}
        return super().parse_args(ctx, args)

    def invoke(self, ctx: click.Context) -> Any:
        cli.listen()
        try:
            return super().invoke(ctx)
        except BaseException as error:
            if (code := cli.exit_code_of(error)) is None:
                raise
            raise click.exceptions.Exit(code) from None


#: The entry points by which another installed distribution adds a noun: NAME = "module:click_command".
GROUP = "ros_in_python.nouns"


def _nouns_of_others() -> dict[str, MenuEntry]:
    from importlib.metadata import entry_points  # takes long, and only other nouns than ours need it

    found = entry_points(group=GROUP)
    return {entry.name: MenuEntry(entry.value, entry.load().get_short_help_str(100)) for entry in found}


ros2 = Ros2(
    name="ros2",
    entries=NOUNS,
    help="""Look at running ROS 2 nodes and talk to them; works without a ROS installation.

    Start a node, and in another terminal:

    \b
      ros2 node list                       which nodes run
      ros2 topic list -t                   the topics, with their types
      ros2 topic hz /joint_commands        how many messages per second
      ros2 topic echo /joint_commands      what is in them (Ctrl-C ends it)
      ros2 interface show sensor_msgs/msg/JointState

    Where a ROS 2 installation provides `ros2`, that one answers. ROS_IN_PYTHON=own prevents it.
    """,
)


daemon = Menu(
    name="daemon",
    help="""The ROS 2 installation's ros2 keeps a daemon that remembers the graph. Here each call looks for itself.

    \b
      ros2 daemon status
    """,
)


def _add_daemon_verb(name: str, help_line: str, answer: str) -> None:
    @daemon.command(name=name, help=f"{help_line}\n\n\b\n  ros2 daemon {name}")
    def verb() -> None:
        click.echo(f"{answer} (none is needed: each command looks at the graph itself, so there is nothing to restart)")


_add_daemon_verb("status", "Say that none is running.", "The daemon is not running")
_add_daemon_verb("start", "Say that none is needed.", "The daemon has not been started")
_add_daemon_verb("stop", "Say that none is running.", "The daemon is not running")
