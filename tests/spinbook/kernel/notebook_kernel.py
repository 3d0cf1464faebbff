"""A notebook's kernel to run cells in, as a front end would."""

from __future__ import annotations

import os
import signal
import sys
import tempfile
from collections.abc import Callable
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from jupyter_client.kernelspec import KernelSpec, KernelSpecManager
from jupyter_client.manager import KernelManager

CELL_LIMIT_S = 240


class ThisPython(KernelSpecManager):
    """Every kernel is the Python that runs the tests."""

    def get_kernel_spec(self, kernel_name: str) -> KernelSpec:
        argv = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}"]
        return KernelSpec(argv=argv, display_name="Python 3", language="python")


@dataclass
class Shown:
    """What a cell showed: its text, the message of an error, pictures, and how often a picture was replaced."""

    text: str = ""
    error: str = ""
    pictures: list[dict[str, Any]] = field(default_factory=list)
    updates: int = 0
    metadata: list[dict[str, Any]] = field(default_factory=list)
    """What is saved with each picture."""


class Kernel:
    """One running kernel, in a folder of its own, with Spinbook's commands loaded."""

    def __init__(self, folder: Path, **environment: str) -> None:
        self._manager: Any = KernelManager(kernel_spec_manager=ThisPython())
        self._manager.transport = "ipc"
        self._sockets = tempfile.TemporaryDirectory(prefix="sb-", ignore_cleanup_errors=True)
        self._manager.ip = os.fspath(Path(self._sockets.name) / "k")
        env = {key: value for key, value in {**os.environ, **environment}.items() if value}
        self._manager.start_kernel(cwd=os.fspath(folder), env=env)
        self._client = self._manager.client()
        self._client.start_channels()
        self._client.wait_for_ready(timeout=60)
        self.folder = folder
        self.loaded = self.run("%load_ext spinbook\n%chapter test --package robot --workspace robot_ws")

    def run(self, code: str, on_more: Callable[[Shown], None] = lambda shown: None) -> Shown:
        """Run a cell to its end. `on_more` is called with what has been shown so far whenever more arrives."""
        shown = Shown()

        def take(message: dict[str, Any]) -> None:
            kind, content = message["msg_type"], message["content"]
            if kind == "stream":
                shown.text += content["text"]
            elif kind == "error":
                shown.error = "\n".join(content["traceback"])
            elif kind == "display_data" and set(content["data"]) == {"text/plain"}:
                shown.text += content["data"]["text/plain"] + "\n"
            elif kind == "display_data":
                shown.pictures.append(content["data"])
                shown.metadata.append(content["metadata"])
            elif kind == "update_display_data":
                shown.updates += 1
                shown.pictures[-1] = content["data"]
            on_more(shown)

        self._client.execute_interactive(code, output_hook=take, timeout=CELL_LIMIT_S, allow_stdin=False)
        return shown

    def from_cell(self, cell: str) -> None:
        """Send this cell's id with all that runs from now on, as JupyterLab does."""
        self._client.session.metadata["cellId"] = cell

    def pressing_stop(self, when: Callable[[Shown], bool]) -> Callable[[Shown], None]:
        """Return a callback for `run` that presses Stop, once, when the condition is true for what has been shown."""
        pressed = False

        def look(shown: Shown) -> None:
            nonlocal pressed
            if not pressed and when(shown):
                pressed = True  # a second press, between two cells, would lose the kernel's answer
                self._manager.interrupt_kernel()

        return look

    @property
    def process_id(self) -> int:
        """The kernel's process id."""
        return int(self._manager.provisioner.pid)

    def kill(self) -> None:
        """Kill the kernel as kill -9 does."""
        os.kill(self.process_id, signal.SIGKILL)

    def shut_down(self) -> None:
        """Shut down as closing the notebook does."""
        self._client.stop_channels()
        self._manager.shutdown_kernel(now=not self._manager.is_alive())
        self._sockets.cleanup()
