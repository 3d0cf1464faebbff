"""The Linux system calls that the sandbox needs and Python 3.10 lacks; each raises OSError."""

from __future__ import annotations

import ctypes
import os
import platform

CLONE_NEWNS = 0x00020000
CLONE_NEWUTS = 0x04000000
CLONE_NEWIPC = 0x08000000
CLONE_NEWUSER = 0x10000000
CLONE_NEWPID = 0x20000000
CLONE_NEWNET = 0x40000000

MS_RDONLY = 1
MS_NOSUID = 2
MS_NODEV = 4
MS_NOEXEC = 8
MS_REMOUNT = 32
MS_BIND = 4096
MS_REC = 16384
MS_PRIVATE = 1 << 18
MNT_DETACH = 2

MOUNT_ATTR_RDONLY = 1
MOUNT_ATTR_NOSUID = 2
MOUNT_ATTR_NODEV = 4
_AT_FDCWD = -100
_AT_RECURSIVE = 0x8000

PR_SET_PDEATHSIG = 1
PR_SET_DUMPABLE = 4
PR_SET_NAME = 15
PR_SET_SECCOMP = 22
PR_CAPBSET_DROP = 24
PR_SET_CHILD_SUBREAPER = 36
PR_SET_NO_NEW_PRIVS = 38

_MOUNT_SETATTR = 442  # the same number on every architecture, as all calls since Linux 5.1
_PIVOT_ROOT = {"x86_64": 155, "aarch64": 41}
_CAPABILITY_VERSION_3 = 0x20080522

_libc = ctypes.CDLL(None, use_errno=True)


def libc_call(name: str, *arguments: object, what: str = "", of: ctypes.CDLL = _libc) -> int:
    """Call a C library function and return its result; a result of -1 raises OSError with `what` in its text."""
    result: int = getattr(of, name)(*arguments)
    if result == -1:
        error = ctypes.get_errno()
        raise OSError(error, f"{what or name}: {os.strerror(error)}")
    return result


def system_call(number: int, *arguments: object, what: str) -> int:
    """Call the kernel by number, for what the C library has no function for: see syscall(2)."""
    return libc_call("syscall", ctypes.c_long(number), *arguments, what=what)


def unshare(flags: int) -> None:
    """Give this process new namespaces: unshare(2)."""
    libc_call("unshare", ctypes.c_int(flags), what=f"unshare({flags:#x})")


def setns(namespace: int, kind: int = 0) -> None:
    """Move this process into the namespace of the descriptor: setns(2)."""
    libc_call("setns", ctypes.c_int(namespace), ctypes.c_int(kind), what="setns")


def mount(source: str, target: str, kind: str = "", flags: int = 0, options: str = "") -> None:
    """Mount, bind or change a mount: mount(2)."""
    libc_call(
        "mount",
        os.fsencode(source),
        os.fsencode(target),
        kind.encode() or None,
        ctypes.c_ulong(flags),
        options.encode() or None,
        what=f"mount {source or kind} on {target}",
    )


def make_read_only(target: str, *, devices: bool = False) -> None:
    """Make a mount and all mounts below it read-only and free of set-uid programs: mount_setattr(2), Linux 5.12."""
    attributes = MOUNT_ATTR_RDONLY | MOUNT_ATTR_NOSUID | (0 if devices else MOUNT_ATTR_NODEV)
    change = (ctypes.c_uint64 * 4)(attributes, 0, 0, 0)
    system_call(
        _MOUNT_SETATTR,
        ctypes.c_int(_AT_FDCWD),
        os.fsencode(target),
        ctypes.c_uint(_AT_RECURSIVE),
        ctypes.byref(change),
        ctypes.c_size_t(ctypes.sizeof(change)),
        what=f"mount_setattr {target}",
    )


def unmount(target: str) -> None:
    """Remove a mount, at once for new users, later for those who still hold it: umount2(2)."""
    libc_call("umount2", os.fsencode(target), ctypes.c_int(MNT_DETACH), what=f"umount {target}")


def pivot_root(new: str, old: str) -> None:
    """Make `new` the root of this mount namespace and put the former one at `old`: pivot_root(2)."""
    number = _PIVOT_ROOT.get(platform.machine())
    if number is None:
        raise OSError(f"pivot_root: not known for {platform.machine()}")
    system_call(number, os.fsencode(new), os.fsencode(old), what="pivot_root")


def prctl(option: int, argument: int | bytes, pointer: object = None) -> None:
    """Change an attribute of this process: prctl(2)."""
    first = argument if isinstance(argument, bytes) else ctypes.c_ulong(argument)
    nothing = ctypes.c_ulong(0)
    libc_call("prctl", ctypes.c_int(option), first, pointer or nothing, nothing, nothing, what=f"prctl({option})")


def sethostname(name: str) -> None:
    """Name the host of this UTS namespace: sethostname(2)."""
    libc_call("sethostname", name.encode(), ctypes.c_size_t(len(name)), what="sethostname")


def drop_bounding_capabilities() -> None:
    """Let no program gain a capability that is executed from now on: capabilities(7). Needs CAP_SETPCAP."""
    for capability in range(64):
        try:
            prctl(PR_CAPBSET_DROP, capability)
        except OSError:
            return  # the first number that the kernel does not know


def drop_capabilities() -> None:
    """Give up every capability of this process: capset(2)."""
    header = (ctypes.c_uint32 * 2)(_CAPABILITY_VERSION_3, 0)
    data = (ctypes.c_uint32 * 6)()
    libc_call("capset", ctypes.byref(header), ctypes.byref(data), what="capset")
