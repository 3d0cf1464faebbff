"""`%graph` and `%turtle`: the node graph and turtlesim's window as pictures in the notebook."""

from __future__ import annotations

import base64
import os
import sys
import tempfile
from pathlib import Path

from IPython.display import display

from spinbook.graph.layout import drawings
from spinbook.graph.model import NodeGraph
from spinbook.graph.picture import in_words, node_graph_svg
from spinbook.kernel.process import CellFailed, KeptProcess

#: How long the look may take beyond the counting (s).
_GRAPH_LIMIT_S = 20.0


def show_graph(seconds: float) -> None:
    """Look at the graph, count messages for so many seconds, and show it. Raises CellFailed."""
    process = KeptProcess([sys.executable, "-m", "spinbook.graph.now", str(seconds)], os.environ, Path.cwd())
    try:
        status = process.wait(seconds + _GRAPH_LIMIT_S)
        said = process.read_all()[0].decode(errors="replace")
    finally:
        process.close()
    try:
        graph = NodeGraph.from_json(said[said.index("{") :])
    except ValueError:
        raise CellFailed(said.strip() or f"The graph could not be looked at (exit code {status.exit}).") from None
    if not graph.nodes:
        print("No nodes. Run a cell that begins with %%node.")
        return
    words = in_words(drawings(graph))
    bundle = {"image/svg+xml": node_graph_svg(graph, standalone=True), "text/plain": words}
    display(bundle, raw=True, metadata={"image/svg+xml": {"alt": words}})


#: How long the turtle may take to answer, listening to the real one's poses included (s).
_TURTLE_LIMIT_S = 30.0


def show_turtle() -> None:
    """Ask the running turtlesim for its picture and show it. Raises CellFailed where none answers."""
    with tempfile.TemporaryDirectory(prefix="spinbook-") as folder:
        file, moving = Path(folder) / "turtle.png", Path(folder) / "turtle.svg"
        argv = [sys.executable, "-m", "spinbook.turtlesim.picture", os.fspath(file), "--moving", os.fspath(moving)]
        process = KeptProcess(argv, os.environ, Path.cwd())
        try:
            status = process.wait(_TURTLE_LIMIT_S)
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
