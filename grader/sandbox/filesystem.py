"""The file system inside a sandbox: the mounts that build its root."""

from __future__ import annotations

import os
import stat
import sys
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cache, lru_cache
from pathlib import Path
from typing import Literal

import groundwork
import interface_compiler
import rmw_lockstep
import ros_in_python
from grader.sandbox.middleware import library_folder
from grader.sandbox.program import SUBMISSION
from groundwork.clean_environment import own_path
from interface_compiler import activation

HOME = "/home/student"
USER_ID = 1000

# Users that systemd reserves for services with dynamic users; no files belong to them.
_FIRST, _COUNT = 61184, 4336


def dedicated_user() -> int:
    """Return a user number for a student whom root starts; it differs from one supervisor process to the next."""
    return _FIRST + os.getpid() % _COUNT


_PARTS = ("bin", "sbin", "lib", "lib32", "lib64", "libx32", "libexec", "share", "pyvenv.cfg")
_DEVICES = ("null", "zero", "full", "random", "urandom")
_ETC = ("ld.so.cache", "alternatives", "localtime", "timezone")
#: The text files of every sandbox.
TEXTS = {
    "/etc/passwd": f"student:x:{USER_ID}:{USER_ID}:student:{HOME}:/bin/sh\n",
    "/etc/group": f"student:x:{USER_ID}:\n",
    "/etc/hosts": "127.0.0.1 localhost\n",
    "/etc/nsswitch.conf": "passwd: files\ngroup: files\nhosts: files\n",
}

Action = Literal["folder", "scratch", "bind", "mask", "device", "link", "text", "processes", "seal"]


@dataclass(frozen=True)
class Mount:
    """One step of building the root.

    - folder: an empty folder
    - scratch: a tmpfs of `size` bytes that every user may write to
    - bind: the file or folder at `path` outside, or at `content` if that is given, read-only
    - mask: the file or folder at `path`, which a bind has shown, becomes empty
    - device: the device at `path` outside
    - link: a symbolic link to `content`
    - text: a file that contains `content`
    - processes: /proc
    - seal: what has been mounted at `path` becomes read-only
    """

    action: Action
    path: str
    content: str = ""
    size: int = 0


@lru_cache(maxsize=8)
def mounts(readonly: tuple[Path, ...], hidden: tuple[Path, ...], scratch_bytes: int) -> tuple[Mount, ...]:
    """Return the steps that build a root, in order.

    `readonly` is what is shown besides Python and ROS 2. `hidden` is what is not shown, although it is inside something
    that is. `scratch_bytes` is the size of each writable path.
    """
    shown = list(_without_nested([*interpreter(), *readonly]))
    plan = _MountPlan()
    for place in ("/tmp", HOME):
        plan.add("scratch", place, size=scratch_bytes)
    plan.add("folder", SUBMISSION)
    plan.add("folder", "/dev")
    for device in _DEVICES:
        plan.add("device", f"/dev/{device}")
    plan.add("scratch", "/dev/shm", size=scratch_bytes)
    for name, target in {"fd": "", "stdin": "/0", "stdout": "/1", "stderr": "/2"}.items():
        plan.add("link", f"/dev/{name}", f"/proc/self/fd{target}")
    plan.add("processes", "/proc")
    everything = (*system(), *shown)
    links = [path for path in everything if path.is_symlink() and _is_inside(path, set(everything) - {path})]
    bound = [path for path in everything if path not in links]
    for path in bound:
        plan.add("bind", str(path))
    for path in links:
        plan.add("link", str(path), str(path.readlink()))
    for path_of_text, text in TEXTS.items():
        plan.add("text", path_of_text, text)
    masks = sorted(set(_masks((*own_packages(), *hidden), bound)))
    for mask in masks:
        plan.add("mask", str(mask))
    for path in readonly:
        if _is_inside(path, masks):  # requested by name, in a folder that is otherwise hidden
            plan.add("bind", str(path))
    for mask in masks:
        if mask.is_dir():
            plan.add("seal", str(mask))
    plan.add("seal", "/")
    return tuple(plan.steps)


class _MountPlan:
    """Collects steps, each after those that make its parent folders."""

    def __init__(self) -> None:
        self.steps: list[Mount] = []
        self._made: set[str] = {"/"}
        self._bound: set[str] = set()

    def add(self, action: Action, path: str, content: str = "", size: int = 0) -> None:
        for parent in map(str, reversed(Path(path).parents)):
            if parent in self._bound:
                break
            if parent not in self._made:
                self._made.add(parent)
                self.steps.append(Mount("folder", parent))
        if action == "bind":
            self._bound.add(path)
        self._made.add(path)
        self.steps.append(Mount(action, path, content, size))


