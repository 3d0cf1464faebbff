"""Whether colcon builds a ROS 2 package, and links it instead of copying when asked to."""

from __future__ import annotations

import os
import subprocess
import sys
import tempfile
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path

from spinbook.doctor.finding import Finding, missing, ok, warning

_NAME = "spinbook_doctor_trial"
_FILES = {
    "package.xml": f"""<?xml version="1.0"?>
<package format="3">
  <name>{_NAME}</name> <version>0.0.0</version> <description>A trial.</description>
  <maintainer email="nobody@example.org">Nobody</maintainer> <license>Apache-2.0</license>
  <export> <build_type>ament_python</build_type> </export>
</package>
""",
    "setup.py": f"""from setuptools import setup
setup(name='{_NAME}', version='0.0.0', packages=['{_NAME}'],
      entry_points={{'console_scripts': ['trial = {_NAME}.trial:main']}})
""",
    "setup.cfg": f"[develop]\nscript_dir=$base/lib/{_NAME}\n[install]\ninstall_scripts=$base/lib/{_NAME}\n",
    f"{_NAME}/__init__.py": "",
    f"{_NAME}/trial.py": "def main():\n    print('built')\n",
}
_TOO_NEW = 80


def examine(name: str) -> Finding:
    """Build a package of one module with `--symlink-install`."""
    try:
        colcon, setuptools = version("colcon-core"), version("setuptools")
    except PackageNotFoundError as error:
        return missing(
            name, f"{error.name} is not installed for {sys.executable}", "Make the environment anew: make setup"
        )
    found = f"colcon-core {colcon}, setuptools {setuptools}"
    with tempfile.TemporaryDirectory(prefix="spinbook-doctor-") as folder:
        workspace = Path(folder)
        for path, text in _FILES.items():
            file = workspace / "src" / _NAME / path
            file.parent.mkdir(parents=True, exist_ok=True)
            file.write_text(text)
        built = _build(workspace)
        if built.returncode:
            lines = [line for line in built.stderr.splitlines() if line.strip()] or [f"exit code {built.returncode}"]
            return missing(name, f"{found}; a build fails: {lines[-1]}", "Make the environment anew: make setup")
        linked = not any((workspace / "install").glob(f"{_NAME}/lib/python*/site-packages/{_NAME}/trial.py"))
    if not linked or int(setuptools.split(".")[0]) >= _TOO_NEW:
        return warning(
            name,
            f"{found}; `--symlink-install` copies, silently",
            "With setuptools 80 and newer an edited node is not the one that runs. pip install 'setuptools<80'",
        )
    return ok(name, f"{found}; built a package with --symlink-install")


def _build(workspace: Path) -> subprocess.CompletedProcess[str]:
    prefixes = [entry for entry in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if entry]
    settings = {
        "AMENT_PREFIX_PATH": os.pathsep.join(dict.fromkeys([*prefixes, sys.prefix])),
        "COLCON_LOG_LEVEL": "error",
    }
    return subprocess.run(
        [
            sys.executable,
            "-m",
            "colcon",
            "--log-base",
            "log",
            "build",
            "--symlink-install",
            "--event-handlers",
            "console_direct-",
        ],
        cwd=workspace,
        env=os.environ | settings,
        capture_output=True,
        text=True,
        check=False,
    )
