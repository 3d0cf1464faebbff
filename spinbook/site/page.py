"""A page of the site: its name, what Sphinx reads, and what the frame around it needs."""

from __future__ import annotations

import json
import re
from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Any

_BLOB = re.compile(r"(https://github\.com/[^/]+/[^/]+)/blob/[^/]+/([^?#]+\.md)(?:[?#].*)?")


def edit_address(source: str) -> str:
    """Return where GitHub lets a reader change the file that `source` shows; "" for what is not Markdown on GitHub."""
    match = _BLOB.fullmatch(source)
    return f"{match[1]}/edit/main/{match[2]}" if match else ""


@dataclass(frozen=True)
class Page:
    """One page. `name` is its path without a suffix, such as chapters/03-nodes-and-topics.

    `text` is a notebook or Markdown, by `suffix`. `notebook` names the notebook that its reader can run, `about` is
    what the theme shows of it beside the text. `summary` is one sentence, for search engines and the home page. `runs`
    says whether its cells can run in the browser.
    """

    name: str
    title: str
    kind: str
    suffix: str
    text: str
    source: str = ""
    notebook: str = ""
    summary: str = ""
    about: Mapping[str, Any] = field(default_factory=dict)
    runs: bool = False

    def frame(self, openers: Mapping[str, list[dict[str, str]]]) -> str:
        """What the theme reads of the page, as JSON. `openers` are the places that open a notebook, by its name."""
        return json.dumps(
            {
                "kind": self.kind,
                "source": self.source,
                "edit": edit_address(self.source),
                "notebook": self.notebook,
                "openers": openers.get(self.notebook, []),
                "summary": self.summary,
                "runs": self.runs,
                **self.about,
            },
            ensure_ascii=False,
            indent=1,
            sort_keys=True,
        )


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
