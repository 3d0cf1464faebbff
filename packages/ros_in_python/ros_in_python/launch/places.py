"""Substitutions that name a file, a folder, a package or a program."""

from __future__ import annotations

import os
import shutil
from collections.abc import Iterable
from pathlib import Path

from interface_compiler import prefixes
from ros_in_python.launch.substitutions import Context, Substitution, Text, text_of
from ros_in_python.ros2.cli import CommandError


class PathJoinSubstitution(Substitution):
    """Parts of a path, joined with slashes."""

    def __init__(self, substitutions: Iterable[Text]) -> None:
        self.parts = list(substitutions)

    def perform(self, context: Context) -> str:
        return os.fspath(Path(*(text_of(part, context) for part in self.parts)))

    def __truediv__(self, part: Text) -> PathJoinSubstitution:
        """Return the path with another part at its end."""
        return PathJoinSubstitution([*self.parts, part])


class PathSubstitution(PathJoinSubstitution):
    """A path, to which parts are joined with `/`."""

    def __init__(self, path: Text) -> None:
        super().__init__([path])


class FindPackageShare(Substitution):
    """The folder `share/PACKAGE` of an installed package."""

    def __init__(self, package: Text) -> None:
        self.package = package

    def perform(self, context: Context) -> str:
        """Return the folder's path. Raises `CommandError` if the package is not installed."""
        return self.find(text_of(self.package, context))

    def find(self, package_name: str) -> str:
        """Return the folder of a package at once, which launch files call before anything runs."""
        return os.fspath(prefix_of(package_name) / "share" / package_name)


class FindPackagePrefix(FindPackageShare):
    """The folder in which a package is installed."""

    def find(self, package_name: str) -> str:
        """Return the folder's path. Raises `CommandError` if the package is not installed."""
        return os.fspath(prefix_of(package_name))


class ExecutableInPackage(Substitution):
    """The path of a package's executable."""

    def __init__(self, executable: Text, package: Text) -> None:
        self.executable, self.package = executable, package

    def perform(self, context: Context) -> str:
        """Return the path. Raises `CommandError` if there is none."""
        package, name = text_of(self.package, context), text_of(self.executable, context)
        file = prefix_of(package) / "lib" / package / name
        if not file.is_file():
            raise CommandError(f"the package '{package}' has no executable '{name}'")
        return os.fspath(file)


def prefix_of(package: str) -> Path:
    """Return the folder in which a package is installed in this environment. Raises `CommandError`."""
    prefix = prefixes.prefix_of(package, prefixes.installed())
    if prefix is None:
        raise CommandError(f"package '{package}' not found", "Build its workspace, and launch from there.")
    return prefix


class FindExecutable(Substitution):
    """The path of a program on PATH."""

    def __init__(self, *, name: Text) -> None:
        self.name = name

    def perform(self, context: Context) -> str:
        """Return the path. Raises `CommandError` if there is no such program."""
        name = text_of(self.name, context)
        path = shutil.which(name)
        if path is None:
            raise CommandError(f"executable '{name}' not found on the PATH")
        return path


class ThisLaunchFile(Substitution):
    """The path of the launch file that is read."""

    def perform(self, context: Context) -> str:
        return os.fspath(context.file)


class ThisLaunchFileDir(Substitution):
    """The folder of the launch file that is read."""

    def perform(self, context: Context) -> str:
        return os.fspath(context.file.parent)


class FileContent(Substitution):
    """The text of a file."""

    def __init__(self, path: Text) -> None:
        self.path = path

    def perform(self, context: Context) -> str:
        """Return the text. Raises `CommandError` if there is no such file."""
        path = Path(text_of(self.path, context))
        try:
            return path.read_text(encoding="utf-8")
        except OSError as error:
            raise CommandError(f"the file {path} can't be read: {error.strerror}") from None
