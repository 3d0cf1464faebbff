"""The system calls that no student's node needs and that would weaken the sandbox: refused by a seccomp filter.

Denied are: inspecting other processes, changing mounts or namespaces, keys, kernel interfaces with a history of
holes, memory that no limit counts (System V shared memory, memfd), and all sockets except connected pairs. The filter
lists what is refused, and not what is allowed, so it never breaks a correct node. The confinement comes from namespaces
and from dropping all capabilities.

Source: seccomp(2), bpf(4), and the kernel's tables of system calls for x86-64 and arm64.
"""

from __future__ import annotations

import ctypes
import errno
import platform
import socket
import struct
from collections.abc import Sequence
from functools import cache

from grader.sandbox import syscalls

_X86_64 = 0xC000003E
_AARCH64 = 0xC00000B7
_X32_BIT = 0x40000000

_ALLOW = 0x7FFF0000
_ERRNO = 0x00050000
_KILL_PROCESS = 0x80000000
_MODE_FILTER = 2

_LOAD = 0x20  # BPF_LD | BPF_W | BPF_ABS
_EQUAL = 0x15  # BPF_JMP | BPF_JEQ | BPF_K
_ANY_BIT = 0x45  # BPF_JMP | BPF_JSET | BPF_K
_AND = 0x54  # BPF_ALU | BPF_AND | BPF_K
_RETURN = 0x06  # BPF_RET | BPF_K

_NUMBER_AT, _ARCHITECTURE_AT, _ARGUMENT_AT = 0, 4, 16  # offsets in struct seccomp_data, little-endian

_NEW_NAMESPACES = 0x7E020000  # every CLONE_NEW… flag of clone(2)

# name: (number on x86-64, number on arm64); None if it does not exist
_FORBIDDEN: dict[str, tuple[int | None, int | None]] = {
    "ptrace": (101, 117),
    "process_vm_readv": (310, 270),
    "process_vm_writev": (311, 271),
    "process_madvise": (440, 440),
    "pidfd_getfd": (438, 438),
    "kcmp": (312, 272),
    "mount": (165, 40),
    "umount2": (166, 39),
    "pivot_root": (155, 41),
    "chroot": (161, 51),
    "open_tree": (428, 428),
    "move_mount": (429, 429),
    "fsopen": (430, 430),
    "fsconfig": (431, 431),
    "fsmount": (432, 432),
    "fspick": (433, 433),
    "mount_setattr": (442, 442),
    "unshare": (272, 97),
    "setns": (308, 268),
    "name_to_handle_at": (303, 264),
    "open_by_handle_at": (304, 265),
    "sethostname": (170, 161),
    "setdomainname": (171, 162),
    "settimeofday": (164, 170),
    "clock_settime": (227, 112),
    "clock_adjtime": (305, 266),
    "adjtimex": (159, 171),
    "reboot": (169, 142),
    "swapon": (167, 224),
    "swapoff": (168, 225),
    "acct": (163, 89),
    "quotactl": (179, 60),
    "quotactl_fd": (443, 443),
    "syslog": (103, 116),
    "iopl": (172, None),
    "ioperm": (173, None),
    "modify_ldt": (154, None),
    "kexec_load": (246, 104),
    "kexec_file_load": (320, 294),
    "init_module": (175, 105),
    "finit_module": (313, 273),
    "delete_module": (176, 106),
    "add_key": (248, 217),
    "request_key": (249, 218),
    "keyctl": (250, 219),
    "bpf": (321, 280),
    "perf_event_open": (298, 241),
    "userfaultfd": (323, 282),
    "fanotify_init": (300, 262),
    "io_uring_setup": (425, 425),
    "io_uring_enter": (426, 426),
    "io_uring_register": (427, 427),
    "shmget": (29, 194),
    "shmat": (30, 196),
    "shmctl": (31, 195),
    "semget": (64, 190),
    "msgget": (68, 186),
    "mq_open": (240, 180),
    "memfd_secret": (447, 447),
    "connect": (42, 203),
}
# Reported as absent: callers then fall back to a call that is allowed.
_ABSENT: dict[str, tuple[int, int]] = {"memfd_create": (319, 279), "clone3": (435, 435)}
# Reported as successful: the runner has pinned the program to one core and it stays there.
_IGNORED: dict[str, tuple[int, int]] = {"sched_setaffinity": (203, 122)}
# Refused only if nothing else keeps signals inside (see `program_for`).
_SIGNALS: dict[str, tuple[int, int]] = {
    "kill": (62, 129),
    "tkill": (200, 130),
    "rt_sigqueueinfo": (129, 138),
    "pidfd_send_signal": (424, 424),
}
# No family of sockets exists. A program's processes get their connections to the hub by an inherited socket.
_NO_FAMILY: dict[str, tuple[int, int]] = {"socket": (41, 198)}
_CLONE = (56, 220)
_SOCKETPAIR = (53, 199)
# The types that are connected for good. A datagram socket of a pair can still send to any address.
_PAIRS = (socket.SOCK_STREAM, socket.SOCK_SEQPACKET)
_TYPE_BITS = 0xF  # the rest are flags (SOCK_TYPE_MASK in the kernel's net.h)

