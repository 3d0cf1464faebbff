"""Hides the ROS modules that the fork server has imported until the program imports them itself.

In a new Python, `import sensor_msgs` does not make `sensor_msgs.msg` available, nor does `import rclpy` make
`rclpy.node`. A program that relies on either fails on the robot, so it has to fail in a fork as well, where both have
been imported long ago. A hidden module is in neither `sys.modules` nor its package. Once the program imports it, the
module is back, with every hidden module that it has imported itself.

Source: "The import system" in the Python reference, `importlib.machinery`.
"""

from __future__ import annotations

import builtins
import contextlib
import importlib
import sys
from collections.abc import Iterator, Mapping, Sequence
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
    _imports.setdefault(str(importer.get("__name__")), {}).update(dict.fromkeys(filter(_is_of_ros, found)))


def _is_of_ros(name: str) -> bool:
    """Return whether this is a module of rclpy, or one of messages, services or actions."""
    return name.partition(".")[0] == "rclpy" or is_of_interfaces(name)


def is_of_interfaces(name: str) -> bool:
    """Return whether this is a package's module of messages, services or actions."""
    package, _, rest = name.partition(".")
    return package != "rclpy" and rest in _INTERFACES


# What to hide: filled before the forks, because each name that a fork looks at is copied.
_hidden: dict[str, _Hidden] = {}


def choose() -> None:
    """Choose what the forks will hide: to be called after the last import."""
    for name, module in sys.modules.items():
        spec = getattr(module, "__spec__", None)
        # Other libraries have direct references to the compiled module, which no program names.
        if _is_of_ros(name) and spec and not isinstance(spec.loader, ExtensionFileLoader):
            _hidden[name] = _Hidden(module, spec, tuple(_imports.get(name, ())))
        if name.partition(".")[2].startswith(_TYPES):
            _forget_type_support(module)


def _forget_type_support(module: ModuleType) -> None:
    """Let the first use of each type here load its support again, which imports the types that it is made of."""
    for value in vars(module).values():
        if isinstance(value, type) and "_TYPE_SUPPORT" in vars(value):  # its metaclass, see rosidl_generator_py
            value._TYPE_SUPPORT = None  # type: ignore[attr-defined]


def hide() -> None:
    """Hide them in this process."""
    for name, hidden in _hidden.items():
        package, _, own_name = name.rpartition(".")
        within = _hidden[package].module if package in _hidden else sys.modules.get(package)
        if within and vars(within).get(own_name) is hidden.module:
            delattr(within, own_name)
        sys.modules.pop(name, None)
    if _hidden:
        sys.meta_path.insert(0, _Finder())


class _Finder:
    """Finds hidden modules, and "loads" them; see importlib.abc.MetaPathFinder and importlib.abc.Loader."""

    def find_spec(self, name: str, path: object = None, target: object = None) -> ModuleSpec | None:
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
