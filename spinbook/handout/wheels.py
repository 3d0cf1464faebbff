"""Wheels for students: Spinbook without the parts for authors, its middleware, and compiled interfaces."""

from __future__ import annotations

import contextlib
import io
import platform
import re
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Iterable, Iterator
from importlib import metadata
from pathlib import Path

import spinbook
from groundwork.files import cached, write_if_changed
from groundwork.problem import Problem
from interface_compiler import prefixes, shipped
from interface_compiler.checks import dependencies
from interface_compiler.wheel import wheel
from interface_compiler.wheel_file import record, zipped
from spinbook.build.digest import digest, files_digest
from spinbook.course.course import Course
from spinbook.interfaces.definitions import FOLDER, collect, compile_course
from spinbook.problem import SpinbookError

#: The templates of `spinbook new` contain solutions and hidden checks; courses may still use them.
FOR_AUTHORS = ("spinbook/new/template/", "spinbook/new/kinds/")

_BUILD = "import sys; from setuptools.build_meta import build_wheel; print(build_wheel(sys.argv[1]))"
#: Everything that the commands import, as pyproject.toml lists it.
_PACKAGES = ("spinbook", "grader", "groundwork", "interface_compiler", "rcl_python", "rmw_lockstep", "ros_in_python")
_SOURCES = ("pyproject.toml", "README.md", "LICENSE", "spinbook", "grader", "packages")


def spinbook_wheel() -> tuple[str, bytes]:
    """Return the wheel's file name and content. Raises SpinbookError if it can't be made."""
    source = Path(spinbook.__file__).parents[1]
    files = _built(source) if (source / "pyproject.toml").is_file() else _installed()
    kept = {name: content for name, content in files.items() if not name.startswith(FOR_AUTHORS)}
    listing = next(name for name in kept if name.endswith(".dist-info/RECORD"))
    # Without the project's README below its header, which has examples from a course in it.
    described = listing.replace("RECORD", "METADATA")
    kept[described] = kept[described].partition(b"\n\n")[0] + b"\n"
    kept[listing] = record(kept, listing)
    return f"spinbook-{spinbook.__version__}-py3-none-any.whl", zipped(kept, last=listing)


def _built(source: Path) -> dict[str, bytes]:
    """Return what setuptools makes from a checkout, which is not changed. Build it again only if a file has changed."""
    kept = cached("wheels") / f"{_key(source)}.whl"
    try:
        content = kept.read_bytes()
    except OSError:
        content = _build(source)
        with contextlib.suppress(OSError):  # without a cache, it is built each time
            write_if_changed(kept, content)
            _remove_all_but(kept)
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        return {name: archive.read(name) for name in archive.namelist() if not name.endswith("/")}


def _key(source: Path) -> str:
    """Return a digest of everything that decides the wheel."""
    tools = [sys.version, *(found.version for found in metadata.distributions(name="setuptools"))]
    files = (file for name in _SOURCES for file in _files(source / name))
    return digest(files_digest(files, source), *tools)[:16]


def _files(path: Path) -> Iterable[Path]:
    if path.is_file():
        return [path]
    return (file for file in path.rglob("*") if file.is_file() and "__pycache__" not in file.parts)


def _remove_all_but(kept: Path) -> None:
    for other in kept.parent.glob("*.whl"):
        if other != kept:
            other.unlink(missing_ok=True)


def _build(source: Path) -> bytes:
    """Let setuptools build the wheel, in a copy of the checkout."""
    with tempfile.TemporaryDirectory(prefix="spinbook-") as temporary:
        copy, out = Path(temporary) / "source", Path(temporary) / "out"
        copy.mkdir()
        for name in _SOURCES:
            if (source / name).is_dir():
                shutil.copytree(source / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
            elif (source / name).exists():
                shutil.copy(source / name, copy)
        done = subprocess.run(
            [sys.executable, "-c", _BUILD, str(out)], cwd=copy, capture_output=True, text=True, check=False
        )
        wheels = list(out.glob("*.whl"))
        if done.returncode or not wheels:
            error = (done.stderr.strip().splitlines() or ["setuptools said nothing"])[-1]
            fix = 'It is built with setuptools: pip install "setuptools>=77,<80"'
            raise SpinbookError(Problem(source, None, f"the wheel of Spinbook could not be built: {error}", fix))
        return wheels[0].read_bytes()


def _installed() -> dict[str, bytes]:
    """Return the files of the installed Spinbook: for a package of pure Python, what was in its wheel."""
    distribution = metadata.distribution("spinbook")
    dist_info = f"spinbook-{spinbook.__version__}.dist-info/"
    kept = (*(f"{package}/" for package in _PACKAGES), "ros_in_python.pth", dist_info)
    files = {}
    for file in distribution.files or ():
        name = file.as_posix()
        is_kept = name.startswith(kept)
        own = name.rpartition("/")[2] not in ("INSTALLER", "REQUESTED", "direct_url.json") and "__pycache__" not in name
        if is_kept and own:
            files[name] = Path(str(distribution.locate_file(file))).read_bytes()
    return files


#: Where a course keeps wheels that were compiled for other processors.
OTHERS = Path(FOLDER, "wheels")


def interface_wheels(course: Course, texts: Iterable[bytes], environment: Path = Path(sys.prefix)) -> dict[str, bytes]:
    """Return file name -> content of each wheel: the course's own packages, and those beyond PyPI's that it may use.

    `texts` are what students get to read; an optional package is included if it is named there, or if the course's
    interfaces need it. `environment` has the packages that come with Spinbook.

    Raises:
        SpinbookError: if the course's interfaces have faults or can't be compiled.
    """
    own = platform.machine()
    others = (path for path in sorted((course.root / OTHERS).glob("*.whl")) if not path.stem.endswith(f"_{own}"))
    found = {path.name: path.read_bytes() for path in others}
    found.update(wheel(package, prefix) for package, prefix in _packages(course, b"".join(texts), environment))
    return found


def package_of(wheel: str) -> str:
    """Return the ROS package in a wheel of interfaces, from the wheel's file name; empty for other wheels."""
    prefix, _, package = wheel.partition("-")[0].partition("compiled_interfaces_")
    return "" if prefix else package


def _packages(course: Course, text: bytes, environment: Path) -> Iterator[tuple[str, Path]]:
    """Yield the packages, each with the prefix that has it."""
    collected = collect(course)
    compiled = compile_course(course, collected)
    needed = {name for names in dependencies(collected.definitions).values() for name in names}
    for package in shipped.known():
        is_needed = package in shipped.standard() or package in needed or package.encode() in text
        if is_needed and prefixes.key_of(package, environment):
            yield package, environment
    if compiled:
        yield from ((package, compiled.prefix) for package in compiled.packages)


#: The platform in a wheel's name: the system, its oldest version, and the machine, such as manylinux_2_28_x86_64.
_PLATFORM = re.compile(r"[a-z]+(?:_\d+_\d+)?_(?P<machine>\w+)")


def requirement(file: str) -> str:
    """Return the line of requirements.txt for a wheel, with the machine and the Pythons that it was compiled for."""
    version, abi, named = file.removesuffix(".whl").split("-")[2:5]
    read = _PLATFORM.fullmatch(named)
    machine = f'platform_machine == "{read["machine"] if read else named}"'
    if abi in ("abi3", "none"):
        return f"./wheels/{file} ; {machine}"
    return f'./wheels/{file} ; python_version == "3.{version.removeprefix("cp3")}" and {machine}'
