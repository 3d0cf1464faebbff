"""One check as a program: `python -m spinbook.doctor.examine WORD` prints its finding as one line of JSON.

A process of its own, because what is examined may end it: rclpy does so where its middleware is not installed.
"""

from __future__ import annotations

import dataclasses
import importlib
import json
import os
import sys

from spinbook.doctor.checks import CHECKS
from spinbook.doctor.finding import Finding


def main(word: str) -> None:
    """Run a check. What libraries print meanwhile goes to stderr, so that stdout holds the finding alone."""
    answer = os.dup(1)
    os.dup2(2, 1)
    check = next(check for check in CHECKS if check.word == word)
    module = importlib.import_module(f"spinbook.doctor.{check.module}")
    finding = module.examine(check.name)
    assert isinstance(finding, Finding)
    with os.fdopen(answer, "w") as out:
        json.dump(dataclasses.asdict(finding), out)


if __name__ == "__main__":
    main(sys.argv[1])
