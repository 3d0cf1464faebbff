"""Set-up fetches Pyodide from npm: one version, with one digest, and continues without it."""

from __future__ import annotations

import os
import subprocess
import tarfile
from pathlib import Path

SCRIPT = Path(__file__).parents[2] / "fetch-pyodide.sh"


def fetch(tmp_path: Path, npm: str | None) -> tuple[int, str]:
    """Run the script with this program as `npm`, or with none. Return the exit status and the output."""
    programs = tmp_path / "bin"
    programs.mkdir()
    for name in ("sh", "cat", "dirname", "mktemp", "rm", "mkdir", "tar", "gzip", "openssl", "cp", "basename"):
        (programs / name).symlink_to(Path("/usr/bin", name))
    if npm is not None:
        (programs / "npm").write_text(f"#!/bin/sh\n{npm}\n")
        (programs / "npm").chmod(0o755)
    environment = {"PATH": os.fspath(programs), "VENV": os.fspath(tmp_path / "venv")}
    done = subprocess.run(["/bin/sh", os.fspath(SCRIPT)], env=environment, capture_output=True, text=True, check=False)
    return done.returncode, done.stderr


def test_without_npm_everything_else_goes_on(tmp_path: Path) -> None:
    status, said = fetch(tmp_path, None)
    assert status == 0
    assert "There is no npm here" in said
    assert not (tmp_path / "venv").exists()


def test_without_a_registry_everything_else_goes_on(tmp_path: Path) -> None:
    status, said = fetch(tmp_path, "exit 1")
    assert status == 0
    assert "could not be fetched" in said


def test_another_package_is_refused(tmp_path: Path) -> None:
    wrong = tmp_path / "wrong.tgz"
    with tarfile.open(wrong, "w:gz") as archive:
        archive.add(SCRIPT, "package/pyodide.mjs")
    status, said = fetch(tmp_path, f"cp {wrong} pyodide-314.0.7.tgz")
    assert status == 1
    assert "is not the one that was pinned" in said
    assert not (tmp_path / "venv").exists()
