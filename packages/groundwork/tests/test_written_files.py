"""Files are written whole, with the permissions that the user's umask leaves."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest


@pytest.mark.parametrize("mask", [0o077, 0o022, 0o027, 0o002])
def test_a_file_obeys_the_umask(tmp_path: Path, mask: int) -> None:
    code = "import sys, pathlib; from groundwork.files import write_if_changed\n"
    code += "write_if_changed(pathlib.Path(sys.argv[1]), 'grades')"
    subprocess.run([sys.executable, "-c", code, str(tmp_path / "grades.csv")], umask=mask, check=True)
    assert (tmp_path / "grades.csv").stat().st_mode & 0o777 == 0o666 & ~mask
