"""What the author of checks uses: `check` to mark one, `fail` to end one, and the runs that fixtures give.

A page for authors is in docs/writing-checks.md.
"""

from grader.checking.run import Exchange, Message, Run
from grader.checking.verdict import Wrong, check, fail

__all__ = ["Exchange", "Message", "Run", "Wrong", "check", "fail"]
