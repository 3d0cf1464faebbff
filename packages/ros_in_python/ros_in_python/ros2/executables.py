"""Finds what `ros2 run` starts: in ROS prefixes, in colcon workspaces nearby, and in this package itself."""

from __future__ import annotations

import os
import shlex
import shutil
import signal
import sys
from collections.abc import Iterator, Mapping, MutableMapping, Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from pathlib import Path

import click

from interface_compiler import prefixes
from ros_in_python.example_robots import EXAMPLES
from ros_in_python.ros2.cli import CommandError
from ros_in_python.ros2.opening import check_installed

# The wheels' `.pth` file re-executes Python once with the wheels' libraries in LD_LIBRARY_PATH, and marks that with a
# guard variable. Another Python that inherits the guard skips its own turn and then misses its libraries; a program of
# a ROS installation that inherits the libraries gets the wrong ones. So neither is passed on to them. A program of
# this very Python keeps both: done again, the wheels' turn puts the folders in an order that depends on their names,
# and a middleware that came first in LD_LIBRARY_PATH may come after Fast DDS.


GUARD = "_ROS_WHEELS_BOOTSTRAP_COMPLETE"


def without_bootstrap(environment: Mapping[str, str]) -> dict[str, str]:
    """Return a copy of `environment` as it was before this Python's wheels changed it."""
    clean = dict(environment)
    if clean.pop(GUARD, None) is None:
        return clean
    entries = [entry for entry in clean.pop("LD_LIBRARY_PATH", "").split(os.pathsep) if entry]
    kept = [entry for entry in entries if not _from_wheels(Path(entry))]
    if kept:
        clean["LD_LIBRARY_PATH"] = os.pathsep.join(kept)
    return clean


def _from_wheels(folder: Path) -> bool:
    prefix = Path(sys.prefix)
    return folder == prefix / "lib" or (folder.is_relative_to(prefix) and folder.match("ros_*.libs"))


_LAYOUT = ".colcon_install_layout"


@dataclass(frozen=True)
class Workspace:
    """A built colcon workspace: its `install` folder and the prefixes in it (one, or one per package)."""

    install: Path
    prefixes: tuple[Path, ...]

    def extend(self, environment: MutableMapping[str, str]) -> None:
        """Change `environment` as sourcing `install/setup.bash` would, as far as its packages' .dsv files say it."""
        for prefix in reversed(self.prefixes):
            _prepend(environment, "AMENT_PREFIX_PATH", str(prefix))
            for package in sorted((prefix / "share").glob("*/package.dsv")):
                _apply(package, prefix, environment)
            for site in sorted(prefix.glob(f"lib/python{sys.version_info.major}.*/site-packages")):
                if site.parent.name == f"python{sys.version_info.major}.{sys.version_info.minor}":
                    _append(environment, "PYTHONPATH", str(site))


def workspaces_near(folder: Path) -> list[Workspace]:
    """Return the built workspaces of `folder` and its parents, nearest first.

    In each of them, that is the folder itself, then the folders in it that are named as workspaces are: `ros2_ws`.
    """
    folder = folder.absolute()
    places = (place for at in (folder, *folder.parents) for place in (at, *sorted(at.glob("*_ws"))))
    return [workspace for workspace in (_built(place / "install") for place in places) if workspace is not None]


def _built(install: Path) -> Workspace | None:
    try:
        layout = (install / _LAYOUT).read_text().strip()
    except OSError:
        return None
    if layout == "merged":
        return Workspace(install, (install,))
    prefixes = (folder for folder in install.iterdir() if (folder / "share" / folder.name).is_dir())
    return Workspace(install, tuple(sorted(prefixes)))


# The .dsv format is colcon's: an operation and its arguments in a line, divided by ';'.
# https://colcon.readthedocs.io/en/released/developer/environment.html


def _apply(file: Path, prefix: Path, environment: MutableMapping[str, str]) -> None:
    for operation, arguments in _operations(file):
        if operation == "source" and arguments[0].endswith(".dsv"):
            _apply(prefix / arguments[0], prefix, environment)
        elif operation in ("set", "set-if-unset") and len(arguments) == 2:
            if operation == "set" or arguments[0] not in environment:
                environment[arguments[0]] = arguments[1]
        elif operation.startswith("prepend-non-duplicate"):
            for value in _existing(operation, arguments[1:], prefix):
                _prepend(environment, arguments[0], value)
        elif operation.startswith("append-non-duplicate"):
            for value in _existing(operation, arguments[1:], prefix):
                _append(environment, arguments[0], value)


