"""`%turtle`: turtlesim's window as a picture in the notebook."""

from __future__ import annotations

import os
import sys
import tempfile
from pathlib import Path

from IPython.display import Image, display

from spinbook.runtime.failure import CellFailed
from spinbook.runtime.process import KeptProcess

#: How long the turtle may take to answer, listening to the real one's poses included (s).
_LIMIT_S = 30.0


def run() -> None:
    """Ask the running turtlesim for its picture and show it. Raises CellFailed where none answers."""
    with tempfile.TemporaryDirectory(prefix="spinbook-") as folder:
        file = Path(folder) / "turtle.png"
        argv = [sys.executable, "-m", "spinbook.turtlesim.picture", os.fspath(file)]
        process = KeptProcess(argv, os.environ, Path.cwd())
        try:
            status = process.wait(_LIMIT_S)
            said = process.read_all()[0].decode(errors="replace").strip()
        finally:
            process.close()
        if status.exit != 0 or not file.exists():
            raise CellFailed(said or "turtlesim did not answer. Is it running? ros2 run turtlesim turtlesim_node")
        alt = "turtlesim's window: the turtle and the trail it has drawn"
        display(Image(data=file.read_bytes(), format="png", metadata={"alt": alt}))
