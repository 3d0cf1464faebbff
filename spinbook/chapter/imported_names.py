"""What a piece of Python imports, read from its syntax tree."""

from __future__ import annotations

import ast
from collections.abc import Sequence
from typing import Any


def imported(everything: Sequence[ast.AST]) -> dict[str, Any]:
    """Return what the code imports, each with its first line: modules, names of modules, relative modules."""
    optional = _optional_imports(everything)
    imports: dict[str, int] = {}
    interfaces: dict[tuple[str, str], int] = {}
    relative: dict[str, int] = {}
    for item in everything:
        if isinstance(item, ast.ImportFrom) and item.level:
            relative["." * item.level + (item.module or "")] = item.lineno
        elif isinstance(item, ast.ImportFrom) and item.module and item not in optional:
            imports.setdefault(item.module, item.lineno)
            for alias in item.names:
                interfaces.setdefault((item.module, alias.name), item.lineno)
        elif isinstance(item, ast.Import) and item not in optional:
            for alias in item.names:
                imports.setdefault(alias.name, item.lineno)
    return {"imports": imports, "interfaces": interfaces, "relative_imports": relative}


def modules_imported(tree: ast.Module) -> set[str]:
    """Return the modules that the code's top level imports."""
    modules = {item.module for item in tree.body if isinstance(item, ast.ImportFrom) and item.module}
    return modules | {alias.name for item in tree.body if isinstance(item, ast.Import) for alias in item.names}


def imports_launch(tree: ast.Module) -> bool:
    """Return whether it is a piece of a launch file: it imports from ROS 2's launch, and not rclpy."""
    tops = {module.partition(".")[0] for module in modules_imported(tree)}
    return bool(tops & {"launch", "launch_ros"}) and "rclpy" not in tops


def _optional_imports(everything: Sequence[ast.AST]) -> set[ast.AST]:
    """Return imports whose absence the code itself deals with, or that only a type checker reads."""
    optional: set[ast.AST] = set()
    for item in everything:
        caught = isinstance(item, ast.Try) and any(
            handler.type is None or "Error" in ast.dump(handler.type) or "Exception" in ast.dump(handler.type)
            for handler in item.handlers
        )
        if caught or (isinstance(item, ast.If) and "TYPE_CHECKING" in ast.dump(item.test)):
            assert isinstance(item, ast.Try | ast.If)
            optional |= {i for i in item.body if isinstance(i, ast.Import | ast.ImportFrom)}
    return optional
