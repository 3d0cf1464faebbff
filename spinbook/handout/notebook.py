"""A chapter's notebook as students get it."""

from __future__ import annotations

import json
import re
from typing import Any

from spinbook.handout.comments import without_comments

#: What of a notebook's, and of a cell's, metadata students get. Whatever an editor has added stays behind.
_NOTEBOOK_KEYS = ("kernelspec", "language_info", "spinbook", "title")
_CELL_KEYS = ("spinbook", "tags")

_HELP = """\
# It says "No module named 'spinbook'"? Choose the handout's .venv as this notebook's kernel,
# or do step 1 of README.md. In Colab: README.md tells how.
"""


def for_students(notebook: str, repository: str) -> str:
    """A built notebook without outputs and authors' comments; links to a task lead to the copy beside it."""
    entries: dict[str, Any] = json.loads(notebook)
    away = f"{re.escape(repository)}/blob/main/" if repository else r"\.\./"
    link = re.compile(rf"(\]\(){away}(exercises/\w+/task\.md)")
    entries["metadata"] = {key: entries["metadata"][key] for key in _NOTEBOOK_KEYS if key in entries["metadata"]}
    for cell in entries["cells"]:
        cell["metadata"] = {key: cell["metadata"][key] for key in _CELL_KEYS if key in cell["metadata"]}
        if cell["cell_type"] == "markdown":
            cell["source"] = link.sub(r"\1\2", without_comments(cell["source"]))
        else:
            cell["outputs"], cell["execution_count"] = [], None
            if cell["metadata"].get("spinbook", {}).get("kind") == "setup":
                cell["source"] = cell["source"].replace("%load_ext", f"{_HELP}%load_ext", 1)
    return json.dumps(entries, ensure_ascii=False, indent=1, sort_keys=True) + "\n"
