"""Runs one notebook in its own process: `python -m spinbook.build.run_notebook NOTEBOOK OUT GRAPH DEADLINE FOLDER`.

Prints one JSON object per line: {"cells": N} first, {"done": K} after each cell, and at the end {"finished": true},
{"timed_out": INDEX} where the deadline (s) passed in that cell, or {"died": INDEX} where the kernel ended in it. What
had run by then is written to OUT all the same, and the node graph that was seen to GRAPH. FOLDER is for the sockets of
the kernel; the caller removes it, as this process may be killed. Its path has to be short.
"""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import sys
from asyncio.subprocess import DEVNULL, PIPE, Process
from pathlib import Path
from typing import Any

import nbformat
from jupyter_client.kernelspec import KernelSpec, KernelSpecManager
from jupyter_client.manager import AsyncKernelManager
from nbclient import NotebookClient
from nbclient.exceptions import DeadKernelError

from groundwork.files import write_if_changed
from spinbook.build.streams import joined
from spinbook.graph.model import GraphNode, GraphTopic, NodeGraph, one_each
from spinbook.kernel.environment import DOMAIN_NOTE, EXECUTING, for_domain
from spinbook.kernel.long_lines import whole_in, with_short_lines
from spinbook.kernel.node_errors import ERROR
from spinbook.kernel.supervisor import die_with_parent


class History:
    """The nodes and topics that existed at the end of any cell."""

    def __init__(self) -> None:
        self._nodes: dict[str, tuple[str, str]] = {}
        self._topics: dict[str, GraphTopic] = {}

    def add(self, cell: str, graph: NodeGraph) -> None:
        """Add the graph that was seen at the end of a cell."""
        for node in graph.nodes:
            first, _ = self._nodes.get(node.name, (cell, cell))
            self._nodes[node.name] = (first, cell)
        for topic in graph.topics:
            before = self._topics.get(topic.name, topic)
            self._topics[topic.name] = GraphTopic(
                topic.name,
                one_each((*before.publishers, *topic.publishers)),
                one_each((*before.subscriptions, *topic.subscriptions)),
                before.rate_hz if topic.rate_hz is None else topic.rate_hz,
            )

    def graph(self) -> NodeGraph:
        """Return the graph of the whole run, with nodes in the order in which they appeared.

        An end counts as connected if it ever was; a topic's rate is the last one counted.
        """
        nodes = (GraphNode(name, first, last) for name, (first, last) in self._nodes.items())
        return NodeGraph(tuple(nodes), tuple(self._topics[name] for name in sorted(self._topics)))


#: Cells during which messages may be counted: no command and no snippet looks at the graph meanwhile.
COUNTED_CELLS = ("%%node", "%plot")
#: An observer that does not answer within this time (s) is abandoned: the notebook matters more than its picture.
_TIME_LIMIT_S = 60.0


class GraphWatch:
    """Follows the notebook whose kernel writes its ROS domain into the file `note`.

    Where the graph can't be watched, nothing is seen and nothing fails.
    """

    def __init__(self, note: Path) -> None:
        self._note = note
        self._history = History()
        self._domain = ""
        self._observer: Process | None = None

    async def start(self) -> None:
        """Start the observer, which gets ready while the kernel does."""
        environment = {**os.environ, **for_domain(0, os.environ)}
        argv = (sys.executable, "-m", "spinbook.graph.watcher")
        self._observer = await asyncio.create_subprocess_exec(
            *argv, env=environment, stdin=PIPE, stdout=PIPE, stderr=DEVNULL, limit=1 << 24, preexec_fn=die_with_parent
        )

    async def cell_begins(self, source: str) -> None:
        """Prepare for a cell that is about to run."""
        if self._domain and source.startswith(COUNTED_CELLS):
            self._send("count")

    async def cell_ends(self, cell: str) -> None:
        """Record the graph after the cell with this id."""
        if not self._follow() or self._observer is None or self._observer.stdout is None:
            return
        try:
            self._send("look")
            line = await asyncio.wait_for(self._observer.stdout.readline(), _TIME_LIMIT_S)
            self._history.add(cell, NodeGraph.from_json(line.decode()))
        except (ValueError, OSError, asyncio.TimeoutError):
            await self.close()

    def _follow(self) -> bool:
        """Point the observer at the notebook's domain. Return whether that domain is known yet."""
        with contextlib.suppress(OSError):
            domain = self._note.read_text(encoding="utf-8")
            if domain != self._domain:
                self._domain = domain
                self._send(f"domain {domain}")
        return bool(self._domain)

    def _send(self, word: str) -> None:
        if self._observer is not None and self._observer.stdin is not None:
            self._observer.stdin.write(f"{word}\n".encode())

    async def close(self) -> None:
        """End the observer."""
        observer, self._observer = self._observer, None
        if observer is not None:
            with contextlib.suppress(ProcessLookupError):
                observer.kill()
            await observer.wait()

    @property
    def graph(self) -> NodeGraph | None:
        """What has been seen of the chapter so far; None if nothing."""
        graph = self._history.graph()
        return graph if graph.nodes else None


