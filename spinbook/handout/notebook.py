"""A chapter's notebook as students get it."""

from __future__ import annotations

import json
import re
from typing import Any

from spinbook.handout.comments import without_comments


def for_students(notebook: str, repository: str) -> str:
    """A built notebook without outputs and authors' comments; links to a task lead to the copy beside it."""
    entries: dict[str, Any] = json.loads(notebook)
    away = f"{re.escape(repository)}/blob/main/" if repository else r"\.\./"
    link = re.compile(rf"(\]\(){away}(exercises/\w+/task\.md)")
    for cell in entries["cells"]:
        if cell["cell_type"] == "markdown":
            cell["source"] = link.sub(r"\1\2", without_comments(cell["source"]))
        else:
            cell["outputs"], cell["execution_count"] = [], None
    return json.dumps(entries, ensure_ascii=False, indent=1, sort_keys=True) + "\n"
