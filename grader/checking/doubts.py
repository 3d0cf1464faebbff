"""What a check that passes could not test, because its scenarios do not tell right from wrong there.

A helper notes it while a check runs. Checks are judged one after another in a process.
"""

from __future__ import annotations

_notes: list[tuple[str, bool]] = []


def begin() -> None:
    """Forget what was noted about the check before."""
    _notes.clear()


def note(text: str, tested: bool) -> None:
    """Note whether a scenario tests a rule; if not, `text` says what passes all the same."""
    _notes.append((text, tested))


def untested() -> str:
    """Return what passes all the same; "" if one of the check's scenarios tells the difference."""
    return _notes[0][0] if _notes and not any(tested for _, tested in _notes) else ""
