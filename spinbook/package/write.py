"""Writes a package into its workspace, touching only what changed, so that colcon rebuilds only what must be."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from spinbook.course.course import Package
from spinbook.package.files import Module, package_files
from spinbook.written import write_if_changed


def package_folder(workspace: Path, package: Package) -> Path:
    """Where the package's sources are in a workspace."""
    return workspace / "src" / package.name


def write_package(workspace: Path, package: Package, modules: Sequence[Module], interfaces: Sequence[str] = ()) -> Path:
    """Make the package's sources exactly these modules; files that a person put beside them stay. Returns its folder.

    A module that was written before and is no longer among them is removed: its executable is gone too.
    `interfaces` are the course's own packages of interfaces, on which modules may depend.
    """
    folder = package_folder(workspace, package)
    files = package_files(package, modules, interfaces)
    for path, content in files.items():
        write_if_changed(folder / path, content)
    written = folder / ".spinbook-modules"
    before = written.read_text(encoding="utf-8").split() if written.exists() else []
    for name in set(before) - {module.name for module in modules}:
        (folder / package.name / f"{name}.py").unlink(missing_ok=True)
    write_if_changed(written, "".join(f"{module.name}\n" for module in modules))
    return folder


def add_module(workspace: Path, package: Package, module: Module) -> Path:
    """Put one module into the package, beside those that are there. Returns the module's file."""
    folder = package_folder(workspace, package)
    written = folder / ".spinbook-modules"
    names = written.read_text(encoding="utf-8").split() if written.exists() else []
    others = [name for name in names if name != module.name]
    modules = [
        Module(name, file.read_text(encoding="utf-8"))
        for name in others
        if (file := folder / package.name / f"{name}.py").exists()
    ]
    write_package(workspace, package, [*modules, module])
    return folder / package.name / f"{module.name}.py"