Instruction = tuple[int, int, int, int]


def supported() -> bool:
    """Return whether the numbers of this machine's system calls are known here."""
    return platform.machine() in ("x86_64", "aarch64")


@cache
def program(*, no_signals: bool = False) -> bytes:
    """Return the filter in the kernel's format (an array of struct sock_filter).

    With `no_signals` it also refuses every signal to another process, if neither a pid namespace nor Landlock does.
    Raises OSError for an architecture whose system calls are not known here.
    """
    if not supported():
        raise OSError(f"seccomp: the system calls of {platform.machine()} are not known here")
    column = 0 if platform.machine() == "x86_64" else 1
    forbidden = {name: pair[column] for name, pair in _FORBIDDEN.items()}
    if no_signals:
        forbidden |= {name: pair[column] for name, pair in _SIGNALS.items()}
    lines: list[Instruction] = [
        (_LOAD, 0, 0, _ARCHITECTURE_AT),
        (_EQUAL, 1, 0, (_X86_64, _AARCH64)[column]),
        (_RETURN, 0, 0, _KILL_PROCESS),
        (_LOAD, 0, 0, _NUMBER_AT),
    ]
    if column == 0:  # the second table of numbers that x86-64 has
        lines += [(_ANY_BIT, 0, 1, _X32_BIT), _refuse(errno.ENOSYS)]
    lines += _when([number for number in forbidden.values() if number is not None], errno.EPERM)
    lines += _when([pair[column] for pair in _ABSENT.values()], errno.ENOSYS)
    lines += _when([pair[column] for pair in _IGNORED.values()], 0)
    lines += _when([pair[column] for pair in _NO_FAMILY.values()], errno.EAFNOSUPPORT)
    lines += [
        (_EQUAL, 0, 4, _CLONE[column]),
        (_LOAD, 0, 0, _ARGUMENT_AT),
        (_ANY_BIT, 0, 1, _NEW_NAMESPACES),
        _refuse(errno.EPERM),
        (_RETURN, 0, 0, _ALLOW),
        (_EQUAL, 0, 5, _SOCKETPAIR[column]),
        (_LOAD, 0, 0, _ARGUMENT_AT + 8),
        (_AND, 0, 0, _TYPE_BITS),
        (_EQUAL, 2, 0, int(_PAIRS[0])),
        (_EQUAL, 1, 0, int(_PAIRS[1])),
        _refuse(errno.EPERM),
        (_RETURN, 0, 0, _ALLOW),
    ]
    return b"".join(struct.pack("=HBBI", *line) for line in lines)


class _Program(ctypes.Structure):
    """`struct sock_fprog`."""

    _fields_ = (("length", ctypes.c_ushort), ("filter", ctypes.c_char_p))


def install(filter_program: bytes) -> None:
    """Install the filter in this process and all that it will start, for good. Needs no_new_privs: prctl(2)."""
    described = _Program(len(filter_program) // 8, filter_program)
    syscalls.prctl(syscalls.PR_SET_SECCOMP, _MODE_FILTER, ctypes.byref(described))


def _refuse(error: int) -> Instruction:
    return (_RETURN, 0, 0, _ERRNO | error)


def _when(numbers: Sequence[int], error: int) -> list[Instruction]:
    """Return the lines that fail the call with this error if it is one of these. Jumps reach 255 lines at most."""
    tests = [(_EQUAL, len(numbers) - at, 0, number) for at, number in enumerate(numbers)]
    # After the last test: skip the refusal. A jump of `k` lines without a condition is BPF_JMP | BPF_JA.
    return [*tests, (0x05, 0, 0, 1), _refuse(error)]
