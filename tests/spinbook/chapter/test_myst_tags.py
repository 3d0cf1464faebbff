"""The tags of MyST's code cells do what MyST says, whether they are in a YAML block or in `:tags:`."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Any

import pytest
from course_folder import CourseFolder

from groundwork.files import write_if_changed
from spinbook.build.notebooks import build_notebooks
from spinbook.course.course import read_course
from spinbook.site.build import build_site

TAGS = ("hide-input", "hide-output", "hide-cell", "remove-input", "remove-output", "remove-cell")
CHAPTER = "# Tags\n\n" + "\n".join(
    f'```{{code-cell}} ipython3\n{options}\n"code of {tag}"\n```\n'
    for number, tag in enumerate(TAGS)
    for options in [f"---\ntags: [{tag}]\n---" if number % 2 else f":tags: [{tag}]\n"]
)
OTHERS = """
```{code-cell} ipython3
---
tags:
  - raises-exception
mystnb:
  number_source_lines: true
---

raise ValueError("on purpose")
```

+++ {"tags": ["a-break"]}

```{code-cell}
:tags: [skip-execution]
import no_such_package
never = 1
```

```{code-cell} bash
---
tags: skip-execution
---
ros2 run no_such_package no_such_node
```

```{code-cell}
:tags: [skip-execution]
this is: not Python
```

```{code-cell}
print(never)
```
"""


@pytest.fixture(scope="module")
def course(tmp_path_factory: pytest.TempPathFactory) -> CourseFolder:
    """The chapter as a notebook, and as a page that shows an output for each cell."""
    folder = CourseFolder(tmp_path_factory.mktemp("tags")).write(tags=CHAPTER + OTHERS)
    course = read_course(folder.root)
    list(build_notebooks(course))
    notebook = json.loads((folder.root / "build/notebooks/tags.ipynb").read_text())
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code":
            text = cell["source"].replace("code", "output").strip('"')
            cell["outputs"] = [{"output_type": "stream", "name": "stdout", "text": text}]
    write_if_changed(folder.root / "build/executed/tags.ipynb", json.dumps(notebook))
    assert build_site(course, lambda page: None, as_it_ran=True).problems == ()
    return folder


def cells(course: CourseFolder) -> list[Any]:
    return [cell for cell in course.notebook("tags").cells if cell.cell_type == "code"][1:]


def page(root: Path) -> str:
    return (root / "build/site/chapters/tags.html").read_text()


@pytest.mark.parametrize("tag", TAGS)
def test_a_notebook_has_the_tag_and_folds_what_it_hides(course: CourseFolder, tag: str) -> None:
    cell = next(cell for cell in cells(course) if tag in cell.source)

    assert cell.metadata.tags == [tag]
    assert ("source_hidden" in cell.metadata.jupyter) == (tag.partition("-")[2] in {"input", "cell"})
    assert ("outputs_hidden" in cell.metadata.jupyter) == (tag.partition("-")[2] in {"output", "cell"})


@pytest.mark.parametrize("tag", TAGS)
def test_a_page_folds_or_leaves_out_what_the_tag_says(course: CourseFolder, tag: str) -> None:
    html = page(course.root)
    removed = tag.startswith("remove")

    assert (f"code of {tag}" in html) != (removed and not tag.endswith("output"))
    assert (f"output of {tag}" in html) != (removed and not tag.endswith("input"))


def test_the_parts_of_the_page_that_tags_hide_are_folded(course: CourseFolder) -> None:
    parts = page(course.root).split('<details class="hidden-part"><summary>')[1:]

    folded = [part.partition("</details>")[0] for part in parts]
    names = ["code of hide-input", "output of hide-output", "code of hide-cell", "output of hide-cell"]
    assert [name in part for name, part in zip(names, folded, strict=True)] == [True] * 4


def test_an_expected_error_may_be_in_a_block_of_yaml(course: CourseFolder) -> None:
    cell = next(cell for cell in cells(course) if "on purpose" in cell.source)

    assert cell.source == 'raise ValueError("on purpose")'
    assert cell.metadata.tags == ["raises-exception"]
    assert cell.metadata.spinbook.line == CHAPTER.count("\n") + 10


def test_skipped_cells_are_in_the_notebook_and_not_run(course: CourseFolder) -> None:
    skipped = [cell.source for cell in cells(course) if "skip-execution" in cell.metadata.get("tags", [])]

    assert skipped == [
        "import no_such_package\nnever = 1",
        "%ros2 run no_such_package no_such_node",
    ]


def test_what_a_skipped_cell_would_define_is_not_there_below(course: CourseFolder) -> None:
    prose = [cell.source for cell in course.notebook("tags").cells if cell.cell_type == "markdown"]

    assert "it uses `never`, which no snippet that runs above defines" in prose[-1]
    assert not any("+++" in text for text in prose)
