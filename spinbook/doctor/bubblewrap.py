"""Whether bubblewrap is installed and runs a program."""

from __future__ import annotations

import shutil
import subprocess

from spinbook.doctor.finding import Finding, ok, warning

_ALSO_WITHOUT = "The grader makes the same namespaces without it, if this user may (see the sandbox finding)."


def examine(name: str) -> Finding:
    """Run `true` in it."""
    path = shutil.which("bwrap")
    if path is None:
        return warning(name, "not installed", f"{_ALSO_WITHOUT}\nsudo apt-get install bubblewrap")
    version = subprocess.run([path, "--version"], capture_output=True, text=True, check=False).stdout.split()[-1:]
    trial = subprocess.run(
        [path, "--ro-bind", "/", "/", "--unshare-pid", "true"], capture_output=True, text=True, check=False
    )
    found = f"{' '.join(version) or 'of unknown version'}, {path}"
    if trial.returncode:
        lines = trial.stderr.strip().splitlines() or [f"exit code {trial.returncode}"]
        return warning(name, f"{found}: {lines[-1]}", _ALSO_WITHOUT)
    return ok(name, found)