def _operations(file: Path) -> Iterator[tuple[str, list[str]]]:
    try:
        lines = file.read_text().splitlines()
    except OSError:
        return
    for line in lines:
        operation, *arguments = line.split(";")
        if arguments:
            yield operation, arguments


def _existing(operation: str, values: list[str], prefix: Path) -> list[str]:
    """Return the values as paths, relative ones below the prefix; only existing ones if the operation says so."""
    paths = [prefix / value if value else prefix for value in values or [""]]
    return [str(path) for path in paths if path.exists() or not operation.endswith("-if-exists")]


def _prepend(environment: MutableMapping[str, str], name: str, value: str) -> None:
    entries = [entry for entry in environment.get(name, "").split(os.pathsep) if entry and entry != value]
    environment[name] = os.pathsep.join([value, *entries])


def _append(environment: MutableMapping[str, str], name: str, value: str) -> None:
    entries = [entry for entry in environment.get(name, "").split(os.pathsep) if entry]
    if value not in entries:
        environment[name] = os.pathsep.join([*entries, value])


def add_own_prefix(environment: MutableMapping[str, str]) -> None:
    """Let programs find the packages of this Python's environment, too: `get_package_share_directory('std_msgs')`.

    They also know which ROS 2 it is, as after sourcing one.
    """
    if (Path(sys.prefix) / prefixes.RESOURCES).is_dir():
        _append(environment, "AMENT_PREFIX_PATH", sys.prefix)
    _append(environment, "AMENT_PREFIX_PATH", str(EXAMPLES))
    for name, value in {"ROS_DISTRO": "jazzy", "ROS_VERSION": "2", "ROS_PYTHON_VERSION": "3"}.items():
        environment.setdefault(name, value)


_DEMOS = ("add_two_ints_client", "add_two_ints_server", "listener", "talker")
#: Package -> executable -> its module and the arguments of that. Used if the installed package has no executables:
#: of turtlesim, only the messages are compiled, and of the demo nodes, PyPI has nothing.
BUILT_IN = {
    "demo_nodes_cpp": {name: f"ros_in_python.demo_nodes cpp {name}" for name in _DEMOS},
    "demo_nodes_py": {name: f"ros_in_python.demo_nodes py {name}" for name in _DEMOS},
    "joint_state_publisher": {"joint_state_publisher": "ros_in_python.robot.joint_state_publisher"},
    "robot_state_publisher": {"robot_state_publisher": "ros_in_python.robot.state_publisher"},
    "tf2_ros": {
        name: f"ros_in_python.tf2_tools.{name}" for name in ("static_transform_publisher", "tf2_echo", "tf2_monitor")
    },
    "tf2_tools": {"view_frames": "ros_in_python.tf2_tools.view_frames"},
    "turtlesim": {
        "draw_square": "ros_in_python.turtlesim.draw_square",
        "mimic": "ros_in_python.turtlesim.mimic",
        "turtle_teleop_key": "ros_in_python.turtlesim.teleop_key",
        "turtlesim_node": "ros_in_python.turtlesim.node",
    },
}


#: The interfaces that our executables of a package need.
_INTERFACES = {**dict.fromkeys(("robot_state_publisher", "tf2_ros", "tf2_tools"), "tf2_msgs"), "turtlesim": "turtlesim"}


def interfaces_used(package: str, executable: str) -> str:
    """Return the package of interfaces that an executable of ours needs; "" if it needs none."""
    needs_example = package.startswith("demo_nodes") and "two_ints" in executable
    return "example_interfaces" if needs_example else _INTERFACES.get(package, "")


@dataclass(frozen=True)
class Invocation:
    """How to start an executable: the command (append the arguments for the node) and its whole environment."""

    argv: list[str]
    env: dict[str, str]


