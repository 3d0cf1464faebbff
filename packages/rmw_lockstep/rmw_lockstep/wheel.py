"""Makes a wheel of the compiled libraries, for machines that have no compiler: `python -m rmw_lockstep.wheel FOLDER`.

It does not depend on Python's version. It fits ROS 2 of the same versions (except patches) on the same kind of
processor, with the C library of the machine that made it or a newer one.
"""

from __future__ import annotations

import platform
import re
import shutil
import subprocess
import sys
import tempfile
from pathlib import Path

from rmw_lockstep.build import BuildError, compile_into
from rmw_lockstep.library import PREBUILT, SOURCES, compiler
from rmw_lockstep.ros import Ros, installed_ros

_SETUP = """from setuptools import setup

setup(
    name={name!r},
    version={version!r},
    description="The compiled libraries of rmw_lockstep, for ROS 2 with rmw {rmw} and Fast CDR {fastcdr}.",
    license="Apache-2.0",
    packages=[{name!r}],
    package_data={{{name!r}: ["*.so", "wheels/*.so*", "*.json"]}},
)
"""


def make_wheel(ros: Ros, folder: Path) -> Path:
    """Compile the libraries for `ros` and write them as a wheel into `folder`; return the wheel's path.

    Raises:
        BuildError: if they can't be compiled or packed.
    """
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(prefix="rmw-lockstep-") as temporary:
        package = Path(temporary) / PREBUILT
        package.mkdir()
        compile_into(package, ros)
        text = '"""The compiled libraries of rmw_lockstep, which finds them: nothing to import."""\n'
        (package / "__init__.py").write_text(text, encoding="utf-8")
        described = _SETUP.format(name=PREBUILT, version=_version(), **ros.versions)
        (Path(temporary) / "setup.py").write_text(described, encoding="utf-8")
        _pack(Path(temporary))
        made = next(Path(temporary).glob("dist/*.whl"))
        return Path(shutil.copy(made, folder))


def _pack(folder: Path) -> None:
    plat_name = f"linux_{platform.machine()}"
    command = [sys.executable, "setup.py", "-q", "bdist_wheel", "--plat-name", plat_name]
    done = subprocess.run(command, cwd=folder, capture_output=True, text=True, check=False)
    if done.returncode:
        raise BuildError(f"setuptools ended with {done.returncode}:\n{done.stderr.strip()}")


def _version() -> str:
    found = re.search(r"<version>([^<]+)</version>", (SOURCES / "package.xml").read_text(encoding="utf-8"))
    assert found
    return found[1]


def main() -> None:
    """Write the wheel and print its path; or print the reason why that is impossible and exit with 1."""
    ros = installed_ros()
    if ros is None or compiler() is None:
        sys.exit(f"No wheel can be made: {'g++ is' if ros else 'ROS 2 and its headers are'} not installed here.")
    try:
        print(make_wheel(ros, Path(sys.argv[1])))
    except BuildError as error:
        sys.exit(f"No wheel can be made: {error}")


if __name__ == "__main__":
    main()
