"""The doctor as a person runs it."""

from __future__ import annotations

import json
import os
import subprocess
import sys
from pathlib import Path
from typing import Any


def doctor(
    *arguments: str, folder: str | Path | None = None, **settings: str | None
) -> subprocess.CompletedProcess[str]:
    """Run the command in `folder`, with these variables set, or removed if None."""
    environment = {name: value for name, value in {**os.environ, **settings}.items() if value is not None}
    return subprocess.run(
        [sys.executable, "-m", "spinbook", "doctor", *arguments],
        cwd=folder,
        env=environment,
        capture_output=True,
        text=True,
        timeout=250,
        check=False,
    )


def finding_of(word: str, folder: str | Path | None = None, **settings: str | None) -> dict[str, Any]:
    """Return what one check finds with these variables: its name, state, found and fix."""
    (finding,) = json.loads(doctor("--json", word, folder=folder, **settings).stdout)["findings"]
    assert isinstance(finding, dict)
    return finding
