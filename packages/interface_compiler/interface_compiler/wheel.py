"""Makes a reproducible wheel of a compiled package, for Python 3.10 and later.

A wheel is a zip whose RECORD lists every file with its hash (PEP 427, and "Recording installed projects").
"""

from __future__ import annotations

import base64
import csv
import hashlib
import io
import stat
import subprocess
import sys
import sysconfig
import tempfile
import zipfile
from collections.abc import Iterator, Mapping, Sequence
from importlib import metadata
from pathlib import Path

from interface_compiler import prefixes, shipped, store
from interface_compiler.checks import dependencies
from interface_compiler.definition import CompileError
from interface_compiler.prefixes import PYTHON, RESOURCES

_VERSION = "0.1.0"
#: Python 3.10 and later, as limited_api.h allows nothing else.
_PYTHONS = "cp310-abi3"


def wheel(package: str, prefix: Path) -> tuple[str, bytes]:
    """Return the file name and content of the wheel with one package of a prefix.

    Its version ends in the package's key, so that pip replaces one that was made from other definitions.
    """
    version = f"{_VERSION}+{prefixes.key_of(package, prefix)}"
    name = f"{_project(package).replace('-', '_')}-{version}"
    tag = f"{_PYTHONS}-{wheel_platform()}"
    files = dict(_files(package, prefix, f"{name}.data/data"))
    files[f"{name}.dist-info/METADATA"] = (
        f"Metadata-Version: 2.1\nName: {_project(package)}\nVersion: {version}\n"
        f"Summary: The ROS 2 interfaces of {package}, compiled by interface_compiler\n"
    ).encode()
    files[f"{name}.dist-info/WHEEL"] = (
        f"Wheel-Version: 1.0\nGenerator: interface_compiler\nRoot-Is-Purelib: false\nTag: {tag}\n".encode()
    )
    listing = f"{name}.dist-info/RECORD"
    files[listing] = record(files, listing)
    return f"{name}-{tag}.whl", zipped(files, last=listing)


def wheel_platform() -> str:
    """Return the platform in the name of a wheel that is compiled here, such as `linux_x86_64`."""
    return sysconfig.get_platform().replace("-", "_").replace(".", "_")


def record(files: dict[str, bytes], listing: str) -> bytes:
    """Return the content of a wheel's RECORD, which is the file `listing` itself."""
    out = io.StringIO()
    writer = csv.writer(out, lineterminator="\n")
    for name in sorted(set(files) - {listing}):
        digest = base64.urlsafe_b64encode(hashlib.sha256(files[name]).digest()).rstrip(b"=").decode()
        writer.writerow((name, f"sha256={digest}", len(files[name])))
    writer.writerow((listing, "", ""))
    return out.getvalue().encode()


def install(package: str) -> bool:
    """Compile and install a package that comes with this package. Return False if it is there already.

    Raises KeyError for any other package, and CompileError if it can't be compiled or installed.
    """
    definitions = shipped.definitions(package)
    if is_current(package):
        return False
    with tempfile.TemporaryDirectory(prefix="interfaces-") as temporary:
        compiled = store.ensure(definitions, Path(temporary))
        name, content = wheel(package, compiled.prefix)
        file = Path(temporary) / name
        file.write_bytes(content)
        _pip_install([file])
    return True


def needed(package: str) -> list[str]:
    """Return the packages that a shipped package needs, each after those that it needs itself."""
    found: list[str] = []
    for name in sorted(dependencies(shipped.definitions(package))[package]):
        if name in (*shipped.standard(), *shipped.optional()):
            found += [each for each in (*needed(name), name) if each not in found]
    return found


def is_current(package: str) -> bool:
    """Return whether this environment has the wheel of exactly these definitions, made by exactly this compiler."""
    definitions = shipped.definitions(package)
    try:
        version = metadata.version(_project(package))
    except metadata.PackageNotFoundError:
        return False
    return version == f"{_VERSION}+{store.keys(definitions)[package]}"


def _project(package: str) -> str:
    return f"compiled-interfaces-{package.replace('_', '-')}"


def _files(package: str, prefix: Path, data: str) -> Iterator[tuple[str, bytes]]:
    """Yield the wheel's own files by name: the Python package, and files for the environment's share and include."""
    for file in _below(prefix / PYTHON / package):
        if "__pycache__" not in file.parts:
            yield file.relative_to(prefix / PYTHON).as_posix(), file.read_bytes()
    markers = sorted((prefix / RESOURCES).glob(f"*/{package}"))
    for file in (*_below(prefix / "share" / package), *_below(prefix / "include" / package), *markers):
        yield f"{data}/{file.relative_to(prefix).as_posix()}", file.read_bytes()


def _below(folder: Path) -> list[Path]:
    return sorted(file for file in folder.rglob("*") if file.is_file())


def _pip_install(files: Sequence[Path]) -> None:
    options = ["--quiet", "--disable-pip-version-check", "--no-deps", "--no-index"]
    command = [sys.executable, "-m", "pip", "install", *options, *map(str, files)]
    done = subprocess.run(command, capture_output=True, text=True, errors="replace", check=False)
    if done.returncode:
        error = (done.stderr.strip().splitlines() or [f"pip ended with exit code {done.returncode}"])[-1]
        raise CompileError(f"The compiled package could not be installed with pip: {error}")


#: The earliest date that a zip can contain.
_DATE = (1980, 1, 1, 0, 0, 0)


def zipped(files: Mapping[str, bytes], last: str = "") -> bytes:
    """Return an archive of `files`, sorted by name; `last` names one that goes to the end."""
    out = io.BytesIO()
    with zipfile.ZipFile(out, "w") as archive:
        for name in sorted(files, key=lambda name: (name == last, name)):
            entry = zipfile.ZipInfo(name, _DATE)
            entry.create_system = 3
            entry.compress_type = zipfile.ZIP_DEFLATED
            entry.external_attr = (stat.S_IFREG | 0o644) << 16
            archive.writestr(entry, files[name])
    return out.getvalue()
