"""Writes packages of interfaces into a colcon workspace, beside the package of nodes."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from pathlib import Path

from interface_compiler.definition import KINDS, Definition, by_package, read_folder
from spinbook.course.course import Package
from spinbook.package.interface_files import interface_package_files
from spinbook.written import write_if_changed


def write_interface_packages(workspace: Path, course: Package, definitions: Iterable[Definition]) -> list[Path]:
    """Make each package's sources exactly these definitions; the packages' folders, sorted.

    A definition that was written before and is no longer among them is removed.
    """
    return [_write(workspace, course, members) for members in by_package(definitions).values()]


def _write(workspace: Path, course: Package, members: Sequence[Definition]) -> Path:
    folder = workspace / "src" / members[0].package
    files = interface_package_files(course, members)
    for path, content in files.items():
        write_if_changed(folder / path, content)
    for kind in KINDS:
        for file in folder.glob(f"{kind}/*.{kind}"):
            if file.relative_to(folder).as_posix() not in files:
                file.unlink()
    return folder


def written_definitions(workspace: Path) -> list[Definition]:
    """The definitions in a workspace's packages."""
    return read_folder(workspace / "src")[0]
