"""A checkout to set up, and a Python with simulated environments and pip, so that nothing is downloaded.

Everything else about that Python is real. So what `setup.sh` decides is tested in milliseconds;
test_set_up_for_real.py tests in full that the decisions work.
"""

from __future__ import annotations

import os
import shutil
import subprocess
import sys
from dataclasses import dataclass
from pathlib import Path

ROOT = Path(__file__).parents[2]
#: What compiles interfaces, and the definitions that come with it.
INTERFACES = "packages/interface_compiler/interface_compiler"
REAL_PYTHON = getattr(sys, "_base_executable", sys.executable)

#: `-m venv` makes a folder with a Python that notes its arguments, and does what the files in $STAGE say.
_PYTHON = """#!/bin/sh
case "$1 $2" in
    "-m venv")
        echo "venv $3" >>"$STAGE/calls"
        mkdir -p "$3/bin" && cp "$STAGE/environment-python" "$3/bin/python"
        exit ;;
    "-c import ensurepip, venv") [ ! -e "$STAGE/no-ensurepip" ]; exit ;;
    "-I spinbook/doctor/python_build.py") cat "$STAGE/faster-build" 2>/dev/null; exit 0 ;;
    "-c "*base_prefix*) [ -e "$STAGE/is-active" ] && echo True || echo False; exit ;;
    "-c "*_base_executable*) cat "$STAGE/is-active"; exit ;;
    "- ") [ ! -e "$STAGE/version" ] || exec @REAL@ -c "import sys; sys.version_info = ($(cat "$STAGE/version"))
sys.version = '.'.join(map(str, sys.version_info))
exec(sys.stdin.read())" ;;
esac
exec @REAL@ "$@"
"""
_ENVIRONMENT_PYTHON = """#!/bin/sh
if [ "$1 $2" = "-m pip" ]; then
    shift 2
    echo "pip $* PYTHONPATH=${PYTHONPATH-unset} guard=${_ROS_WHEELS_BOOTSTRAP_COMPLETE-unset}" >>"$STAGE/calls"
    # Opened while the writer of the line before has not closed it yet, a pipe ends without a line.
    while [ -e "$STAGE/pip-waits" ] && ! read -r _ <"$STAGE/pip-waits"; do :; done
    [ ! -e "$STAGE/pip-fails" ] || { cat "$STAGE/pip-fails" >&2; exit 1; }
    exit 0
fi
if [ "$1 $2" = "-m rmw_lockstep.build" ]; then
    echo "compile" >>"$STAGE/calls"
    [ ! -e "$STAGE/compiling-fails" ] || { cat "$STAGE/compiling-fails" >&2; exit 1; }
    exit 0
fi
if [ "$2" = interface_compiler ]; then
    echo "interfaces $3" >>"$STAGE/calls"
    [ -z "$3" ] || { cat "$STAGE/compiler-is"; exit; }
    [ ! -e "$STAGE/no-compiler" ] || { cat "$STAGE/no-compiler" >&2; exit 3; }
    exit 0
fi
[ ! -e "$STAGE/ros-fails" ] || { cat "$STAGE/ros-fails" >&2; exit 1; }
"""


@dataclass(frozen=True)
class Checkout:
    """A copy of what set-up needs, in `folder`; `stage` has the simulated programs' instructions and notes."""

    folder: Path
    stage: Path
    environment: dict[str, str]

    @property
    def python(self) -> Path:
        """The simulated Python."""
        return self.stage / "bin" / "python3"

    @property
    def calls(self) -> list[str]:
        """The arguments of the simulated programs' calls, in order."""
        notes = self.stage / "calls"
        return notes.read_text().splitlines() if notes.exists() else []

    def forget_calls(self) -> None:
        """Start a new list of calls."""
        (self.stage / "calls").unlink(missing_ok=True)

    def tell(self, what: str, text: str = "") -> None:
        """Set how the simulated programs behave from now on."""
        (self.stage / what).write_text(text)

    def program(self, name: str, text: str) -> None:
        """Put a program with this name before the real ones."""
        file = self.stage / "bin" / name
        file.write_text(text)
        file.chmod(0o755)

    def start(self, **settings: str) -> subprocess.Popen[str]:
        """Start set-up with these variables, in a process group of its own."""
        return subprocess.Popen(
            ["sh", os.fspath(self.folder / "setup.sh")],
            env=self.environment | settings,
            stdout=subprocess.PIPE,
            stderr=subprocess.STDOUT,
            text=True,
            start_new_session=True,
        )

    def set_up(self, **settings: str) -> tuple[int, str]:
        """Run set-up to its end; return its exit code and its output."""
        process = self.start(**settings)
        said, _ = process.communicate(timeout=60)
        return process.returncode, said


def make_checkout(parent: Path) -> Checkout:
    """Make a checkout in a folder below `parent`."""
    folder, stage = parent / "spinbook", parent / "stage"
    (folder / "spinbook" / "doctor").mkdir(parents=True)
    (folder / INTERFACES).mkdir(parents=True)
    (folder / INTERFACES / "Pose.msg").write_text("float32 x\n")
    for name in ("setup.sh", "Makefile", "pyproject.toml", "spinbook/doctor/ros_origin.py"):
        shutil.copy(ROOT / name, folder / name)
    # What it fetches from npm is tested in test_fetching_pyodide.py.
    (folder / "fetch-pyodide.sh").write_text("")
    (folder / "constraints.txt").write_text(
        "setuptools==79.0.1 \\\n    --hash=sha256:0\nclick==8 \\\n    --hash=sha256:1\n"
    )
    (folder / "constraints-ros.txt").write_text("ros-rclpy==7 \\\n    --hash=sha256:2\n")
    (folder / "constraints-test.txt").write_text("mypy==2 \\\n    --hash=sha256:4\n")
    (stage / "bin").mkdir(parents=True)
    environment = {
        "PATH": f"{stage / 'bin'}:/usr/bin:/bin",
        "HOME": os.fspath(parent),
        "STAGE": os.fspath(stage),
        "PYTHON": os.fspath(stage / "bin" / "python3"),
    }
    checkout = Checkout(folder, stage, environment)
    checkout.program("python3", _PYTHON.replace("@REAL@", REAL_PYTHON))
    checkout.tell("environment-python", _ENVIRONMENT_PYTHON)
    (stage / "environment-python").chmod(0o755)
    return checkout
