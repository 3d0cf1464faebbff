"""`%turtle`: turtlesim's window as a picture in the notebook, in which the turtle drives where pictures can move."""

from __future__ import annotations

import base64
import os
import sys
import tempfile
from pathlib import Path

from IPython.display import display

from spinbook.runtime.failure import CellFailed
from spinbook.runtime.process import KeptProcess

#: How long the turtle may take to answer, listening to the real one's poses included (s).
_LIMIT_S = 30.0


def run() -> None:
    """Ask the running turtlesim for its picture and show it. Raises CellFailed where none answers."""
    with tempfile.TemporaryDirectory(prefix="spinbook-") as folder:
        file, moving = Path(folder) / "turtle.png", Path(folder) / "turtle.svg"
        argv = [sys.executable, "-m", "spinbook.turtlesim.picture", os.fspath(file), "--moving", os.fspath(moving)]
        process = KeptProcess(argv, os.environ, Path.cwd())
        try:
            status = process.wait(_LIMIT_S)
            said = process.read_all()[0].decode(errors="replace").strip()
        finally:
            process.close()
        if status.exit != 0 or not file.exists():
            raise CellFailed(said or "turtlesim did not answer. Is it running? ros2 run turtlesim turtlesim_node")
        alt = "turtlesim's window: the turtle and the trail it has drawn"
        bundle = {"image/png": base64.b64encode(file.read_bytes()).decode("ascii"), "text/plain": alt}
        if moving.exists():
            bundle["image/svg+xml"] = moving.read_text(encoding="utf-8")
        display(bundle, raw=True, metadata={kind: {"alt": alt} for kind in bundle if kind != "text/plain"})
