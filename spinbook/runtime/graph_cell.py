"""`%graph`: the nodes and topics there are now, drawn, in rqt_graph's place."""

from __future__ import annotations

import os
import sys
from pathlib import Path

from IPython.display import display

from spinbook.graph.model import NodeGraph
from spinbook.graph.picture import in_words, node_graph_svg
from spinbook.graph.shapes import drawings
from spinbook.runtime.failure import CellFailed
from spinbook.runtime.process import KeptProcess

#: How long the look may take beyond the counting (s).
_LIMIT_S = 20.0


def run(seconds: float) -> None:
    """Look at the graph, count messages for so many seconds, and show it. Raises CellFailed."""
    process = KeptProcess([sys.executable, "-m", "spinbook.graph.now", str(seconds)], os.environ, Path.cwd())
    try:
        status = process.wait(seconds + _LIMIT_S)
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