def find(package: str, executable: str, cwd: Path) -> Invocation:
    """Return how to start a package's executable from the folder `cwd`.

    This searches the prefixes of AMENT_PREFIX_PATH and of this Python, the colcon workspaces of `cwd` and its parents,
    and our own executables, in this order. A workspace need not be sourced: the environment is the one that its setup
    scripts would make. Raises `CommandError`, with what there is, if the package or the executable does not exist.
    """
    environment = dict(os.environ)
    prefix = prefixes.prefix_of(package, prefixes.installed())
    if prefix is None:
        for near in workspaces_near(cwd):
            prefix = prefixes.prefix_of(package, near.prefixes)
            if prefix is not None:
                near.extend(environment)
                break
    add_own_prefix(environment)
    there = in_prefix(prefix, package) if prefix is not None else []
    if there or (prefix is not None and package not in BUILT_IN):
        program = _only(there, package, executable)
        is_ours = _is_of_this_python(program)
        return Invocation([str(program)], environment if is_ours else without_bootstrap(environment))
    modules = BUILT_IN.get(package)
    if modules is None:
        raise CommandError(
            f"Package '{package}' not found", _where(cwd), f"Packages to run from here: {', '.join(runnable(cwd))}."
        )
    if executable not in modules:
        raise CommandError("No executable found", f"Executables of {package}: {', '.join(sorted(modules))}.")
    check_installed()
    return Invocation([sys.executable, "-m", *modules[executable].split()], environment)


def _is_of_this_python(program: Path) -> bool:
    """Return whether a script starts with the Python of this environment, which its first lines name."""
    try:
        with program.open("rb") as file:
            first, second = (file.readline(5000).decode(errors="replace") for _ in range(2))
    except OSError:  # a compiled program need not be readable to run
        return False
    words = first.removeprefix("#!").split() if first.startswith("#!") else []
    if words == ["/bin/sh"] and second.startswith("'''exec' "):
        # What pip writes if the path is too long for a first line.
        words = shlex.split(second.removeprefix("'''exec' "))
    if words and Path(words[0]).name == "env":
        words = [shutil.which(word) or "" for word in words[1:] if not word.startswith("-") and "=" not in word][:1]
    return bool(words) and Path(words[0]).parent == Path(sys.executable).parent


def is_built_in(package: str, prefix: Path | None) -> bool:
    """Return whether our own executables of a package are used, because its prefix has none."""
    return package in BUILT_IN and (prefix is None or not in_prefix(prefix, package))


def in_prefix(prefix: Path, package: str) -> list[Path]:
    """Return the executables that a package has installed in a prefix, in its folder below `lib`, sorted by path."""
    found = []
    for folder, folders, files in os.walk(prefix / "lib" / package):
        folders[:] = sorted(name for name in folders if not name.startswith("."))
        found += [Path(folder, name) for name in sorted(files) if os.access(Path(folder, name), os.X_OK)]
    return found


def everywhere(cwd: Path) -> dict[str, Path]:
    """Return package -> prefix of all packages that `find` would search, without our own."""
    places = [*prefixes.installed(), *(prefix for near in workspaces_near(cwd) for prefix in near.prefixes)]
    return dict(sorted(prefixes.packages(places).items()))


def runnable(cwd: Path) -> list[str]:
    """Return the packages of near workspaces that have an executable, and our own, sorted."""
    built = prefixes.packages(prefix for near in workspaces_near(cwd) for prefix in near.prefixes)
    return sorted({package for package, prefix in built.items() if in_prefix(prefix, package)} | set(BUILT_IN))


def _only(paths: list[Path], package: str, executable: str) -> Path:
    named = [path for path in paths if path.name == executable]
    if len(named) > 1:
        raise CommandError("Multiple executables found:", *(f"- {path}" for path in named))
    if not named:
        there = ", ".join(path.name for path in paths)
        raise CommandError(
            "No executable found",
            f"Executables of {package}: {there or 'none'}.",
            "A Python package names its executables under console_scripts in setup.py; build again after a change.",
        )
    return named[0]


def _where(cwd: Path) -> str:
    built = workspaces_near(cwd)
    if built:
        places = ", ".join(str(near.install) for near in built)
        return f"Looked in ROS 2 itself and in {places}: is its name right, and is it built?"
    return (
        "There is no built workspace here: run `colcon build --symlink-install` in the workspace, and this from there."
    )


