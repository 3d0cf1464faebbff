"""Compiles the middleware for the ROS 2 in use, once: `python -m rmw_lockstep.build`."""

from __future__ import annotations

import contextlib
import fcntl
import json
import os
import shutil
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import ThreadPoolExecutor
from pathlib import Path

from rmw_lockstep.library import (
    DESCRIPTION,
    SOURCES,
    Library,
    UnavailableLibrary,
    compiler,
    description,
    key,
    library,
    library_folders,
    sources,
)
from rmw_lockstep.ros import Ros, installed_ros

_COMPILE = (
    *("-std=c++17", "-O2", "-fPIC", "-fvisibility=hidden", "-pthread", "-Wall", "-Wextra", "-c"),
    *("-ffunction-sections", "-fdata-sections", "-include", str(SOURCES / "lockstep/older_libraries.hpp")),
)
_LINK = ("-shared", "-s", "-pthread", "-Wl,-z,defs", "-Wl,--gc-sections")

#: liblockstep is loaded into every program. It includes its own C++ library, and exports only what the map lists.
#: libpthread and libdl have the functions in `older_libraries.hpp` before glibc 2.34, and are empty afterwards.
_ALONE = (
    *("-static-libstdc++", "-Wl,--exclude-libs,ALL"),
    f"-Wl,--version-script={SOURCES / 'lockstep/exports.map'}",
    *("-Wl,--push-state,--no-as-needed", "-l:libpthread.so.0", "-l:libdl.so.2", "-Wl,--pop-state"),
)

_STUB = "libnothing.so"

#: How many compilers run at once. Each takes about 300 MB.
_AT_ONCE = 2

#: How many earlier sets of libraries to keep for programs that still use them.
_KEPT_SETS = 3


class BuildError(Exception):
    """Raised when the compiler or the linker fails; the text has its output."""

    @property
    def first(self) -> str:
        """The first line that reports an error."""
        lines = [line.strip() for line in str(self).splitlines()]
        return next((line for line in lines if "error" in line.lower()), lines[0])


def build(announce: Callable[[], None] = lambda: None) -> Library | UnavailableLibrary:
    """Return the compiled middleware; compile it now if there is none yet (about 20 s, and 300 MB of memory).

    Of several processes one compiles, and the others wait for it. `announce` is called before that. Raises `BuildError`
    if the compiler or the linker fails.
    """
    available = library()
    ros = installed_ros()
    if isinstance(available, Library) or ros is None or ros.lacks_middleware or not sources() or compiler() is None:
        return available
    root = next((root for root in library_folders() if _writable(root)), None)
    if root is None:
        return UnavailableLibrary("no folder for it is writable", "Set HOME to a folder of your own.")
    announce()
    with _build_lock(root):
        available = library()  # another process may have compiled it meanwhile
        return available if isinstance(available, Library) else Library(_compiled(ros, root), ros.prefix)


def compile_into(folder: Path, ros: Ros) -> None:
    """Compile the libraries into an empty folder. Raises `BuildError`."""
    objects = folder / "objects"
    objects.mkdir()
    files = [file for file in sources() if file.suffix == ".cpp"]
    with ThreadPoolExecutor(_AT_ONCE) as pool:
        made = list(pool.map(lambda file: _compile(file, objects, ros), files))
    lockstep = [made for file, made in zip(files, made, strict=True) if file.is_relative_to(SOURCES / "lockstep")]
    rmw = [str(one) for one in made if one not in lockstep]
    _run([*_LINK, "-Wl,-soname,liblockstep.so", "-o", folder / "liblockstep.so", *lockstep, *_ALONE])
    for name, origin in (("librmw_lockstep_cpp.so", "$ORIGIN"), ("wheels/librmw_fastrtps_cpp.so", "$ORIGIN/..")):
        output = folder / name
        output.parent.mkdir(exist_ok=True)
        options = (f"-Wl,-soname,{output.name}", f"-Wl,-rpath,{origin}", "-o", output)
        _run([*_LINK, *options, *rmw, folder / "liblockstep.so", *ros.libraries])
    _replace_unused(folder / "wheels", ros)
    shutil.rmtree(objects)
    (folder / DESCRIPTION).write_text(json.dumps(description(ros), indent=1) + "\n", encoding="utf-8")


def _replace_unused(folder: Path, ros: Ros) -> None:
    """Make one empty stub for the libraries that the wheels are linked to but never call.

    Programs are forked from a process that has its libraries in memory: without these a fork is a tenth cheaper.
    """
    empty = folder / _STUB
    _run(["-shared", "-s", "-nostdlib", "-x", "c++", "/dev/null", "-o", empty])
    for name in ros.unused_libraries:
        (folder / name).symlink_to(empty.name)


def _compiled(ros: Ros, root: Path) -> Path:
    target = root / key(ros)
    with tempfile.TemporaryDirectory(prefix=".new-", dir=root, ignore_cleanup_errors=True) as temporary:
        folder = Path(temporary) / "set"
        folder.mkdir(mode=0o755)
        compile_into(folder, ros)
        folder.rename(target)
    _remove_old(root, target)
    return target


def _compile(file: Path, objects: Path, ros: Ros) -> Path:
    relative = file.relative_to(SOURCES)
    output = objects / f"{'-'.join(relative.with_suffix('').parts)}.o"
    # liblockstep runs in any program, even one without ROS 2.
    folders = () if relative.parts[0] == "lockstep" else ros.include_folders
    own = (SOURCES / "lockstep", SOURCES / "src", SOURCES)
    _run([*_COMPILE, file, "-o", output, *(f"-I{folder}" for folder in own), *(f"-isystem{f}" for f in folders)])
    return output


def _run(arguments: Sequence[str | Path]) -> None:
    command = [*(compiler() or ["g++"]), *map(str, arguments)]
    done = subprocess.run(command, capture_output=True, text=True, check=False)
    if done.returncode:
        raise BuildError(f"{command[0]} ended with {done.returncode}:\n{done.stderr.strip()}")


def _writable(root: Path) -> bool:
    with contextlib.suppress(OSError):
        root.mkdir(parents=True, exist_ok=True)
        return os.access(root, os.W_OK | os.X_OK)
    return False


@contextlib.contextmanager
def _build_lock(root: Path) -> Iterator[None]:
    """Let one of several processes compile while the others wait."""
    with (root / ".lock").open("w") as lock:
        fcntl.flock(lock, fcntl.LOCK_EX)
        yield


def _remove_old(root: Path, current: Path) -> None:
    old = [folder for folder in root.iterdir() if folder != current and not folder.name.startswith(".")]
    for folder in sorted(old, key=lambda folder: folder.stat().st_mtime, reverse=True)[_KEPT_SETS:]:
        shutil.rmtree(folder, ignore_errors=True)


def main() -> None:
    """Compile, and print the folder of the libraries; or print the reason why that is impossible and exit with 1."""
    try:
        found = build()
    except BuildError as error:
        sys.exit(f"The middleware rmw_lockstep could not be compiled. {error}")
    if isinstance(found, UnavailableLibrary):
        sys.exit(f"There is no middleware rmw_lockstep: {found.reason}. {found.remedy}")
    print(found.folder)


if __name__ == "__main__":
    main()
