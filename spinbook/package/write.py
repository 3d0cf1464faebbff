"""Writes packages into a colcon workspace, changing only what changed, so that colcon rebuilds only that."""

from __future__ import annotations

import argparse
from collections.abc import Iterable, Mapping, Sequence
from pathlib import Path

import click

from groundwork.files import write_if_changed
from interface_compiler.definition import KINDS, Definition, by_package, read_folder
from spinbook.course.course import Package
from spinbook.package.files import Module, interface_package_files, package_files
from spinbook.ros2.cli import CONTEXT, CommandError

#: What was written is remembered here, one module per line.
_RECORD = ".spinbook-modules"
#: And the launch and parameter files here, one path per line.
_FILES = ".spinbook-files"


def package_folder(workspace: Path, package: Package) -> Path:
    """Where the package's sources are in a workspace."""
    return workspace / "src" / package.name


def write_package(
    workspace: Path,
    package: Package,
    modules: Sequence[Module],
    interfaces: Sequence[str] = (),
    extra: Mapping[str, str] | None = None,
) -> Path:
    """Make the package's sources exactly these modules; files that a person put next to them stay. Returns its folder.

    A module that was written before and is no longer among them is removed: its executable is gone too.
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
    """The modules that were written before, each with its executables."""
    record = folder / _RECORD
    lines = record.read_text(encoding="utf-8").splitlines() if record.exists() else []
    return {words[0]: tuple(words[1:]) for words in map(str.split, lines) if words}


def _written_files(folder: Path) -> dict[str, str]:
    """The launch and parameter files that were written before, as they are now."""
    record = folder / _FILES
    paths = record.read_text(encoding="utf-8").splitlines() if record.exists() else []
    return {path: (folder / path).read_text(encoding="utf-8") for path in paths if (folder / path).is_file()}


def _written_modules(folder: Path, package: Package) -> list[Module]:
    """The modules that were written before, as they are now."""
    return [
        Module(name, file.read_text(encoding="utf-8"), executables)
        for name, executables in _written(folder).items()
        if (file := folder / package.name / f"{name}.py").exists()
    ]


def add_module(workspace: Path, package: Package, module: Module) -> Path:
    """Put one module into the package, next to those that are there. Returns the module's file."""
    folder = package_folder(workspace, package)
    others = [other for other in _written_modules(folder, package) if other.name != module.name]
    write_package(workspace, package, [*others, module], extra=_written_files(folder))
    return folder / package.name / f"{module.name}.py"


def add_file(workspace: Path, package: Package, path: str, text: str) -> Path:
    """Put a launch or parameter file into the package, at `path` within it. Returns the file."""
    folder = package_folder(workspace, package)
    write_package(workspace, package, _written_modules(folder, package), extra={**_written_files(folder), path: text})
    return folder / path


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


NODE = """\
def main():
    print('Hi from {package}.')


if __name__ == '__main__':
    main()
"""


@click.command(
    context_settings={**CONTEXT, "ignore_unknown_options": True},
    options_metavar="[--build-type ament_python] [--node-name NODE] [--dependencies PACKAGE…]",
)
@click.argument("words", nargs=-1, type=click.UNPROCESSED, metavar="PACKAGE_NAME")
def create(words: tuple[str, ...]) -> None:
    """Make a new package of Python in this folder.

    \b
      ros2 pkg create --build-type ament_python --node-name talker my_package
      ros2 pkg create --build-type ament_python my_package --dependencies rclpy std_msgs

    Also: --license, --description, --maintainer-name, --maintainer-email, --destination-directory. A package of C++
    (ament_cmake, the default of the real command) needs a ROS 2 installation.
    """
    given = _read(words)
    if given.build_type != "ament_python":
        raise CommandError(
            "Only packages of Python can be made without a ROS 2 installation.",
            f"ros2 pkg create --build-type ament_python {given.package_name}",
        )
    name = given.package_name
    # REP 144's rule for package names.
    if not (name[:1].isalpha() and name.isidentifier() and name.islower() and "__" not in name):
        raise CommandError(
            f"'{name}' is not a valid package name: use lower-case letters, digits and single underscores."
        )
    folder = Path(given.destination_directory) / name
    if folder.exists():
        raise CommandError(
            f"\nAborted!\nThe directory already exists: {folder}\nEither remove the directory or choose another."
        )
    _write_new(folder, given)


def _read(words: tuple[str, ...]) -> argparse.Namespace:
    reader = argparse.ArgumentParser(prog="ros2 pkg create", add_help=False, allow_abbrev=False)
    reader.add_argument("package_name")
    reader.add_argument("--build-type", default="ament_cmake")
    reader.add_argument("--package-format", default="3")
    reader.add_argument("--dependencies", nargs="+", default=[])
    reader.add_argument("--node-name", default="")
    reader.add_argument("--license", default="TODO: License declaration")
    reader.add_argument("--description", default="TODO: Package description")
    reader.add_argument("--maintainer-name", default="TODO")
    reader.add_argument("--maintainer-email", default="todo@todo.todo")
    reader.add_argument("--destination-directory", default=".")
    return reader.parse_args(list(words))


def _write_new(folder: Path, given: argparse.Namespace) -> None:
    name = given.package_name
    package = Package(
        name, ".", "0.0.0", given.description, given.maintainer_name, given.maintainer_email, given.license
    )
    modules = [Module(given.node_name, NODE.format(package=name))] if given.node_name else []
    files = package_files(package, modules)
    depends = "".join(f"  <depend>{one}</depend>\n" for one in given.dependencies)
    files["package.xml"] = files["package.xml"].replace("  <test_depend>", f"{depends}  <test_depend>", 1)
    click.echo("going to create a new package")
    for what, value in (
        ("package name", name),
        ("destination directory", Path(given.destination_directory).resolve()),
        ("package format", 3),
        ("version", package.version),
        ("description", package.description),
        ("maintainer", [f"{package.maintainer} <{package.email}>"]),
        ("licenses", [package.license]),
        ("build type", given.build_type),
        ("dependencies", given.dependencies),
    ):
        click.echo(f"{what}: {value}")
    if given.node_name:
        click.echo(f"node_name: {given.node_name}")
    click.echo(f"creating folder {folder}")
    for path, text in files.items():
        click.echo(f"creating {folder / path}")
        write_if_changed(folder / path, text)