#: How long a cancelled notebook's kernel may take to end (s); the supervisor ends it otherwise.
_FAREWELL_S = 5.0


class ThisPython(KernelSpecManager):
    """Offers this Python's own kernel, whatever kernels the machine's users have installed."""

    def get_kernel_spec(self, kernel_name: str) -> KernelSpec:
        """Return the command of an IPython kernel, without the user's settings."""
        argv = [sys.executable, "-m", "ipykernel_launcher", "-f", "{connection_file}", "--quiet"]
        return KernelSpec(argv=argv, display_name="Python 3", language="python")


def _report(**what: Any) -> None:
    print(json.dumps(what), flush=True)


async def run(notebook: Any, folder: Path, deadline_s: float, watch: GraphWatch, manager: Any) -> None:
    """Run the cells of `notebook` in place, in `folder`, failing ones too, and report how it ended."""
    current = 0

    async def on_start(cell: Any, cell_index: int) -> None:
        nonlocal current
        current = cell_index
        await watch.cell_begins(cell.source)

    async def on_executed(cell: Any, cell_index: int, execute_reply: Any) -> None:
        _report(done=cell_index + 1)
        if cell.id != _END:
            await watch.cell_ends(cell.id)

    # nbclient would join streams in a time that is quadratic in the length of a line.
    client = NotebookClient(
        notebook,
        km=manager,
        allow_errors=True,
        timeout=None,
        record_timing=False,
        coalesce_streams=False,
        resources={"metadata": {"path": str(folder)}},
        on_cell_execute=on_start,
        on_cell_executed=on_executed,
    )
    _report(cells=len(notebook.cells))
    _add_end(notebook)
    await watch.start()
    running = asyncio.ensure_future(client.async_execute())
    done, _ = await asyncio.wait([running], timeout=deadline_s)
    await watch.close()
    if not done:
        _report(timed_out=current)
        running.cancel()
        await asyncio.wait([running], timeout=_FAREWELL_S)
        return
    try:
        running.result()
    except DeadKernelError:
        _report(died=current)
    else:
        _report(finished=True)


#: The id of a cell that runs after the chapter's last one, and is not kept: it ends the nodes.
_END = "spinbook-end"


def _add_end(notebook: Any) -> None:
    if any("%load_ext spinbook" in cell.source for cell in notebook.cells):
        notebook.cells.append(nbformat.v4.new_code_cell("%stop --all", id=_END))


def _without_end(notebook: Any) -> None:
    """Remove the last cell; what it reports about nodes is shown in the chapter's last one."""
    if notebook.cells and notebook.cells[-1].id == _END:
        reports = [output for output in notebook.cells.pop().outputs if ERROR in output.get("metadata", {})]
        code = [cell for cell in notebook.cells if cell.cell_type == "code"]
        code[-1].outputs += reports


def _kernel_manager(folder: Path) -> Any:
    manager = AsyncKernelManager(kernel_spec_manager=ThisPython())
    # Sockets in the file system: a kernel that starts beside others never finds its port taken.
    manager.transport = "ipc"
    manager.ip = str(folder / "k")
    manager.connection_file = str(folder / "kernel.json")
    return manager


def main() -> None:
    """Run the notebook that the command line names."""
    source, out, graph, folder = (Path(sys.argv[number]) for number in (1, 2, 3, 5))
    deadline_s = float(sys.argv[4])
    os.environ[EXECUTING] = "1"
    notebook = nbformat.reads(source.read_text(encoding="utf-8"), as_version=4)
    os.environ[DOMAIN_NOTE] = os.fspath(folder / "domain")
    watch = GraphWatch(folder / "domain")
    with contextlib.suppress(KeyboardInterrupt):
        asyncio.run(run(notebook, Path.cwd(), deadline_s, watch, _kernel_manager(folder)))
    _without_end(notebook)
    for cell in notebook.cells:
        if cell.cell_type == "code":
            cell.outputs = joined(cell.outputs)
            with_short_lines(cell.outputs, whole_in(Path.cwd(), cell.id))
    if watch.graph is not None:
        write_if_changed(graph, watch.graph.to_json())
    write_if_changed(out, json.dumps(notebook, ensure_ascii=False, indent=1, sort_keys=True) + "\n")


if __name__ == "__main__":
    main()