#: The text by which the script of this command is recognized, in any environment.
OURS = b"ros_in_python.ros2"

#: Runs this environment's real `ros2` if its script is gone: conda's, which pip has overwritten with ours.
AS_MODULE = "import sys; from ros2cli.cli import main; sys.argv[0] = 'ros2'; sys.exit(main())"

#: `own` here keeps this package's command even where the real one is installed.
CHOICE = "ROS_IN_PYTHON"


def real_ros2(arguments: Sequence[str], environment: Mapping[str, str]) -> list[str] | None:
    """Return the command that should answer `arguments` instead of ours, without them, or None."""
    if environment.get(CHOICE) == "own" or _ours_all_the_same(arguments):
        return None
    for folder in environment.get("PATH", os.defpath).split(os.pathsep):
        path = shutil.which("ros2", path=folder)
        if path is not None and not _is_ours(Path(path)):
            return [path]
    return [sys.executable, "-c", AS_MODULE] if find_spec("ros2cli") else None


def _is_ours(script: Path) -> bool:
    """Return whether this `ros2` is the script of this package."""
    try:
        with script.open("rb") as file:
            return OURS in file.read(2000)
    except OSError:
        return False


def hand_over(arguments: Sequence[str]) -> None:
    """Become the real `ros2` if it is installed; return if not."""
    command = real_ros2(arguments, os.environ)
    if command is None:
        return
    from groundwork.clean_environment import IGNORED, ignored  # a page has neither

    sys.stdout.flush()
    sys.stderr.flush()
    # What this installation does not use may be the real one's.
    environment = {name: value for name, value in {**os.environ, **ignored()}.items() if name != IGNORED}
    # If that `ros2` is a wrapper around this command, it must not hand over again.
    os.execve(command[0], [*command, *arguments], without_bootstrap(environment) | {CHOICE: "own"})


def _ours_all_the_same(arguments: Sequence[str]) -> bool:
    """Return whether this runs a node of ours, of turtlesim or the demo nodes, because the real one is missing."""
    if not arguments or arguments[0] != "run":
        return False
    rest = list(arguments[1:])
    while rest and rest[0].startswith("-"):
        takes_value = rest[0] == "--prefix"
        rest = rest[2 if takes_value else 1 :]
    return bool(rest) and is_built_in(rest[0], prefixes.prefix_of(rest[0], prefixes.installed()))


@click.command(context_settings={"ignore_unknown_options": True, "allow_interspersed_args": False})
@click.option("--prefix", metavar="COMMAND", help="A command to run the executable with, as in 'gdb --args'.")
@click.argument("package_name")
@click.argument("executable_name")
@click.argument("arguments", nargs=-1, type=click.UNPROCESSED)
def run(prefix: str | None, package_name: str, executable_name: str, arguments: tuple[str, ...]) -> None:
    """Start an executable of a package; a colcon workspace here need not be sourced.

    \b
      ros2 run turtlesim turtlesim_node
      ros2 run humanoid_control joint_publisher --ros-args -p use_sim_time:=true -r __node:=left
    """
    launch = find(package_name, executable_name, Path.cwd())
    command = [*(shlex.split(prefix) if prefix else []), *launch.argv, *arguments]
    program = shutil.which(command[0], path=launch.env.get("PATH"))
    if program is None:
        raise CommandError(f"'{command[0]}' can't be run: there is no such program.")
    _become(program, command, launch.env)


def _become(program: str, command: list[str], environment: dict[str, str]) -> None:
    """Replace this process, so that signals and the exit status are the node's own."""
    sys.stdout.flush()
    sys.stderr.flush()
    # Python ignores these two signals; the node must not inherit that.
    signal.signal(signal.SIGPIPE, signal.SIG_DFL)
    signal.signal(signal.SIGXFSZ, signal.SIG_DFL)
    try:
        os.execve(program, command, environment)
    except OSError as error:
        raise CommandError(
            f"{program} could not be started: {error.strerror}",
            "Its first line may name a Python that is gone: build the workspace again.",
        ) from None
