"""What the pages are called: one place, so that every link agrees."""

from __future__ import annotations

HOME = "index"
GLOSSARY = "glossary"
ABOUT = "about"
SEARCH = "search"

#: Ends the name of the file that stands beside a staged page, with what the theme shows around it.
FRAME_SUFFIX = ".frame.json"


def chapter_page(name: str) -> str:
    """The page of the chapter of this name."""
    return f"chapters/{name}"


def exercise_page(exercise: str) -> str:
    """The page of an exercise."""
    return f"exercises/{exercise}"


def exercise_notebook(exercise: str) -> str:
    """The name of an exercise's notebook, without its suffix."""
    return f"exercise-{exercise}"
