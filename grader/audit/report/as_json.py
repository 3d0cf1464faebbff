"""Audits for programs."""

from __future__ import annotations

import dataclasses
import json
import os
import tempfile
from pathlib import Path
from typing import Any

from grader.audit.result import Audit, Problem


def write_json(audits: list[Audit], faults: list[Problem], file: Path) -> None:
    """Write everything the audits found, and the `faults` for which an exercise could not be audited."""
    entries = {
        "audits": [_entries(audit) for audit in audits],
        "faults": [dataclasses.asdict(fault) for fault in faults],
    }
    write(file, json.dumps(entries, indent=2, ensure_ascii=False) + "\n")


def _entries(audit: Audit) -> dict[str, Any]:
    entries = dataclasses.asdict(audit)
    for mutant in entries["mutants"]:
        del mutant["mutant"]["source"]
    counts = {fate: audit.count(fate) for fate in ("caught", "equivalent", "listed", "survived")}
    return {**entries, "score": audit.score, "different": audit.different, **counts}


def write(file: Path, text: str) -> None:
    """Write a file as a whole, or not at all."""
    with tempfile.NamedTemporaryFile("w", encoding="utf-8", dir=file.absolute().parent, delete=False) as temporary:
        temporary.write(text)
    os.chmod(temporary.name, 0o644)  # noqa: PTH101 - a temporary file is its owner's only
    Path(temporary.name).replace(file)
