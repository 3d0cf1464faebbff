"""The tree that these tests belong to: what they start runs its Spinbook, not one that was installed elsewhere."""

from __future__ import annotations

import json
import os
from importlib import metadata
from pathlib import Path

ROOT = Path(__file__).parents[2]


def _pythonpath() -> str:
    """PYTHONPATH, as the tests were started with it; before it this tree, if the environment was made for another."""
    given = [entry for entry in os.environ.get("PYTHONPATH", "").split(os.pathsep) if entry]
    installed = json.loads(metadata.distribution("spinbook").read_text("direct_url.json") or "{}").get("url")
    own = [os.fspath(folder) for folder in (ROOT, *sorted(ROOT.glob("packages/*")))]
    return os.pathsep.join(given if installed == ROOT.as_uri() else [*own, *(one for one in given if one not in own)])


PYTHONPATH = _pythonpath()
