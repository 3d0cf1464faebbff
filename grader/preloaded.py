"""Hides ROS modules that were imported before a program began, until the program imports them itself.

In a new Python, `import sensor_msgs` does not make `sensor_msgs.msg` available, nor does `import rclpy` make
`rclpy.node`. A program that relies on either fails on the robot, so it has to fail in a fork of the fork server and in
a web page as well, where both have been imported long ago. A hidden module is in neither `sys.modules` nor its package.
Once the program imports it, the module is back, with every hidden module that it has imported itself.

Source: "The import system" in the Python reference, `importlib.machinery`.
"""

from __future__ import annotations

import builtins
import contextlib
import importlib
import sys
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib.machinery import ExtensionFileLoader, ModuleSpec
from importlib.util import resolve_name
from types import ModuleType
from typing import Any

_INTERFACES = ("msg", "srv", "action")
_TYPES = tuple(f"{kind}._" for kind in _INTERFACES)

#: The names that each module has imported, in order.
_imports: dict[str, dict[str, None]] = {}


@dataclass(frozen=True)
class _Hidden:
    module: ModuleType
    spec: ModuleSpec
    imports: tuple[str, ...]


@contextlib.contextmanager
def noted() -> Iterator[None]:
    """Note what each module imports inside the `with` block."""
    real = builtins.__import__
    if real.__module__ == __name__:  # a block around this one notes it
        yield
        return

    def importing(
        name: str,
        globals: Mapping[str, object] | None = None,
        locals: Mapping[str, object] | None = None,
        fromlist: Sequence[str] | None = (),
        level: int = 0,
    ) -> ModuleType:
        module = real(name, globals, locals, fromlist or (), level)
        _note(name, globals or {}, fromlist or (), level)
        return module

    builtins.__import__ = importing
    try:
        yield
    finally:
        builtins.__import__ = real


def _note(name: str, importer: Mapping[str, Any], fromlist: Sequence[str], level: int) -> None:
    absolute = resolve_name("." * level + name, importer.get("__package__")) if level else name
    submodules = (f"{absolute}.{one}" for one in fromlist)
    found = [absolute, *(one for one in submodules if one in sys.modules)]
    _imports.setdefault(str(importer.get("__name__")), {}).update(dict.fromkeys(filter(is_of_ros, found)))


def is_of_ros(name: str) -> bool:
    """Return whether this is a module of rclpy, or one of messages, services or actions."""
    return name.partition(".")[0] == "rclpy" or is_of_interfaces(name)


def is_of_interfaces(name: str) -> bool:
    """Return whether this is a package's module of messages, services or actions."""
    package, _, rest = name.partition(".")
    return package != "rclpy" and rest in _INTERFACES


# What to hide: filled before the forks, because each name that a fork looks at is copied.
_hidden: dict[str, _Hidden] = {}


def choose() -> None:
    """Choose what `hide` is to hide: every module of ROS that has been imported."""
    for name, module in sys.modules.items():
        spec = getattr(module, "__spec__", None)
        if spec and is_of_ros(name) and is_of_python(spec):
            remember(module, spec)
    forget_type_support()


def is_of_python(spec: ModuleSpec) -> bool:
    """Return whether a module is not compiled. Other libraries refer to compiled ones, which stay where they are."""
    return spec.has_location and not isinstance(spec.loader, ExtensionFileLoader)


def remember(module: ModuleType, spec: ModuleSpec) -> None:
    """Let this module be one of those that can be hidden. `spec` is its own, which it has whenever it is visible."""
    _hidden[spec.name] = _Hidden(module, spec, tuple(_imports.get(spec.name, ())))


def forget_type_support() -> None:
    """Let the first use of each type load its support again, which imports the types that it is made of."""
    for name, module in sys.modules.items():
        if name.partition(".")[2].startswith(_TYPES):
            for value in vars(module).values():
                if isinstance(value, type) and "_TYPE_SUPPORT" in vars(value):  # its metaclass, see rosidl_generator_py
                    value._TYPE_SUPPORT = None  # type: ignore[attr-defined]


def hide(names: Iterable[str] | None = None) -> None:
    """Hide these modules in this process, or all that are known here, until they are imported."""
    for name in _hidden if names is None else names:
        hidden, package, own_name = _hidden[name], _package_of(name), name.rpartition(".")[2]
        if package and vars(package).get(own_name) is hidden.module:
            delattr(package, own_name)
        sys.modules.pop(name, None)
    if _hidden and not any(isinstance(finder, Finder) for finder in sys.meta_path):
        sys.meta_path.insert(0, Finder())


def show_all() -> list[str]:
    """Make all of them visible; return the names of those that were hidden."""
    hidden = [name for name in _hidden if name not in sys.modules]
    for name in hidden:
        sys.modules[name] = _hidden[name].module
        if package := _package_of(name):
            vars(package).setdefault(name.rpartition(".")[2], _hidden[name].module)
    return hidden


def _package_of(name: str) -> ModuleType | None:
    package = name.rpartition(".")[0]
    return _hidden[package].module if package in _hidden else sys.modules.get(package)


class Finder:
    """Finds hidden modules, and "loads" them; see importlib.abc.MetaPathFinder and importlib.abc.Loader."""

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        """Return a specification for a hidden module, and None for any other."""
        return ModuleSpec(name, self) if name in _hidden else None  # type: ignore[arg-type]

    def create_module(self, spec: ModuleSpec) -> ModuleType:
        """Return the module that is there already."""
        return _hidden[spec.name].module

    def exec_module(self, module: ModuleType) -> None:
        """Import what the module's own code has imported."""
        hidden = _hidden[module.__name__]
        module.__spec__ = hidden.spec
        for name in hidden.imports:
            if name not in sys.modules:
                importlib.import_module(name)
