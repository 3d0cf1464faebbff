"""Shows a program only the ROS modules that it has imported itself, as in a new Python.

A program of a page shares its interpreter with the page's own code, which has imported rclpy before the program begins,
and messages for the grader's runner and for `ros2`. The two take turns and never run at the same time. A program that
forgets to import `rclpy.node` or `sensor_msgs.msg` fails here with the same AttributeError as on a robot.
"""

from __future__ import annotations

import contextlib
import sys
from collections.abc import Iterator, Sequence
from importlib.abc import Loader
from importlib.machinery import ModuleSpec
from types import ModuleType

from grader import preloaded

#: The visible modules that only the page's own code has imported.
_own: dict[str, None] = {}
_is_programs_turn = False


def watch() -> None:
    """Remember every module of ROS that is imported from now on. Call this before the first one is imported."""
    if not any(isinstance(finder, _RememberingFinder) for finder in sys.meta_path):
        sys.meta_path.insert(0, _RememberingFinder())


def begin_program() -> None:
    """Hide all modules: a new program begins its turn."""
    preloaded.hide()
    preloaded.forget_type_support()
    turn_to_program()


def turn_to_program() -> None:
    """Hide what only the page's own code has imported: the program continues."""
    global _is_programs_turn
    _is_programs_turn = True
    if _own:
        preloaded.hide(_own)
        _own.clear()


def turn_to_page() -> None:
    """Continue with the page's own code. What it imports from now on is hidden at the program's next turn."""
    global _is_programs_turn
    _is_programs_turn = False


def show_all() -> None:
    """Continue with the page's own code, and show it all modules that it has imported before."""
    turn_to_page()
    _own.update(dict.fromkeys(preloaded.show_all()))


@contextlib.contextmanager
def programs_turn() -> Iterator[None]:
    """Give the program its turn inside the `with` block. It still sees what it imported in earlier blocks."""
    preloaded.forget_type_support()
    turn_to_program()
    try:
        yield
    finally:
        show_all()


def _imported(name: str) -> None:
    if not _is_programs_turn:
        _own[name] = None


class _RememberingFinder(preloaded.Finder):
    """Finds modules that are imported for the first time, too, and remembers them."""

    def find_spec(
        self, name: str, path: Sequence[str] | None = None, target: ModuleType | None = None
    ) -> ModuleSpec | None:
        spec = super().find_spec(name, path, target)
        if spec or not preloaded.is_of_ros(name):
            return spec
        others = (finder.find_spec(name, path, target) for finder in sys.meta_path if finder is not self)
        spec = next(filter(None, others), None)
        if spec and spec.loader and preloaded.is_of_python(spec):
            spec.loader = _RememberingLoader(spec.loader)
        return spec

    def exec_module(self, module: ModuleType) -> None:
        super().exec_module(module)
        _imported(module.__name__)


class _RememberingLoader(Loader):
    """Loads a module by another loader, and remembers it."""

    def __init__(self, loader: Loader) -> None:
        self._loader = loader

    def create_module(self, spec: ModuleSpec) -> ModuleType | None:
        """Return what the other loader returns."""
        return self._loader.create_module(spec)

    def exec_module(self, module: ModuleType) -> None:
        """Run the module's code, with the other loader as its `__loader__`."""
        spec = module.__spec__
        assert spec
        spec.loader = module.__loader__ = self._loader
        with preloaded.noted():
            self._loader.exec_module(module)
        preloaded.remember(module, spec)
        _imported(module.__name__)
