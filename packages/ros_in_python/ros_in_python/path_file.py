"""Puts `importable` at the end of every Python's path, by a .pth file: see https://docs.python.org/3/library/site.html.

At the end, so that tf2 and the others of a real ROS 2 come first; and not as packages of the wheel, which would
overwrite those of a ROS 2 that is installed in the same environment.
"""

from __future__ import annotations

import sysconfig
from pathlib import Path
from typing import Any

from setuptools.command.build_py import build_py

NAME = "ros_in_python.pth"


class BuildWithPathFile(build_py):  # type: ignore[misc]
    """Adds the .pth file to a wheel."""

    def run(self) -> None:
        """Copy the packages, and write the file next to them."""
        super().run()
        if not self.editable_mode:
            Path(self.build_lib, NAME).write_text("ros_in_python/importable\n")

    def get_outputs(self, *arguments: Any, **options: Any) -> list[str]:
        """Return all files of the wheel."""
        return [*super().get_outputs(*arguments, **options), str(Path(self.build_lib, NAME))]


def write() -> None:
    """Write the file for an editable install, whose packages are elsewhere."""
    Path(sysconfig.get_path("purelib"), NAME).write_text(f"{Path(__file__).with_name('importable')}\n")


if __name__ == "__main__":
    write()
