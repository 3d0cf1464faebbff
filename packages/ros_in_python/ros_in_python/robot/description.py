"""Where a robot's URDF comes from: a file, or an installed package, such as `humanoid_description`, which is ours."""

from __future__ import annotations

from pathlib import Path

from interface_compiler import prefixes
from ros_in_python.example_robots import EXAMPLES
from ros_in_python.robot.urdf import InvalidUrdf


def description_text(source: str) -> str:
    """Return the URDF in a file, or the first one in the folder `urdf` of an installed package.

    Raises `InvalidUrdf` if there is neither.
    """
    try:
        file = Path(source) if Path(source).is_file() else _file_of(source)
        return file.read_text(encoding="utf-8")
    except (OSError, UnicodeDecodeError) as error:
        raise InvalidUrdf(f"{source} can't be read: {error}") from None


def _file_of(package: str) -> Path:
    prefix = prefixes.prefix_of(package, [*prefixes.installed(), EXAMPLES])
    if prefix is None:
        raise InvalidUrdf(f"There is no file and no installed package {package!r}. An example: humanoid_description")
    files = sorted((prefix / "share" / package / "urdf").glob("*.urdf"))
    if not files:
        raise InvalidUrdf(f"The package {package} has no .urdf file in its folder urdf")
    return files[0]
