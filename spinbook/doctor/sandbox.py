"""Checks of the sandboxes that students' programs can run in here."""

from __future__ import annotations

import os
import shutil
from pathlib import Path

from groundwork.child_process import run_program
from rmw_lockstep.library import Library, library
from spinbook.doctor.diagnosis import MachineFinding, last_words, missing, ok, set_up_again, warning

_ALLOW = (
    "Install bubblewrap (sudo apt-get install bubblewrap) and allow namespaces (see the finding about them); "
    "docs/installing.md says how in a container."
)


def examine_sandbox() -> MachineFinding:
    """Let the grader run a program in each of its sandboxes."""
    try:
        from grader.sandbox.isolation import available, refuse_what_students_can_not_read
        from grader.sandbox.program import Isolation, SandboxUnavailable
    except ImportError as error:
        return missing(f"the grader does not load: {error}", set_up_again())
    if not isinstance(library(), Library):
        return missing("not checked, because the grader's middleware is missing: Lockstep", "")
    try:
        refuse_what_students_can_not_read()
    except SandboxUnavailable as error:
        return missing("students' programs can't read all modules", str(error))
    levels = available()
    strong = [level for level in (Isolation.BUBBLEWRAP, Isolation.NAMESPACES) if levels[level] is None]
    reasons = "; ".join(f"{level}: {reason}" for level, reason in levels.items() if reason)
    works = ", ".join(str(level) for level in levels if levels[level] is None and level is not Isolation.NONE)
    if strong:
        return ok(works + (f" ({reasons})" if reasons else ""))
    if levels[Isolation.LANDLOCK] is None:
        return warning(
            f"landlock only ({reasons})",
            f"It denies students' code files and all sockets, but shows it the command lines of processes. {_ALLOW}",
        )
    return missing(f"none ({reasons})", f"Spinbook does not run students' code without a sandbox. {_ALLOW}")


#: A trial of a sandbox takes a few milliseconds (s).
_TRIAL_S = 10.0
_ALSO_WITHOUT = "The grader makes the same namespaces without it, if this user may (see the sandbox finding)."


def examine_bubblewrap() -> MachineFinding:
    """Run `true` in bubblewrap."""
    path = shutil.which("bwrap")
    if path is None:
        return warning("not installed", f"{_ALSO_WITHOUT}\nsudo apt-get install bubblewrap")
    version = run_program([path, "--version"], _TRIAL_S).stdout.split()[-1:]
    installed = f"{' '.join(version) or 'of unknown version'}, {path}"
    trial = run_program([path, "--ro-bind", "/", "/", "--unshare-pid", "true"], _TRIAL_S)
    return warning(f"{installed}: {last_words(trial)}", _ALSO_WITHOUT) if trial.returncode else ok(installed)


_KNOBS = (
    ("/proc/sys/kernel/unprivileged_userns_clone", "0", "sudo sysctl -w kernel.unprivileged_userns_clone=1"),
    ("/proc/sys/user/max_user_namespaces", "0", "sudo sysctl -w user.max_user_namespaces=15000"),
    (
        "/proc/sys/kernel/apparmor_restrict_unprivileged_userns",
        "1",
        "sudo sysctl -w kernel.apparmor_restrict_unprivileged_userns=0",
    ),
)


def examine_namespaces() -> MachineFinding:
    """Make a user, a network, a mount, an IPC and a process namespace, with util-linux' `unshare`."""
    if shutil.which("unshare") is None:
        return warning(
            "not checked: `unshare` is not installed", "See the sandbox finding, which tries them without it."
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
        # Without root, the others can only be made inside a user namespace.
        inside = [] if os.geteuid() == 0 or kind == "user" else kinds["user"].split()
        trial = run_program(["unshare", *inside, *flags.split(), "true"], _TRIAL_S)
        if trial.returncode:
            failed[kind] = last_words(trial).removeprefix("unshare: ")
    if not failed:
        return ok(", ".join(kinds))
    return warning(
        "; ".join(f"{kind}: {reason}" for kind, reason in failed.items()),
        "The grader falls back to weaker sandboxes (see the sandbox finding).\n" + _fix(),
    )


def _fix() -> str:
    turned_off = [
        command for file, off, command in _KNOBS if Path(file).is_file() and Path(file).read_text().strip() == off
    ]
    if turned_off:
        return "\n".join(turned_off)
    from grader.sandbox.program import IN_DOCKER

    return f"In a container, allow them: {IN_DOCKER} ..."
