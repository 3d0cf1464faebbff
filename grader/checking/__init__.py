"""The names for authors of checks: `check` marks a function as a check, `fail` ends it, `each` judges several
things, and fixtures give it runs.

See docs/writing-checks.md.
"""

from typing import TYPE_CHECKING, Any

from grader.checking.partial import each
from grader.checking.verdict import Wrong, check, fail

if TYPE_CHECKING:
    from grader.checking.run import Exchange, Message, Run

__all__ = ["Exchange", "Message", "Run", "Wrong", "check", "each", "fail"]


def __getattr__(name: str) -> Any:
    """Import `Run` only when it is used: a command that shows a grade needs only verdicts."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from grader.checking import run

    return getattr(run, name)
