"""Runs one notebook to its end, in a process of its own: `python -m spinbook.build.run_notebook NOTEBOOK OUT DEADLINE`.

Prints one JSON object a line: {"cells": N} at first, {"done": K} after each cell, and at the end {"finished": true},
{"timed_out": INDEX} where the deadline (s) passed in that cell, or {"died": INDEX} where the kernel ended in it.
What had run by then is written to OUT all the same, and the node graph that was seen to OUT's name with .graph.json.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import sys
import tempfile
from pathlib import Path
from typing import Any

import nbformat
from jupyter_client.kernelspec import KernelSpec, KernelSpecManager
from jupyter_client.manager import AsyncKernelManager
from nbclient import NotebookClient
from nbclient.exceptions import DeadKernelError

from grader.files import write_if_changed
from spinbook.build.watch_graph import GraphWatch
from spinbook.kernel.environment import DOMAIN_NOTE, EXECUTING

#: How long a cancelled notebook's kernel may take to end (s); the supervisor ends it otherwise.
_FAREWELL_S = 5.0


class ThisPython(KernelSpecManager):
    """Every kernel is this Python's own, whatever kernels the machine's users have installed."""

    def get_kernel_spec(self, kernel_name: str) -> KernelSpec:
        """The command of an IPython kernel, without user's settings."""
        argv = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}", "--quiet"]
        return KernelSpec(argv=argv, display_name="Python 3", language="python")


def _tell(**what: Any) -> None:
    print(json.dumps(what), flush=True)


async def run(notebook: Any, folder: Path, deadline_s: float, watch: GraphWatch) -> None:
    """Run the cells of `notebook` in place, in `folder`, failing ones too, and tell how it ended."""
    current = 0

    async def on_start(cell: Any, cell_index: int) -> None:
        nonlocal current
        current = cell_index
        await watch.cell_begins(cell.source)

    async def on_executed(cell: Any, cell_index: int, execute_reply: Any) -> None:
        _tell(done=cell_index + 1)
        await watch.cell_ends(cell.id)

    client = NotebookClient(
        notebook,
        km=_kernel_manager(),
        allow_errors=True,
        timeout=None,
        record_timing=False,
        coalesce_streams=True,
        resources={"metadata": {"path": str(folder)}},
        on_cell_execute=on_start,
        on_cell_executed=on_executed,
    )
    _tell(cells=len(notebook.cells))
    await watch.start()
    running = asyncio.ensure_future(client.async_execute())
    done, _ = await asyncio.wait([running], timeout=deadline_s)
    await watch.close()
    if not done:
        _tell(timed_out=current)
        running.cancel()
        await asyncio.wait([running], timeout=_FAREWELL_S)
        return
    try:
        running.result()
    except DeadKernelError:
        _tell(died=current)
    else:
        _tell(finished=True)


def _kernel_manager() -> Any:
    manager = AsyncKernelManager(kernel_spec_manager=ThisPython())
    # Sockets in the file system: a kernel that starts beside others never finds its port taken.
    manager.transport = "ipc"
    manager.ip = str(Path(tempfile.mkdtemp(prefix="sb-")) / "k")
    return manager


def main() -> None:
    """Run the notebook that the command line names."""
    source, out, deadline_s = Path(sys.argv[1]), Path(sys.argv[2]), float(sys.argv[3])
    os.environ[EXECUTING] = "1"
    notebook = nbformat.reads(source.read_text(encoding="utf-8"), as_version=4)
    with tempfile.TemporaryDirectory(prefix="sb-") as folder:
        note = Path(folder) / "domain"
        os.environ[DOMAIN_NOTE] = os.fspath(note)
        watch = GraphWatch(note)
        with contextlib.suppress(KeyboardInterrupt):
            asyncio.run(run(notebook, Path.cwd(), deadline_s, watch))
    if watch.graph is not None:
        write_if_changed(out.with_name(out.name.removesuffix(".ipynb") + ".graph.json"), watch.graph.to_json())
    write_if_changed(out, json.dumps(notebook, ensure_ascii=False, indent=1, sort_keys=True) + "\n")


if __name__ == "__main__":
    main()
