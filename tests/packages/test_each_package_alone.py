"""Each package in packages/ can be used without the others: the example of its README runs from its own wheel."""

from __future__ import annotations

import os
import re
import shutil
import subprocess
import sys
from pathlib import Path

import pytest

PACKAGES = sorted(file.parent for file in Path(__file__).parents[2].glob("packages/*/pyproject.toml"))
BUILD = "import sys; from setuptools.build_meta import build_wheel; build_wheel(sys.argv[1])"


def run(*words: str, cwd: Path, **variables: str) -> str:
    """Run Python, and return its output."""
    done = subprocess.run(
        [sys.executable, *words], cwd=cwd, env={**os.environ, **variables}, capture_output=True, text=True, check=False
    )
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.parametrize("package", PACKAGES, ids=lambda folder: str(folder.name))
def test_the_example_of_its_readme_runs_from_its_own_wheel(package: Path, tmp_path: Path) -> None:
    source = tmp_path / "source"
    shutil.copytree(package, source, ignore=shutil.ignore_patterns("__pycache__", "*.egg-info", "build"))
    run("-c", BUILD, str(tmp_path), cwd=source)
    [wheel] = tmp_path.glob("*.whl")
    readme = (package / "README.md").read_text(encoding="utf-8")
    example = re.search(r"```python\n(.*?)```\s+```text\n(.*?)```", readme, re.DOTALL)
    assert example, "the README has an example and what it prints"

    shutil.unpack_archive(wheel, tmp_path / "site", "zip")
    printed = run("-c", example[1], cwd=tmp_path, PYTHONPATH=str(tmp_path / "site"))

    assert printed == example[2]
