"""One check as a program: `python -m spinbook.doctor.examine MODULE NAME` prints its finding as one line of JSON.

A process of its own, because what is examined may end it: rclpy does so where its middleware is not installed.
"""

from __future__ import annotations

import dataclasses
import importlib
import json
import os
import sys

from spinbook.doctor.finding import Finding


def main(module: str, name: str) -> None:
    """Run the module's check. What libraries print meanwhile goes to stderr, so that stdout holds the finding alone."""
    answer = os.dup(1)
    os.dup2(2, 1)
    finding = importlib.import_module(module).examine(name)
    assert isinstance(finding, Finding)
    with os.fdopen(answer, "w") as out:
        json.dump(dataclasses.asdict(finding), out)


if __name__ == "__main__":
    main(*sys.argv[1:])
