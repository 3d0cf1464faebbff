"""The tests of a tree test that tree, also with an environment that was made for another one."""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from pathlib import Path

ROOT = Path(__file__).parents[2]

TEST = """
import subprocess, sys
from prepared_python import run_prepared
import spinbook

def test_each_way_to_start_it():
    started = subprocess.run([sys.executable, "-m", "spinbook", "--version"], cwd="/", capture_output=True, text=True)
    assert "99.0" in run_prepared("spinbook", "--version").stdout
    assert "99.0" in started.stdout
    assert spinbook.__version__ == "99.0"
"""


def test_a_copy_runs_its_own_code_in_every_process(tmp_path: Path) -> None:
    without = shutil.ignore_patterns("__pycache__", "kinds", "template", "definitions", "tests")
    for name in ("spinbook", "grader", "packages", "tests/support"):
        shutil.copytree(ROOT / name, tmp_path / name, ignore=without)
    shutil.copy(ROOT / "pyproject.toml", tmp_path)
    shutil.copy(ROOT / "tests" / "conftest.py", tmp_path / "tests")
    (tmp_path / "spinbook" / "__init__.py").write_text('"""Another version."""\n\n__version__ = "99.0"\n')
    (tmp_path / "tests" / "test_version.py").write_text(TEST)

    command = [sys.executable, "-m", "pytest", "-q", "-p", "pytest_timeout", "-p", "xdist.plugin", "tests"]
    environment = {**os.environ, "PYTEST_DISABLE_PLUGIN_AUTOLOAD": "1", "PYTEST_ADDOPTS": ""}
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True, check=False)

    assert done.returncode == 0, done.stdout
