"""`%colcon`: colcon in the notebook's workspace, with what PyPI has or with a sourced ROS 2."""

from __future__ import annotations

import os
import sys

from interface_compiler import toolchain
from spinbook.package.write_interfaces import written_definitions
from spinbook.runtime.failure import CellFailed
from spinbook.runtime.session import Session
from spinbook.runtime.showing import Bound

#: How long a build may take (s).
SECONDS = 120.0


def run(session: Session, words: list[str], bound: Bound) -> None:
    """Run colcon with these words. Raises CellFailed where there is nothing to build, or where the build fails."""
    workspace = session.workspace
    if not (workspace / "src").is_dir():
        raise CellFailed(f"There is nothing to build in {workspace.name} yet: run the chapter's node cells first.")
    # Where ROS 2 came from PyPI, this Python's prefix is the underlay that /opt/ros/jazzy is elsewhere.
    prefixes = [p for p in os.environ.get("AMENT_PREFIX_PATH", "").split(os.pathsep) if p]
    settings = {
        "AMENT_PREFIX_PATH": os.pathsep.join(dict.fromkeys([*prefixes, sys.prefix])),
        # It would warn that this prefix has no local_setup script; nothing here needs one.
        "COLCON_LOG_LEVEL": os.environ.get("COLCON_LOG_LEVEL", "error"),
    }
    if words[:1] == ["build"]:
        words = [*words, *_without_interfaces(session)]
    argv = [sys.executable, "-m", "colcon", "--log-base", os.fspath(workspace / "log"), *words]
    session.run_command(argv, settings, workspace, bound, "colcon")


def _without_interfaces(session: Session) -> list[str]:
    """Options that leave out packages of interfaces where there is no ament_cmake: Spinbook compiles them itself."""
    if toolchain.sourced_ros() is not None:
        return []
    packages = sorted({item.package for item in written_definitions(session.workspace)})
    return ["--packages-ignore", *packages] if packages else []
