"""Files are written whole, with the permissions that the user's umask leaves."""

from __future__ import annotations

import os
import subprocess
import sys
from pathlib import Path

import pytest

from groundwork.files import cached


@pytest.mark.parametrize("mask", [0o077, 0o022, 0o027, 0o002])
def test_a_file_obeys_the_umask(tmp_path: Path, mask: int) -> None:
    code = "import sys, pathlib; from groundwork.files import write_if_changed\n"
    code += "write_if_changed(pathlib.Path(sys.argv[1]), 'grades')"
    subprocess.run([sys.executable, "-c", code, str(tmp_path / "grades.csv")], umask=mask, check=True)
    assert (tmp_path / "grades.csv").stat().st_mode & 0o777 == 0o666 & ~mask


def test_a_user_without_a_home_folder_has_a_cache_as_in_a_container(monkeypatch: pytest.MonkeyPatch) -> None:
    for name in ("HOME", "SPINBOOK_CACHE", "XDG_CACHE_HOME"):
        monkeypatch.delenv(name, raising=False)
    monkeypatch.setattr(os, "getuid", lambda: 54321)
    assert cached("sandbox") == Path("/.cache/spinbook/sandbox")
