"""Reads a Python launch file: runs it with modules `launch` and `launch_ros` that hold what is supported."""

from __future__ import annotations

import re
import sys
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from types import ModuleType
from typing import Any

from ros_in_python.launch import actions, changes, conditions, events, logger, parameters, places, substitutions
from ros_in_python.launch.actions import LaunchDescription, PlacedError
from ros_in_python.launch.api import ALL_NAMES, NAMES
from ros_in_python.ros2.cli import CommandError

#: Names that mean something with another name here, for any module or for one.
_RENAMED: dict[str, Any] = {
    "Entity": Any,
    "Event": events.LaunchEvent,
    "LaunchContext": substitutions.Context,
    "LaunchDescriptionEntity": actions.Action,
    "SomeSubstitutionsType": Any,
    "SubstitutionFailure": CommandError,
    "launch.events.Shutdown": events.ShutdownRequested,
    "ExecuteLocal": actions.ExecuteProcess,
    "ROSTimer": actions.RosTimer,
    "SetParameter": changes.ParameterForAll,
    "Parameter": parameters.NodeParameter,
    "launch_ros.substitutions.Parameter": substitutions.GlobalParameter,
    "PushROSNamespace": changes.PushRosNamespace,
    "Command": substitutions.CommandOutput,
    "Parser": Any,
    "FindPackage": places.FindPackagePrefix,
}
_PLACES = (actions, changes, events, conditions, logger, parameters, places, substitutions)


def _meaning(module: str, name: str) -> Any:
    if renamed := _RENAMED.get(f"{module}.{name}", _RENAMED.get(name)):
        return renamed
    if module.endswith("launch_description_sources"):
        return actions.LaunchDescriptionSource
    return next(getattr(place, name) for place in _PLACES if hasattr(place, name))


#: The modules of ROS 2's launch API and what of each there is here.
MODULES = {module: {name: _meaning(module, name) for name in names} for module, names in NAMES.items()}
MODULES |= {
    module: {name: MODULES[module.rpartition(".")[0]][name] for name in names}
    for module, names in ALL_NAMES.items()
    if module not in MODULES
}
_ELSEWHERE = "ROS 2's own launch, which `ros2 launch` uses where ROS 2 is installed, knows more."
_NOT_FOUND = re.compile(r"cannot import name '(\w+)'")


class _NotHere(AttributeError):
    """A name of ROS 2's launch that there is not here."""


class _Module(ModuleType):
    """One of those modules; a name that it does not have is refused with those that it has."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        raise _NotHere(_refusal(self.__name__, name))


def _refusal(module: str, name: str) -> str:
    there = ", ".join(sorted(MODULES[module])) or "nothing"
    return f"`{name}` of {module} is not supported here. It has: {there}.\n{_ELSEWHERE}"


def read(file: Path) -> LaunchDescription:
    """Return what a file's `generate_launch_description()` returns. Raises `CommandError` with the file's line."""
    variables: dict[str, Any] = {"__name__": "launch_file", "__file__": str(file.absolute())}
    with modules():
        try:
            exec(compile(file.read_text(encoding="utf-8"), str(file), "exec"), variables)
            found = variables["generate_launch_description"]()
        except CommandError as refusal:
            raise PlacedError(f"{file}{_line(refusal, file)}: {refusal.message}") from None
        except KeyError as error:
            if error.args != ("generate_launch_description",):
                raise PlacedError(f"{file}{_line(error, file)}: {_describe(error)}") from None
            raise PlacedError(f"{file} has no function generate_launch_description().") from None
        except SyntaxError as error:
            raise PlacedError(f"{file}:{error.lineno}: not valid Python: {error.msg}") from None
        except Exception as error:
            raise PlacedError(f"{file}{_line(error, file)}: {_describe(error)}") from None
    if not isinstance(found, LaunchDescription):
        raise PlacedError(
            f"{file}: generate_launch_description() returned {type(found).__name__}, not a LaunchDescription."
        )
    return found


@contextmanager
def modules() -> Iterator[None]:
    """Let `import launch` and `import launch_ros` find our modules inside the block."""
    before = {name: sys.modules.get(name) for name in MODULES}
    made = {name: _Module(name) for name in MODULES}
    for name, module in made.items():
        vars(module).update(MODULES[name])
        # A package has a path; so the import system looks for parts of it in sys.modules.
        vars(module)["__path__"] = []
        above, _, last = name.rpartition(".")
        if above:
            vars(made[above])[last] = module
    sys.modules.update(made)
    try:
        yield
    finally:
        for name, earlier in before.items():
            if earlier is None:
                del sys.modules[name]
            else:
                sys.modules[name] = earlier


def _line(error: BaseException, file: Path) -> str:
    lines = [frame.lineno for frame in traceback.extract_tb(error.__traceback__) if frame.filename == str(file)]
    return f":{lines[-1]}" if lines else ""


def _describe(error: BaseException) -> str:
    if isinstance(error, _NotHere):
        return str(error)
    module = getattr(error, "name", None) or ""
    if isinstance(error, ModuleNotFoundError) and module.partition(".")[0] in MODULES:
        there = ", ".join(NAMES)
        return f"the module {module} is not supported here. There is: {there}.\n{_ELSEWHERE}"
    if isinstance(error, ImportError) and module in MODULES and (name := _NOT_FOUND.search(str(error))):
        return _refusal(module, name[1])
    hint = "\n`pip install xacro` brings it." if module == "xacro" else ""
    return f"{type(error).__name__}: {error}{hint}"
