"""Takes out of what a program printed what helps no student: frames of libraries, and the grading machine's paths."""

from __future__ import annotations

import re
import sys

_ENVIRONMENT = re.compile(rf"{re.escape(sys.prefix)}(?![\w.-])/?")
#: Files of an installed Python, and of a page's; Python's own code is in `lib/python3.12` or `python312.zip`.
_LIBRARY = re.compile(r".*/(?:(?:site|dist)-packages|lib\d*/python3[^/]*)/|/(?:ros|check|share)\.zip/|/lib/|<frozen ")
#: A frame with its code; a launched program's has the program's name before it. Which files are libraries' is asked
#: afterwards: a pattern of both would take quadratic time for a long line.
_FRAME = re.compile(
    r'^((?:\[[\w./-]+\] )? *)File "([^"\n]*)", line \d+.*\n(?:\1(?: (?! *File ")|\[Previous line repeated ).*\n)*',
    re.MULTILINE,
)


#: What faulthandler prints when C code ends a program; the line is told elsewhere. Why Python itself does has a colon.
_OF_AN_ABORT = re.compile(
    r"^Fatal Python error: [^:\n]*\n(?:\n*(?:Stack|Current thread|Extension modules).*\n(?:  .*\n)*)*", re.MULTILINE
)


def with_own_frames(log: str) -> str:
    """Return a log whose tracebacks have the program's own frames only."""
    return _FRAME.sub(lambda frame: "" if _LIBRARY.match(frame[2]) else frame[0], _OF_AN_ABORT.sub("", log))


def without_paths(log: str) -> str:
    """Return a log with the program's own frames only, and without the submission's and the environment's folders."""
    return _ENVIRONMENT.sub("", with_own_frames(log).replace('File "/submission/', 'File "'))
