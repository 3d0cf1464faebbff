"""Starts code that does not start itself: `python -m spinbook.kernel.entry FILE HOW [-- ARGS]`.

HOW is `--main` or `--class A [--class B …]`. `--main` calls the file's `main`, as the executable of an installed
package does. `--class` spins Node classes that come without a main, all in one process; `--class A.run` calls a method
first, and spins then if there is something to wait for.

This file imports nothing of ROS before the code has run: code that forgets an import must fail here, too.
"""

from __future__ import annotations

import contextlib
import inspect
import runpy
import sys
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any


def main() -> None:
    """Start what the command line names."""
    file, words = Path(sys.argv[1]), sys.argv[2:]
    own, rest = (words[: words.index("--")], words[words.index("--") + 1 :]) if "--" in words else (words, [])
    sys.argv = [str(file), *rest]
    start(runpy.run_path(str(file), run_name=file.stem), own)


def start(module: Mapping[str, Any], own: Sequence[str]) -> None:
    """Start a module's `main` or its classes; `own` are the arguments HOW."""
    if "--main" in own:
        sys.exit(_call(module["main"]))
    names = [name.partition(".") for name in own if name != "--class"]
    _spin([(module[name], method) for name, _, method in names])


def _call(start: Any) -> Any:
    """Call a `main`, with None for each required argument."""
    required = [
        p
        for p in inspect.signature(start).parameters.values()
        if p.default is p.empty and p.kind in {p.POSITIONAL_ONLY, p.POSITIONAL_OR_KEYWORD}
    ]
    return start(*[None] * len(required))


def _spin(classes: Sequence[tuple[Any, str]]) -> None:
    """Make a node of each class, call its method if there is one, and spin them until Ctrl-C."""
    import rclpy

    rclpy.init()
    nodes = [make() for make, _ in classes]

    from rclpy.executors import ExternalShutdownException, SingleThreadedExecutor

    together = SingleThreadedExecutor()
    with contextlib.suppress(KeyboardInterrupt, ExternalShutdownException):
        waits = [_waits(node, method) for node, (_, method) in zip(nodes, classes, strict=True)]
        if any(waits) and all(together.add_node(node) for node in nodes):
            together.spin()
    for node in nodes:
        node.destroy_node()
    rclpy.try_shutdown()


def _waits(node: Any, method: str) -> bool:
    """Call a node's method, print what it returns, and return whether the node has something to wait for then."""
    if not method:
        return True
    if (value := getattr(node, method)()) is not None:
        print(f"{method}() returned {value!r}", flush=True)
    return bool(node.context.ok()) and any(map(list, (node.timers, node.subscriptions)))


if __name__ == "__main__":
    main()
