"""Stores compiled packages until something that they are made from changes."""

from __future__ import annotations

import contextlib
import fcntl
import functools
import hashlib
import os
import platform
import shutil
import subprocess
import sys
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path

from interface_compiler import checks, prefixes, toolchain
from interface_compiler.definition import CompileError, Definition, DefinitionError, by_package
from interface_compiler.prefix_builder import DEFINITIONS
from interface_compiler.prefixes import PYTHON, RESOURCES

#: Wheels whose version affects the generated code.
_WHEELS = ("ros-rosidl-adapter", "ros-rosidl-generator-py", "ros-rosidl-typesupport-fastrtps-c", "ros-fastcdr")
#: The files of this folder that also affect it.
_OWN = ("generators.py", "gcc.py", "prefix_builder.py", "dispatch.cpp.in", "limited_api.h")
#: How many prefixes a store keeps: open notebooks may still use an earlier one.
_KEPT = 8


@dataclass(frozen=True)
class CompiledPackages:
    """Packages that were compiled into a prefix, and whether that was done just now."""

    prefix: Path
    packages: tuple[str, ...]
    fresh: bool = False

    @property
    def python(self) -> Path:
        """The folder for PYTHONPATH."""
        return self.prefix / PYTHON

    @property
    def key(self) -> str:
        """The key of the definitions and everything else that decides the result."""
        return self.prefix.name


def ensure(definitions: Sequence[Definition], store: Path) -> CompiledPackages:
    """Return the compiled packages of these definitions, compiled now if they are not in the store yet.

    If two processes need the same packages, one waits for the other. Raises `DefinitionError` if a definition is wrong,
    and `CompileError` if this machine can't compile.
    """
    package_keys = keys(definitions)
    prefix = _prefix(package_keys, store)
    packages = tuple(package_keys)
    if not prefix.is_dir():
        _check(definitions)
        with _locked(store):
            if not prefix.is_dir():
                _compile(definitions, package_keys, prefix)
                _prune(store, prefix)
                return CompiledPackages(prefix, packages, fresh=True)
    return CompiledPackages(prefix, packages)


def find(definitions: Sequence[Definition], store: Path) -> CompiledPackages | None:
    """Return the compiled packages of these definitions, if the store has them."""
    found = keys(definitions)
    prefix = _prefix(found, store)
    return CompiledPackages(prefix, tuple(found)) if prefix.is_dir() else None


def _prefix(found: Mapping[str, str], store: Path) -> Path:
    """Return the prefix of packages with these keys. Each version of Python has its own, though a wheel fits all."""
    return store.resolve() / digest(PYTHON.as_posix(), *found.values())


def digest(*texts: str) -> str:
    """Return the SHA-256 of these texts and their boundaries, the first 16 hexadecimal digits."""
    total = hashlib.sha256()
    for text in texts:
        data = text.encode()
        total.update(f"{len(data)}\n".encode() + data)
    return total.hexdigest()[:16]


def _check(definitions: Sequence[Definition]) -> None:
    faults = checks.check(definitions, prefixes.interfaces(prefixes.installed()))
    if faults:
        raise DefinitionError(faults)


def keys(definitions: Sequence[Definition]) -> dict[str, str]:
    """Return package -> its key. It differs if any text differs, even in a package that this one needs."""
    packages = by_package(definitions)
    plain = {
        package: digest(_machine(), package, *(part for item in members for part in (item.path, item.text)))
        for package, members in packages.items()
    }
    if len(plain) < 2:
        return plain
    # Which package needs which is known only after parsing: with several, each depends on all.
    return {package: digest(key, *plain.values()) for package, key in plain.items()}


@functools.cache
def _machine() -> str:
    """Return what decides the result besides the definitions: how it is made here, the CPU, and ROS's generators."""
    own = [Path(__file__).with_name(name) for name in _OWN]
    parts = [platform.machine(), *(file.read_text(encoding="utf-8") for file in own)]
    for wheel in _WHEELS:
        with contextlib.suppress(metadata.PackageNotFoundError):
            parts.append(f"{wheel} {metadata.version(wheel)}")
    return digest(*parts)


@contextlib.contextmanager
def _locked(store: Path) -> Iterator[None]:
    store.mkdir(parents=True, exist_ok=True)
    with (store / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def _compile(definitions: Sequence[Definition], found: dict[str, str], prefix: Path) -> None:
    """Compile everything next to its final place and move it there once it is complete."""
    if reason := toolchain.missing():
        raise CompileError(reason)
    unfinished = prefix.with_name(f"{prefix.name}.part")
    shutil.rmtree(unfinished, ignore_errors=True)
    for definition in definitions:
        file = unfinished / DEFINITIONS / definition.package / definition.path
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(definition.text, encoding="utf-8")
    _run_compiler(unfinished, checks.in_order(definitions))
    for package, key in found.items():
        (unfinished / "share" / package / prefixes.KEY).write_text(key, encoding="utf-8")
    # Whatever the umask: where root grades, students' programs read them as another user.
    for path in (unfinished, *unfinished.rglob("*")):
        path.chmod(0o755 if path.is_dir() else 0o644)
    unfinished.rename(prefix)


def _run_compiler(prefix: Path, packages: Sequence[str]) -> None:
    command = [sys.executable, "-m", "interface_compiler.prefix_builder", str(prefix), *packages]
    environment = {**os.environ, "PYTHONPATH": _python_path()}
    done = subprocess.run(command, capture_output=True, text=True, errors="replace", env=environment, check=False)
    if done.returncode == 0:
        return
    output = done.stderr.strip().splitlines() or [f"it ended with exit code {done.returncode}"]
    if done.returncode == 1 and len(output) == 1:
        raise CompileError(output[0])
    raise CompileError(f"ROS's code generators failed on {', '.join(packages)}: {output[-1]}")


def _python_path() -> str:
    """Return PYTHONPATH with the folder of this package, which a process started elsewhere might not find."""
    here = str(Path(__file__).resolve().parents[1])
    return os.pathsep.join(filter(None, [os.environ.get("PYTHONPATH"), here]))


def _prune(store: Path, newest: Path) -> None:
    """Remove the oldest prefixes beyond those that are kept."""
    old = [folder for folder in store.iterdir() if folder.is_dir() and folder != newest]
    old.sort(key=lambda folder: folder.stat().st_mtime, reverse=True)
    for folder in old[_KEPT - 1 :]:
        shutil.rmtree(folder, ignore_errors=True)


def is_installed(package: str, members: Sequence[Definition], places: Sequence[Path]) -> bool:
    """Return whether one of these prefixes has the package with exactly these definitions."""
    prefix = prefixes.prefix_of(package, places)
    if prefix is None or not (prefix / RESOURCES / "rosidl_interfaces" / package).is_file():
        return False
    return prefixes.definitions_of(package, prefix) == {item.path: item.text for item in members}