def memory_file(content: bytes) -> int:
    """Return the descriptor of a file without a name, ready to be read from its beginning."""
    number = os.memfd_create("sandbox")
    with os.fdopen(number, "wb", closefd=False) as file:
        file.write(content)
    os.lseek(number, 0, os.SEEK_SET)
    return number


def write_file(folder: Path, name: str, content: bytes) -> None:
    """Write a submission's file, readable by every user, and its parent folders."""
    path = folder / name
    for parent in reversed(list(path.relative_to(folder).parents)[:-1]):
        (folder / parent).mkdir(exist_ok=True)
        (folder / parent).chmod(0o755)
    path.write_bytes(content)
    path.chmod(0o444)


def ros_prefixes() -> tuple[Path, ...]:
    """Return where a sourced ROS 2 is installed (/opt/ros/…); nothing if ROS 2 was installed from PyPI.

    An instructor's own workspace, sourced on top of it, is not part of it.
    """
    prefixes = [Path(path) for path in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if path]
    return tuple(path for path in prefixes if path.is_relative_to("/opt/ros") and path.is_dir())


@cache
def system() -> tuple[Path, ...]:
    """Return the system's libraries and programs, and its symlinks such as /lib -> usr/lib."""
    top = [Path("/", name) for name in ("bin", "sbin", "lib", "lib32", "lib64", "libx32")]
    user = [Path(folder, name) for folder in ("/usr", "/usr/local") for name in _PARTS]
    etc = [Path("/etc", name) for name in _ETC]
    return tuple(path for path in (*top, *user, *etc) if path.exists() and _readable_kind(path))


@cache
def interpreter() -> tuple[Path, ...]:
    """Return the folders of this Python, of ROS 2, and of a course's interfaces."""
    library = filter(None, (library_folder(),))
    # tf2 and its kin, and what they import: in a checkout, they are not among the environment's libraries.
    in_python = [Path(module.__file__).parent for module in (ros_in_python, interface_compiler) if module.__file__]
    return tuple(
        path
        for path in (*python_folders(), *ros_prefixes(), *library, *in_python, *activation.active())
        if path.exists()
    )


def python_folders() -> list[Path]:
    """Return the folders of this Python, and of its environment's base Python."""
    prefixes: dict[Path, None] = {}
    for prefix in (sys.prefix, sys.exec_prefix, sys.base_prefix, sys.base_exec_prefix):
        prefixes[Path(prefix)] = None
        prefixes[Path(prefix).resolve()] = None
    prefixes[Path(sys.executable).resolve().parents[1]] = None
    return [prefix / part for prefix in prefixes for part in _PARTS if prefix != Path("/usr")]


def closed_to_others() -> list[Path]:
    """Return what a program would be shown of Python, of ROS 2 and of modules, and only its owner can read."""
    folders = [path for path in (*interpreter(), *map(Path, own_path(sys.path))) if path.is_dir()]
    # A module that was installed later may be closed alone.
    entries = (entry for folder in folders for entry in os.scandir(folder) if entry.name.isidentifier())
    modules = [Path(entry.path) for entry in entries if entry.is_dir() and entry.name != "__pycache__"]
    readable = stat.S_IROTH | stat.S_IXOTH
    return [path for path in dict.fromkeys((*folders, *modules)) if path.stat().st_mode & readable != readable]


def own_packages() -> tuple[Path, ...]:
    """Return this package and Spinbook's others: if installed, they are among the libraries that a sandbox shows."""
    grader = Path(__file__).resolve().parents[1]
    files = (groundwork.__file__, rmw_lockstep.__file__)
    return (grader, grader.with_name("spinbook"), *(Path(file).resolve().parent for file in files))


def _masks(hidden: Iterable[Path], shown: Iterable[Path]) -> Iterator[Path]:
    """Yield the paths at which hidden files and folders would be visible below a shown folder."""
    to_hide = [path.resolve() for path in hidden if path.exists()]
    for source in shown:
        real = _real(source)
        for path in to_hide:
            if path.is_relative_to(real):
                yield source / path.relative_to(real)


def _is_inside(path: Path, folders: Iterable[Path]) -> bool:
    real = path.resolve()
    return any(real.is_relative_to(_real(folder)) for folder in folders)


@cache
def _real(folder: Path) -> Path:
    """Return the real path of an installation's folder; cached, as none moves while a grader runs."""
    return folder.resolve()


def _without_nested(paths: Iterable[Path]) -> Iterator[Path]:
    """Yield the folders, without those inside another one, which are shown anyway."""
    ordered = sorted(set(paths), key=lambda path: len(path.parts))
    for at, path in enumerate(ordered):
        if not any(path.is_relative_to(earlier) and not path.is_symlink() for earlier in ordered[:at]):
            yield path


def _readable_kind(path: Path) -> bool:
    mode = path.stat().st_mode
    return stat.S_ISDIR(mode) or stat.S_ISREG(mode)
