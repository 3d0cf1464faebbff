"""Replaces rclpy's compiled modules by this package."""

from __future__ import annotations

import importlib.abc
import importlib.machinery
import sys
import types
from collections.abc import Sequence
from typing import Any

_PYBIND = "rclpy._rclpy_pybind11"
_TYPE_SUPPORT = "_s__rosidl_typesupport_c"


class _TypeSupport(types.ModuleType):
    """The converters of a package's messages, which are never called: cdr.py reads and writes messages."""

    def __getattr__(self, name: str) -> Any:
        if name.startswith("__"):
            raise AttributeError(name)
        return self.__name__, name


class _CompiledModuleFinder(importlib.abc.MetaPathFinder, importlib.abc.Loader):
    """Finds the compiled modules here, before Python looks for them on the path."""

    def find_spec(
        self, fullname: str, path: Sequence[str] | None, target: types.ModuleType | None = None
    ) -> importlib.machinery.ModuleSpec | None:
        if fullname == _PYBIND or fullname.endswith(_TYPE_SUPPORT):
            return importlib.machinery.ModuleSpec(fullname, self)
        return None

    def create_module(self, spec: importlib.machinery.ModuleSpec) -> types.ModuleType:
        if spec.name == _PYBIND:
            from rcl_python.pybind import module

            return module(spec.name)
        return _TypeSupport(spec.name)

    def exec_module(self, module: types.ModuleType) -> None:
        """Do nothing: the module is complete already."""


def install() -> None:
    """Let rclpy find this package instead of its compiled module. Raises RuntimeError if rclpy is already imported."""
    if _PYBIND in sys.modules:
        raise RuntimeError("rclpy has been imported already: call rcl_python.install() first")
    if not any(isinstance(finder, _CompiledModuleFinder) for finder in sys.meta_path):
        sys.meta_path.insert(0, _CompiledModuleFinder())
