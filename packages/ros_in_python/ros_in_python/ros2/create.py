"""`ros2 pkg create`: a new package of Python, or of C++."""

from __future__ import annotations

import argparse
from pathlib import Path

import click

from ros_in_python.ros2.ament_cmake import cmake_files
from ros_in_python.ros2.ament_python import Manifest, package_files
from ros_in_python.ros2.cli import CommandError

#: The program that `--node-name` makes.
NODE = """\
def main():
    print('Hi from {package}.')


if __name__ == '__main__':
    main()
"""


@click.command(
    context_settings={"ignore_unknown_options": True},
    options_metavar="[--build-type TYPE] [--node-name NODE] [--library-name NAME] [--dependencies PACKAGE…]",
)
@click.argument("words", nargs=-1, type=click.UNPROCESSED, metavar="PACKAGE_NAME")
def create(words: tuple[str, ...]) -> None:
    """Make a new package in this folder: ament_cmake (C++, the default) or ament_python.

    \b
      ros2 pkg create --build-type ament_python --node-name talker my_package
      ros2 pkg create --build-type ament_python my_package --dependencies rclpy std_msgs
      ros2 pkg create my_interfaces

    Also: --license, --description, --maintainer-name, --maintainer-email, --destination-directory. To build a package
    of C++ takes a ROS 2 installation; one of messages, services and actions alone is compiled without.
    """
    options, others = reader().parse_known_args(list(words))
    name = options.package_name
    if not name:
        raise CommandError("The package has no name.", "Write it before --dependencies, which takes all that follows.")
    if others:
        option = others[0].startswith("-")
        what = f"There is no option '{others[0]}'." if option else f"'{others[0]}' is left over: the name is '{name}'."
        raise CommandError(what, "`ros2 pkg create --help` lists the options.")
    if options.build_type not in ("ament_cmake", "ament_python"):
        raise CommandError(f"There is no build type '{options.build_type}' here: ament_cmake, ament_python.")
    if options.library_name and options.build_type == "ament_python":
        raise CommandError("A package of Python has no library: leave out --library-name.")
    # REP 144's rule for package names.
    if not (name[:1].isalpha() and name.isidentifier() and name.islower() and "__" not in name):
        raise CommandError(
            f"'{name}' is not a valid package name: use lower-case letters, digits and single underscores."
        )
    folder = Path(options.destination_directory) / name
    if folder.exists():
        raise CommandError(
            f"\nAborted!\nThe directory already exists: {folder}\nEither remove the directory or choose another."
        )
    _write_new(folder, options)


def reader(*, exit_on_error: bool = True) -> argparse.ArgumentParser:
    """Return what reads the words of `ros2 pkg create`; the name is "" if there is none."""
    reader = argparse.ArgumentParser(
        prog="ros2 pkg create", add_help=False, allow_abbrev=False, exit_on_error=exit_on_error
    )
    reader.add_argument("package_name", nargs="?", default="")
    reader.add_argument("--build-type", default="ament_cmake")
    reader.add_argument("--package-format", default="3")
    reader.add_argument("--dependencies", nargs="+", default=[])
    reader.add_argument("--node-name", default="")
    reader.add_argument("--library-name", default="")
    reader.add_argument("--license", default="TODO: License declaration")
    reader.add_argument("--description", default="TODO: Package description")
    reader.add_argument("--maintainer-name", default="TODO")
    reader.add_argument("--maintainer-email", default="todo@todo.todo")
    reader.add_argument("--destination-directory", default=".")
    return reader


def _write_new(folder: Path, options: argparse.Namespace) -> None:
    manifest = Manifest(
        options.package_name,
        "0.0.0",
        options.description,
        options.maintainer_name,
        options.maintainer_email,
        options.license,
        depends=options.dependencies,
    )
    files = _files(manifest, options)
    _say(manifest, options)
    click.echo(f"creating folder {folder}")
    for path, text in files.items():
        click.echo(f"creating {folder / path}")
        file = folder / path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(text, encoding="utf-8")


def _files(manifest: Manifest, options: argparse.Namespace) -> dict[str, str]:
    if options.build_type == "ament_cmake":
        return cmake_files(manifest, options.dependencies, options.node_name, options.library_name)
    files = package_files(manifest, [(options.node_name, options.node_name)] if options.node_name else [])
    if options.node_name:
        files[f"{manifest.name}/{options.node_name}.py"] = NODE.format(package=manifest.name)
    return files


def _say(manifest: Manifest, options: argparse.Namespace) -> None:
    click.echo("going to create a new package")
    for label, value in (
        ("package name", manifest.name),
        ("destination directory", Path(options.destination_directory).resolve()),
        ("package format", 3),
        ("version", manifest.version),
        ("description", manifest.description),
        ("maintainer", [f"{manifest.maintainer} <{manifest.email}>"]),
        ("licenses", [manifest.license]),
        ("build type", options.build_type),
        ("dependencies", options.dependencies),
    ):
        click.echo(f"{label}: {value}")
    for label, value in (("node_name", options.node_name), ("library_name", options.library_name)):
        if value:
            click.echo(f"{label}: {value}")
