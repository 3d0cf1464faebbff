"""Checks of this machine: Python, folders, compiler, colcon, the Jupyter kernel, the browser, the ros2 command."""

from __future__ import annotations

import os
import platform
import shutil
import subprocess
import sys
import tempfile
import time
from importlib.metadata import PackageNotFoundError, version
from pathlib import Path
from typing import Any

from groundwork.child_process import run_program
from groundwork.files import write_folder
from interface_compiler import prefixes, shipped, toolchain
from ros_in_python.ros2.executables import is_built_in, real_ros2
from spinbook.doctor import python_build
from spinbook.doctor.diagnosis import MachineFinding, in_handout, last_words, missing, ok, set_up_again, warning

OLDEST, NEWEST = (3, 10), (3, 14)


def examine_python() -> MachineFinding:
    """Check the version of this Python, and how it was compiled."""
    python = f"{platform.python_implementation()} {platform.python_version()}, {sys.executable}"
    if not (OLDEST <= sys.version_info[:2] <= NEWEST and platform.python_implementation() == "CPython"):
        return missing(python, f"Spinbook needs CPython 3.10 to 3.14. Choose one. {set_up_again('python3.12')}")
    if python_build.is_optimized() or in_handout():
        return ok(python)
    return warning(f"{python}, compiled without optimizations", _faster_build())


def _faster_build() -> str:
    this = python_build.this_build()
    if build := python_build.faster_build(this, os.environ.get("PATH", "")):
        advice = f"This machine has a faster build: make PYTHON={build} setup"
    else:
        options = 'PYTHON_CONFIGURE_OPTS="--enable-optimizations --with-lto"'
        advice = f"pyenv can build a faster one: {options} pyenv install {this.version}"
    return f"Everything works, but grading takes 10 to 20 % longer than with an optimized Python.\n{advice}"


def examine_folder() -> MachineFinding:
    """Check the paths for characters that break colcon's shell scripts or the search paths."""
    folders = (Path.cwd(), Path(sys.prefix))
    for folder in folders:
        odd = {character for character in str(folder) if character.isspace() or character in ":;\"'$\\"}
        if odd == {" "} and in_handout():
            again = f"Move the folder to a path without one. {set_up_again()}"
            return warning(f"'{folder}' has a space in it", f"Only colcon's packages do not run there. {again}")
        if odd:
            return missing(
                f"'{folder}' has a space, a colon, a semicolon, a quotation mark, a dollar sign or a backslash in it",
                "colcon's scripts, compilers and ROS's search paths fail there. "
                f"Move it to a path without one. {set_up_again()}",
            )
    return ok(f"{folders[0]} (environment: {folders[1]})")


_WITHOUT = "Needed only where interfaces are defined or changed, and to compile the grader's middleware in a checkout."


def examine_compiler() -> MachineFinding:
    """Look for a C compiler and Python's headers, and for the packages that `make setup` compiles with them."""
    if ros := toolchain.sourced_ros():
        return ok(f"colcon compiles interfaces, with the ROS 2 in {ros}")
    lacking = list(filter(None, (toolchain.missing_compiler(), toolchain.missing_headers())))
    if lacking:
        return warning(_absent(), "\n".join([*lacking, _WITHOUT]))
    installed = prefixes.packages(prefixes.installed())
    absent = [package for package in shipped.standard() if package not in installed]
    if absent:
        return warning(f"{' and '.join(absent)} not compiled yet", "make setup compiles them")
    return ok(f"{shutil.which('gcc')}, {shutil.which('g++')}, {toolchain.headers() / 'Python.h'}")


def _absent() -> str:
    programs = [program for program in ("gcc", "g++") if shutil.which(program) is None]
    header = [] if (toolchain.headers() / "Python.h").is_file() else ["Python.h"]
    return f"not found: {', '.join([*programs, *header])}"


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
#: Longer than the check may take, whose end also ends the build (s).
_BUILD_S = 120.0
_BUILD = ("--log-base", "log", "build", "--symlink-install", "--event-handlers", "console_direct-")


def examine_colcon() -> MachineFinding:
    """Build a package of one module with `--symlink-install`."""
    try:
        colcon, setuptools = version("colcon-core"), version("setuptools")
    except PackageNotFoundError as error:
        return missing(f"{error.name} is not installed for {sys.executable}", set_up_again())
    versions = f"colcon-core {colcon}, setuptools {setuptools}"
    with tempfile.TemporaryDirectory(prefix="spinbook-doctor-") as folder:
        workspace = Path(folder)
        write_folder(workspace / "src" / _NAME, _FILES)
        built = _build(workspace)
        if built.returncode:
            return missing(f"{versions}; a build fails: {last_words(built)}", set_up_again())
        linked = not any((workspace / "install").glob(f"{_NAME}/lib/python*/site-packages/{_NAME}/trial.py"))
    if not linked or int(setuptools.split(".")[0]) >= _TOO_NEW:
        return warning(
            f"{versions}; `--symlink-install` copies, silently",
            "With setuptools 80 or newer, an edit of a node has no effect. Fix: pip install 'setuptools<80'",
        )
    return ok(f"{versions}; built a package with --symlink-install")


