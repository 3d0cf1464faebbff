"""The wheel of this software: built from its checkout, or put together again from the files that are installed."""

from __future__ import annotations

import contextlib
import hashlib
import io
import shutil
import subprocess
import sys
import tempfile
import zipfile
from collections.abc import Mapping
from importlib import metadata
from pathlib import Path

from grader.gradescope.pins import NAME
from groundwork.files import cached, write_if_changed
from groundwork.problem import AuthorError, Problem
from interface_compiler.wheel_file import record, zipped

#: The root of a checkout: the folder with pyproject.toml.
SOURCE = Path(__file__).parents[2]

_SOURCES = ("pyproject.toml", "README.md", "LICENSE", "spinbook", "grader", "packages")
_BUILD = "import sys; from setuptools.build_meta import build_wheel; print(build_wheel(sys.argv[1]))"
#: The files that the installer adds to a wheel's own.
_INSTALLERS = ("INSTALLER", "REQUESTED", "direct_url.json")


class NoWheel(AuthorError):
    """Raised if the wheel can't be made, with what to do."""

    def __init__(self, why: str, fix: str) -> None:
        super().__init__(Problem(SOURCE, None, f"the wheel of Spinbook could not be built: {why}", fix))


def is_checkout() -> bool:
    """Return whether this software runs from a checkout."""
    return (SOURCE / "pyproject.toml").is_file()


def wheel_contents() -> dict[str, bytes]:
    """Return the files of the wheel by name. Raises `NoWheel`."""
    return _built() if is_checkout() else _installed()


def as_wheel(files: Mapping[str, bytes]) -> tuple[str, bytes]:
    """Return the file name and content of the wheel with these files; its RECORD is written anew."""
    described = next(name for name in files if name.endswith(".dist-info/METADATA")).rpartition("/")[0]
    listing = f"{described}/RECORD"
    content = {**files, listing: record(files, listing)}
    return f"{described.removesuffix('.dist-info')}-py3-none-any.whl", zipped(content, last=listing)


def _built() -> dict[str, bytes]:
    """Return what setuptools makes from the checkout, which is not changed. Build it again only if a file has changed.

    The builds of other files are removed.
    """
    kept = cached("wheels") / f"{_key()}.whl"
    try:
        content = kept.read_bytes()
    except OSError:
        content = _build()
        with contextlib.suppress(OSError):  # without a cache, it is built each time
            write_if_changed(kept, content)
            for other in set(kept.parent.glob("*.whl")) - {kept}:
                other.unlink(missing_ok=True)
    with zipfile.ZipFile(io.BytesIO(content)) as archive:
        return {name: archive.read(name) for name in archive.namelist() if not name.endswith("/")}


def _key() -> str:
    """Return a digest of everything that decides the wheel."""
    tools = [sys.version, *(setuptools.version for setuptools in metadata.distributions(name="setuptools"))]
    total = hashlib.sha256(repr(tools).encode())
    paths = [path for name in _SOURCES for path in (SOURCE / name, *sorted((SOURCE / name).rglob("*")))]
    for path in paths:
        if path.is_file() and "__pycache__" not in path.parts:
            content = path.read_bytes()
            total.update(f"{path.relative_to(SOURCE)}\0{len(content)}\0".encode() + content)
    return total.hexdigest()[:16]


def _build() -> bytes:
    """Let setuptools build the wheel, in a copy of the checkout."""
    with tempfile.TemporaryDirectory(prefix="spinbook-") as temporary:
        copy, out = Path(temporary) / "source", Path(temporary) / "out"
        copy.mkdir()
        for name in _SOURCES:
            if (SOURCE / name).is_dir():
                shutil.copytree(SOURCE / name, copy / name, ignore=shutil.ignore_patterns("__pycache__"))
            elif (SOURCE / name).exists():
                shutil.copy(SOURCE / name, copy)
        done = subprocess.run(
            [sys.executable, "-c", _BUILD, str(out)], cwd=copy, capture_output=True, text=True, check=False
        )
        wheels = list(out.glob("*.whl"))
        if done.returncode or not wheels:
            error = (done.stderr.strip().splitlines() or ["setuptools said nothing"])[-1]
            raise NoWheel(error, 'It is built with setuptools: pip install "setuptools>=77,<80"')
        return wheels[0].read_bytes()


def _installed() -> dict[str, bytes]:
    """Return the files of the installed Spinbook: for a package of pure Python, what was in its wheel.

    See "Recording installed projects" in the Python Packaging User Guide.
    """
    with contextlib.suppress(metadata.PackageNotFoundError):
        distribution = metadata.distribution(NAME)
        names = {file.as_posix(): file for file in distribution.files or ()}
        own = {
            name: Path(str(distribution.locate_file(file))).read_bytes()
            for name, file in names.items()
            if not name.startswith("..") and "__pycache__" not in name and file.name not in _INSTALLERS
        }
        if "grader/__init__.py" in own:
            return own
    raise NoWheel("it is installed neither from a wheel nor in a checkout", "pip install it from a wheel.")
