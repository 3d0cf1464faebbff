"""Removes a check from an exercise."""

from __future__ import annotations

import re
from pathlib import Path


def remove_check(file: Path, check: str) -> None:
    """Remove a check from a file of checks."""
    text = file.read_text(encoding="utf-8")
    end = r"(?=\n@check|\n\n\ndef _|\Z)"
    shorter = re.sub(rf"@check\((?:(?!@check).)*?\ndef {check}\b.*?{end}", "", text, flags=re.DOTALL)
    assert shorter != text
    file.write_text(shorter, encoding="utf-8")
