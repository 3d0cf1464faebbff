"""What the pages are called: one place, so that every link agrees."""

from __future__ import annotations

from pathlib import Path

HOME = "index"
GLOSSARY = "glossary"
ABOUT = "about"
SEARCH = "search"

#: Ends the name of the file that stands beside a staged page, with what the theme shows around it.
FRAME_SUFFIX = ".frame.json"


def chapter_page(chapter: Path | str) -> str:
    """The page of a chapter, named by its file or its stem."""
    return f"chapters/{Path(chapter).stem}"


def exercise_page(exercise: str) -> str:
    """The page of an exercise."""
    return f"exercises/{exercise}"


def exercise_notebook(exercise: str) -> str:
    """The name of an exercise's notebook, without its suffix."""
    return f"exercise-{exercise}"
