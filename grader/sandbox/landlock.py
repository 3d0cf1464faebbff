"""On a machine without user namespaces: Landlock keeps a student's program away from the files of this machine.

Weaker than the namespaces: the program sees the ids and command lines of other processes. It can neither read the
memory of others nor, from Linux 6.12 on, signal them (before that, a seccomp filter refuses it every signal).

Source: landlock(7) and Documentation/userspace-api/landlock.rst of the Linux kernel.
"""

from __future__ import annotations

import ctypes
import os
import stat
from collections.abc import Sequence
from functools import cache
from pathlib import Path

from grader.sandbox import filesystem, syscalls
from grader.sandbox.filesystem import dedicated_user
from grader.sandbox.program import Paths

_CREATE_RULESET, _ADD_RULE, _RESTRICT_SELF = 444, 445, 446
_ASK_VERSION = 1
_RULE_PATH_BENEATH = 1

_EXECUTE, _WRITE_FILE, _READ_FILE, _READ_FOLDER = 1 << 0, 1 << 1, 1 << 2, 1 << 3
_FILES_FROM_VERSION_1 = (1 << 13) - 1
_REFER, _TRUNCATE, _DEVICE_CONTROL = 1 << 13, 1 << 14, 1 << 15  # versions 2, 3 and 5
_TCP_BIND_AND_CONNECT = 0b11  # version 4
_ABSTRACT_SOCKETS_AND_SIGNALS = 0b11  # version 6

_READ = _EXECUTE | _READ_FILE | _READ_FOLDER
_FILE_ONLY = _EXECUTE | _WRITE_FILE | _READ_FILE | _TRUNCATE | _DEVICE_CONTROL


@cache
def version() -> int:
    """Return the version of Landlock that the kernel supports; 0 if it has none or Landlock is switched off."""
    try:
        return syscalls.system_call(
            _CREATE_RULESET, None, ctypes.c_size_t(0), ctypes.c_uint32(_ASK_VERSION), what="landlock"
        )
    except OSError:
        return 0


def keeps_signals_inside() -> bool:
    """Return whether Landlock itself refuses signals to processes outside: version 6, Linux 6.12."""
    return version() >= 6


def student_user() -> int:
    """Return the user for a student's program. For root it is an unused one: the kernel limits no root processes.

    As root, raises OSError if that user cannot reach Python, or other folders that programs need.
    """
    if os.geteuid() != 0:
        return os.geteuid()
    for path in filesystem.interpreter():
        for folder in reversed(path.resolve().parents):
            if not folder.stat().st_mode & stat.S_IXOTH:
                raise OSError(_why_closed(path, folder))
    return dedicated_user()


def _why_closed(path: Path, folder: Path) -> str:
    if path in filesystem.python_folders():
        return (
            f"as root it needs a Python that other users can read, and this one is in {folder}. "
            "Set it up again with another one and elsewhere, as in: "
            "make PYTHON=/usr/bin/python3 VENV=/opt/spinbook setup"
        )
    return (
        f"as root it starts programs as another user, who can't enter {folder}, and they need {path}. "
        f"Move the course or the checkout that it belongs to elsewhere, or let others in: chmod o+x {folder}"
    )


def rules(readonly: Sequence[Path], hidden: Sequence[Path]) -> int:
    """Return a descriptor of the rules that all programs have: they may read Python, ROS 2 and /proc.

    In /proc a program's processes check whether they are idle. It then sees others' command lines; Landlock itself
    keeps their memory, environment and files closed. The runner makes the rules, so that no program's process has ever
    had the hidden paths in its memory. `readonly` is what else it may read. `hidden` is what it may not read, although
    it is inside something that it may; the names remain visible. Raises OSError if the kernel has no Landlock.
    """
    ruleset = _new_ruleset()
    for path in (*filesystem.system(), *filesystem.interpreter(), *readonly):
        _allow_reading(ruleset, path, [path.resolve() for path in (*filesystem.own_packages(), *hidden)])
    _allow(ruleset, Path("/proc"), _READ_FILE | _READ_FOLDER)
    for path in map(Path, ("/dev/null", "/dev/zero", "/dev/full", "/dev/random", "/dev/urandom")):
        _allow(ruleset, path, (_READ_FILE | _WRITE_FILE) & _file_rights())
    return ruleset


def restrict(ruleset: int, paths: Paths) -> None:
    """Confine this process, and everything it starts, to the rules, and to its own folders. Needs no_new_privs."""
    _allow(ruleset, Path(paths.folder), _READ)
    for path in (Path(paths.home), Path(paths.temporary)):
        _allow(ruleset, path, _file_rights())
    syscalls.system_call(_RESTRICT_SELF, ctypes.c_int(ruleset), ctypes.c_uint32(0), what="landlock_restrict_self")
    os.close(ruleset)


@cache
def _file_rights() -> int:
    files = _FILES_FROM_VERSION_1
    for since, right in ((2, _REFER), (3, _TRUNCATE), (5, _DEVICE_CONTROL)):
        files |= right if version() >= since else 0
    return files


def _new_ruleset() -> int:
    handled = (ctypes.c_uint64 * 3)(
        _file_rights(),
        _TCP_BIND_AND_CONNECT if version() >= 4 else 0,
        _ABSTRACT_SOCKETS_AND_SIGNALS if version() >= 6 else 0,
    )
    size = 24 if version() >= 6 else 16 if version() >= 4 else 8
    return syscalls.system_call(
        _CREATE_RULESET, handled, ctypes.c_size_t(size), ctypes.c_uint32(0), what="landlock_create_ruleset"
    )


def _allow_reading(ruleset: int, path: Path, hidden: Sequence[Path]) -> None:
    real = path.resolve()
    if real in hidden:
        return
    if not any(secret.is_relative_to(real) for secret in hidden):
        _allow(ruleset, path, _READ)
        return
    # Rights apply to everything below, so everything next to a hidden entry is allowed individually.
    _allow(ruleset, path, _READ_FOLDER)
    for piece in path.iterdir():
        _allow_reading(ruleset, piece, hidden)


def _allow(ruleset: int, path: Path, rights: int) -> None:
    if not path.exists():
        return
    opened = os.open(path, os.O_PATH | os.O_CLOEXEC)
    if not path.is_dir():
        rights &= _FILE_ONLY
    # struct landlock_path_beneath_attr is packed: 8 bytes of rights, 4 of the descriptor.
    rule = rights.to_bytes(8, "little") + opened.to_bytes(4, "little")
    syscalls.system_call(
        _ADD_RULE, ctypes.c_int(ruleset), ctypes.c_int(_RULE_PATH_BENEATH), rule, ctypes.c_uint32(0), what=str(path)
    )
    os.close(opened)
