"""A grade for programs."""

from __future__ import annotations

import dataclasses
import json
import math
from typing import Any

from grader.grading import Grade


def as_json(grade: Grade) -> str:
    """The grade as JSON text: every field but the recordings, with the keys always in one order."""
    entries = {
        field.name: getattr(grade, field.name)
        for field in dataclasses.fields(grade)
        if field.name not in ("recordings", "references", "verdicts")
    }
    entries["verdicts"] = [dataclasses.asdict(verdict) | {"earned": verdict.earned} for verdict in grade.verdicts]
    return json.dumps(_finite(entries), indent=2, ensure_ascii=False, allow_nan=False) + "\n"


def _finite(value: Any) -> Any:
    """JSON has no word for NaN and infinity."""
    if isinstance(value, float) and not math.isfinite(value):
        return None
    if isinstance(value, dict):
        return {key: _finite(item) for key, item in value.items()}
    if isinstance(value, (list, tuple)):
        return [_finite(item) for item in value]
    return value