def _build(workspace: Path) -> subprocess.CompletedProcess[str]:
    prefixes = [entry for entry in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if entry]
    settings = {
        "AMENT_PREFIX_PATH": os.pathsep.join(dict.fromkeys([*prefixes, sys.prefix])),
        "COLCON_LOG_LEVEL": "error",
    }
    argv = [sys.executable, "-m", "colcon", *_BUILD]
    return run_program(argv, _BUILD_S, cwd=workspace, env=os.environ | settings)


_NAMES = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable", "chrome")
_ONLY_TESTS = "Only the tests of pages need one. Install it: sudo apt-get install chromium"
_PAGE = "data:text/html,<title>spinbook</title>"
_DEADLINE_S = 30.0


def examine_browser() -> MachineFinding:
    """Open a page in a headless Chromium."""
    path = next(filter(None, map(shutil.which, _NAMES)), None)
    if path is None:
        return warning("no Chromium found", _ONLY_TESTS)
    with tempfile.TemporaryDirectory(prefix="spinbook-doctor-") as profile:
        argv = [path, "--headless", "--disable-gpu", f"--user-data-dir={profile}", "--dump-dom", _PAGE]
        if os.geteuid() == 0:
            argv.insert(1, "--no-sandbox")
        try:
            trial = run_program(argv, _DEADLINE_S)
        except subprocess.TimeoutExpired:
            return warning(f"{path} does not respond within {_DEADLINE_S:g} s", _ONLY_TESTS)
    if "spinbook" not in trial.stdout:
        return warning(f"{path} does not show a page: {last_words(trial)}", _ONLY_TESTS)
    return ok(path)


def examine_ros2_command() -> MachineFinding:
    """Look for the ros2 command and turtlesim. Chapters run without them, so their absence is no problem."""
    ros2 = real_ros2([], os.environ)
    prefix = prefixes.prefix_of("turtlesim", prefixes.installed())
    turtlesim = None if is_built_in("turtlesim", prefix) else prefix
    parts = [
        f"ros2 at {ros2[0]}" if ros2 else "no ros2 of ROS: Spinbook's own runs (ros2, spinbook ros2)",
        f"turtlesim in {turtlesim}" if turtlesim else "turtlesim's nodes: Spinbook's own",
    ]
    return ok("; ".join(parts))


_KERNEL_DEADLINE_S = 45.0
_CELL = "%load_ext spinbook\nimport sys; print(sys.prefix)"


def examine_kernel() -> MachineFinding:
    """Start the kernel that the notebooks use, and run a cell in it."""
    try:
        from jupyter_client.manager import start_new_kernel
    except ImportError as error:
        return missing(str(error), set_up_again())
    start = time.monotonic()
    try:
        manager, client = start_new_kernel(kernel_name="python3", startup_timeout=_KERNEL_DEADLINE_S)
    except (OSError, RuntimeError) as error:
        return missing(
            f"does not start: {error}",
            "To see why, run: python -m ipykernel\nJupyter stores files below HOME: can you write there?",
        )
    try:
        printed, fault = _run(client)
    finally:
        client.stop_channels()
        manager.shutdown_kernel(now=True)
    took = time.monotonic() - start
    if fault:
        return missing(f"a cell fails: {fault}", set_up_again())
    if printed.strip().splitlines()[-1:] != [sys.prefix]:
        return missing(f"the kernel runs another Python: {printed.strip()}", "jupyter kernelspec remove python3")
    return ok(f"started and ran a cell in {took:.1f} s")


def _run(client: Any) -> tuple[str, str]:
    """Run the cell; return what it printed, and what went wrong."""
    printed: list[str] = []

    def keep(message: dict[str, Any]) -> None:
        if message["msg_type"] == "stream" and message["content"]["name"] == "stdout":
            printed.append(message["content"]["text"])

    reply = client.execute_interactive(_CELL, timeout=_KERNEL_DEADLINE_S, output_hook=keep)["content"]
    fault = "" if reply["status"] == "ok" else f"{reply.get('ename')}: {reply.get('evalue')}"
    return "".join(printed), fault
