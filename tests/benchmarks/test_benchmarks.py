"""Every benchmark starts: what it imports is there, and it explains itself."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest

ROOT = Path(__file__).parents[2]
PROGRAMS = sorted(
    file for file in (ROOT / "benchmarks").rglob("*.py") if 'if __name__ == "__main__"' in file.read_text("utf-8")
)


@pytest.mark.parametrize(
    "program",
    [file for file in PROGRAMS if "ArgumentParser" in file.read_text("utf-8")],
    ids=lambda file: file.relative_to(ROOT / "benchmarks").as_posix(),
)
def test_a_benchmark_explains_itself(program: Path) -> None:
    done = subprocess.run(
        [sys.executable, str(program), "--help"], cwd=ROOT, capture_output=True, text=True, timeout=120, check=False
    )
    assert done.returncode == 0, done.stderr
    assert done.stdout.startswith("usage: ")
