"""Wheels of what was compiled here, the middleware and interfaces: with them, other machines need no compiler.

`python -m grader.wheels FOLDER` writes those of this environment, and of the course here as compiled last.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator
from pathlib import Path

from grader.exercise.loading import COURSE
from grader.sandbox.middleware import MiddlewareUnavailable, require_middleware
from interface_compiler import activation, prefixes
from interface_compiler.near import use_near
from interface_compiler.wheel import wheel
from interface_compiler.wheel_file import wheel_file
from rmw_lockstep.library import DESCRIPTION, PREBUILT, Library, library, sources_digest

_VERSION = "0.1.0"
_SUMMARY = "The compiled libraries of rmw_lockstep, for PyPI's ROS 2 Jazzy"
_INIT = b'"""The compiled libraries of rmw_lockstep, which finds them: nothing to import."""\n'


def compiled_wheels() -> dict[str, bytes]:
    """Return file name -> content of the wheels that spare another machine a compiler.

    Raises `MiddlewareUnavailable` if there is no middleware here.
    """
    return dict([middleware_wheel(), *_interface_wheels()])


def middleware_wheel() -> tuple[str, bytes]:
    """Return the file name and content of the middleware's wheel, which fits every Python 3.

    Its version ends in the digest of its sources, so that pip replaces one of other sources. Raises
    `MiddlewareUnavailable` if there is no middleware here, or colcon has built it for the ROS 2 that is sourced.
    """
    require_middleware()
    built = library()
    if not isinstance(built, Library) or not (built.folder / DESCRIPTION).is_file():
        reason = "The grader's middleware was built by colcon, so it fits no other computer."
        raise MiddlewareUnavailable(f"{reason} Compile it for other computers: python -m rmw_lockstep.build")
    # Links are followed: a wheel has none.
    files = {file.relative_to(built.folder).as_posix(): file.read_bytes() for file in _files(built.folder)}
    content = {f"{PREBUILT}/{name}": data for name, data in files.items()} | {f"{PREBUILT}/__init__.py": _INIT}
    version = f"{_VERSION}+{sources_digest()[:16]}"
    return wheel_file(PREBUILT.replace("_", "-"), version, _SUMMARY, "py3-none", content, {})


def _files(folder: Path) -> list[Path]:
    return sorted(file for file in folder.rglob("*") if file.is_file() and file.suffix not in (".py", ".pyc"))


def _interface_wheels() -> Iterator[tuple[str, bytes]]:
    """Yield the wheels of every package that was compiled by interface_compiler and can be imported here."""
    places = [*activation.active(), Path(sys.prefix)]
    for package, prefix in prefixes.packages(places).items():
        if prefixes.key_of(package, prefix):
            yield wheel(package, prefix)


def main() -> None:
    """Write the wheels and print their paths; or print why that is impossible and exit with 1."""
    use_near(Path.cwd(), COURSE)
    folder = Path(sys.argv[1])
    folder.mkdir(parents=True, exist_ok=True)
    try:
        for name, content in compiled_wheels().items():
            (folder / name).write_bytes(content)
            print(folder / name)
    except MiddlewareUnavailable as error:
        sys.exit(str(error))


if __name__ == "__main__":
    main()
