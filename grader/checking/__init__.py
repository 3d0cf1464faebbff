"""What the author of checks uses: `check` to mark one, `fail` to end one, and the runs that fixtures give.

A page for authors is in docs/writing-checks.md.
"""

from typing import TYPE_CHECKING, Any

from grader.checking.verdict import Wrong, check, fail

if TYPE_CHECKING:
    from grader.checking.run import Exchange, Message, Run

__all__ = ["Exchange", "Message", "Run", "Wrong", "check", "fail"]


def __getattr__(name: str) -> Any:
    """Import runs only for those who use them: a command that shows a grade needs verdicts alone."""
    if name not in __all__:
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    from grader.checking import run

    return getattr(run, name)
