"""What a new grading of a submission changed."""

from __future__ import annotations

from grader.grading import Grade


def difference(before: Grade, after: Grade) -> str:
    """In words, beginning with the two scores: which checks went up, and which down. Empty where nothing changed."""
    old = {verdict.name: verdict for verdict in before.verdicts}
    new = {verdict.name: verdict for verdict in after.verdicts}
    up, down = [], []
    for name in [*new, *(name for name in old if name not in new)]:
        earned = [found.earned if found else 0.0 for found in (old.get(name), new.get(name))]
        if earned[1] > earned[0]:
            up.append(f"{name} (+{earned[1] - earned[0]:g})")
        elif earned[1] < earned[0]:
            down.append(f"{name} (-{earned[0] - earned[1]:g})")
    told = [f"up: {', '.join(up)}"] if up else []
    told += [f"down: {', '.join(down)}"] if down else []
    if before.outcome != after.outcome:
        told.append(f"{before.outcome}, now {after.outcome}")
    if not told and before.score == after.score:
        return ""
    return "; ".join([f"{before.score:g} -> {after.score:g} points", *told])
