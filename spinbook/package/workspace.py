"""Writes packages into a colcon workspace. Unchanged files are not touched, so colcon rebuilds only what changed."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

from groundwork.files import write_if_changed
from interface_compiler import toolchain
from interface_compiler.definition import KINDS, Definition, by_package, read_folder
from spinbook.course.course import Package
from spinbook.package.files import Module, interface_package_files, package_files

#: The file that lists the modules that were written, one per line.
_RECORD = ".spinbook-modules"
#: The file that lists the launch and parameter files that were written, one path per line.
_FILES = ".spinbook-files"


def package_folder(workspace: Path, package: Package) -> Path:
    """Return the folder of the package's sources in a workspace."""
    return workspace / "src" / package.name


def write_package(
    workspace: Path,
    package: Package,
    modules: Sequence[Module],
    interfaces: Sequence[str] = (),
    extra: Mapping[str, str] | None = None,
) -> Path:
    """Make the package's sources exactly these modules; other files in the folder are kept. Return the folder.

    A module that was written before and is no longer among them is removed, with its executable.
    `interfaces` are the course's own packages of interfaces, on which modules may depend. `extra` are launch and
    parameter files, by their path in the package.
    """
    extra = extra or {}
    folder = package_folder(workspace, package)
    files = package_files(package, modules, interfaces, extra)
    for path, content in files.items():
        write_if_changed(folder / path, content)
    for name in set(_written(folder)) - {module.name for module in modules}:
        (folder / package.name / f"{name}.py").unlink(missing_ok=True)
    for path in set(_written_files(folder)) - set(extra):
        (folder / path).unlink(missing_ok=True)
    if extra or (folder / _FILES).exists():
        write_if_changed(folder / _FILES, "".join(f"{path}\n" for path in extra))
    lines = (" ".join([module.name, *module.executables]) for module in modules)
    write_if_changed(folder / _RECORD, "".join(f"{line}\n" for line in lines))
    return folder


def _written(folder: Path) -> dict[str, tuple[str, ...]]:
    """Return the modules that were written before, each with its executables."""
    record = folder / _RECORD
    lines = record.read_text(encoding="utf-8").splitlines() if record.exists() else []
    return {words[0]: tuple(words[1:]) for words in map(str.split, lines) if words}


def _written_files(folder: Path) -> dict[str, str]:
    """Return the current texts of the launch and parameter files that were written before."""
    record = folder / _FILES
    paths = record.read_text(encoding="utf-8").splitlines() if record.exists() else []
    return {path: (folder / path).read_text(encoding="utf-8") for path in paths if (folder / path).is_file()}


def _written_modules(folder: Path, package: Package) -> list[Module]:
    """Return the modules that were written before, with their current code."""
    return [
        Module(name, file.read_text(encoding="utf-8"), executables)
        for name, executables in _written(folder).items()
        if (file := folder / package.name / f"{name}.py").exists()
    ]


def add_module(workspace: Path, package: Package, module: Module) -> Path:
    """Put one module into the package, next to the existing ones. Return the module's file."""
    folder = package_folder(workspace, package)
    others = [other for other in _written_modules(folder, package) if other.name != module.name]
    write_package(workspace, package, [*others, module], extra=_written_files(folder))
    return folder / package.name / f"{module.name}.py"


def add_file(workspace: Path, package: Package, path: str, text: str) -> Path:
    """Put a launch or parameter file into the package, at `path` within it. Return the file."""
    folder = package_folder(workspace, package)
    write_package(workspace, package, _written_modules(folder, package), extra={**_written_files(folder), path: text})
    return folder / path


def write_interface_packages(workspace: Path, course: Package, definitions: Iterable[Definition]) -> list[Path]:
    """Make each package's sources exactly these definitions; return the packages' folders, sorted.

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
    """Return the definitions in a workspace's packages."""
    return read_folder(workspace / "src")[0]


def without_interfaces(workspace: Path) -> list[str]:
    """Return options of `colcon build` that leave out packages of interfaces, unless a sourced ROS can build them."""
    packages = sorted({item.package for item in written_definitions(workspace)})
    return ["--packages-ignore", *packages] if packages and toolchain.sourced_ros() is None else []
