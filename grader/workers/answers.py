"""The answer of a process of the pool: a result, or whose fault it is that there is none."""

from __future__ import annotations

import traceback
from collections.abc import Callable
from typing import Any

from grader.exercise.exercise import ExerciseError

#: `result` and the result; `author` and an ExerciseError; or `host` and the text of a traceback.
Answer = tuple[str, Any]


def answer_of(work: Callable[[], Any]) -> Answer:
    """Do some work, and return the answer. Raises nothing."""
    try:
        return "result", work()
    except ExerciseError as error:
        return "author", error
    except BaseException:
        return "host", traceback.format_exc()
