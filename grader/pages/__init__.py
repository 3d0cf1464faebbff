"""What all of the grader's pages share: how they look, and that no text in them can become markup."""

from grader.pages.rendering import render

__all__ = ["render"]
