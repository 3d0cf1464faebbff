"""Whether this user may make the kernel's namespaces, of which the grader's sandboxes are made."""

from __future__ import annotations

import os
import shutil
import subprocess
from pathlib import Path

from spinbook.doctor.finding import Finding, ok, warning

_KNOBS = (
    ("/proc/sys/kernel/unprivileged_userns_clone", "0", "sudo sysctl -w kernel.unprivileged_userns_clone=1"),
    ("/proc/sys/user/max_user_namespaces", "0", "sudo sysctl -w user.max_user_namespaces=15000"),
    (
        "/proc/sys/kernel/apparmor_restrict_unprivileged_userns",
        "1",
        "sudo sysctl -w kernel.apparmor_restrict_unprivileged_userns=0",
    ),
)


def examine(name: str) -> Finding:
    """Make a user, a network, a mount, an IPC and a process namespace, with util-linux' `unshare`."""
    if shutil.which("unshare") is None:
        return warning(
            name, "not tried: `unshare` is not installed", "See the sandbox finding, which tries them without it."
        )
    kinds = {
        "user": "--user --map-root-user",
        "network": "--net",
        "mount": "--mount",
        "IPC": "--ipc",
        "process": "--pid --fork",
    }
    failed: dict[str, str] = {}
    for kind, flags in kinds.items():
        # Without root, the others are only to be had inside a user namespace.
        inside = [] if os.geteuid() == 0 or kind == "user" else kinds["user"].split()
        reason = _refusal(["unshare", *inside, *flags.split(), "true"])
        if reason:
            failed[kind] = reason
    if not failed:
        return ok(name, ", ".join(kinds))
    return warning(
        name,
        "; ".join(f"{kind}: {reason}" for kind, reason in failed.items()),
        "The grader falls back to weaker sandboxes (see the sandbox finding).\n" + _mend(),
    )


def _refusal(argv: list[str]) -> str:
    trial = subprocess.run(argv, capture_output=True, text=True, check=False)
    if trial.returncode == 0:
        return ""
    lines = trial.stderr.strip().splitlines() or [f"exit code {trial.returncode}"]
    return lines[-1].removeprefix("unshare: ")


def _mend() -> str:
    turned_off = [
        command for file, off, command in _KNOBS if Path(file).is_file() and Path(file).read_text().strip() == off
    ]
    if turned_off:
        return "\n".join(turned_off)
    return "In a container, allow them: docker run --security-opt seccomp=unconfined --cap-add SYS_ADMIN ..."
