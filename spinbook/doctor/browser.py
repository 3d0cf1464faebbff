"""Whether there is a browser, with which the tests look at the pages that Spinbook makes."""

from __future__ import annotations

import os
import shutil
import subprocess
import tempfile

from spinbook.doctor.finding import Finding, ok, warning

_NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
_ONLY_TESTS = (
    "Only the tests need one; those of pages fail without. `make test` installs it: sudo apt-get install chromium"
)
_PAGE = "data:text/html,<title>spinbook</title>"
_DEADLINE_S = 30.0


def examine(name: str) -> Finding:
    """Open a page in it, without a window."""
    path = next(filter(None, map(shutil.which, _NAMES)), None)
    if path is None:
        return warning(name, "no Chromium found", _ONLY_TESTS)
    with tempfile.TemporaryDirectory(prefix="spinbook-doctor-") as profile:
        argv = [path, "--headless", "--disable-gpu", f"--user-data-dir={profile}", "--dump-dom", _PAGE]
        if os.geteuid() == 0:
            argv.insert(1, "--no-sandbox")
        try:
            trial = subprocess.run(argv, capture_output=True, text=True, timeout=_DEADLINE_S, check=False)
        except subprocess.TimeoutExpired:
            return warning(name, f"{path} does not answer within {_DEADLINE_S:g} s", _ONLY_TESTS)
    if "spinbook" not in trial.stdout:
        lines = trial.stderr.strip().splitlines() or [f"exit code {trial.returncode}"]
        return warning(name, f"{path} does not show a page: {lines[-1]}", _ONLY_TESTS)
    return ok(name, path)
