"""What authors indent inside MDX components is text and fences, as in MDX, and no code."""

from __future__ import annotations

from pathlib import Path

import pytest
from fences import cells

from spinbook.chapter.classify import CellKind
from spinbook.chapter.read import read_chapter
from spinbook.chapter.surroundings import Surroundings

TABS = """\
<Tabs
  groupId="language">
  <TabItem label="Python">
    Some words.

    ```python title="a.py"
    for i in range(2):
        print(i)
    ```
  </TabItem>
  <TabItem label="C++">
    ```cpp
    int main();
    ```
  </TabItem>
</Tabs>
"""


@pytest.mark.parametrize("holder", ["", "1. Item\n\n", "- Item\n  - Inner\n\n"])
def test_a_fence_inside_indented_components_is_a_cell_at_any_depth(tmp_path: Path, holder: str) -> None:
    indent = " " * {"": 0, "1": 3, "-": 4}[holder[:1]]
    text = "".join(f"{indent}{line}\n" if line else "\n" for line in TABS.split("\n"))
    (tmp_path / "c.mdx").write_text(f"# T\n\n{holder}{text}\nEnd.\n")

    chapter = read_chapter(tmp_path, Path("c.mdx"), Surroundings("robot")).chapter

    assert chapter is not None
    (node,) = cells(chapter)
    assert (node.kind, node.source) == (CellKind.NODE, "for i in range(2):\n    print(i)\n")
    prose = "\n".join(cell.source for cell in chapter.cells)
    assert "<summary>C++</summary>" in prose
    assert "```cpp\nint main();\n```" in prose.replace("\n" + indent, "\n")


@pytest.mark.parametrize(
    "text",
    [
        "```xml\n<Robot>\n    <Arm/>\n</Robot>\n```\n",
        "Text <Never> closed.\n\n    code\n",
        "Text\n\n    <Indented>\n        code\n",
    ],
)
def test_what_is_no_component_stays_as_it_is(tmp_path: Path, text: str) -> None:
    (tmp_path / "c.md").write_text(f"# T\n\n{text}")

    chapter = read_chapter(tmp_path, Path("c.md"), Surroundings("robot")).chapter

    assert chapter is not None
    assert chapter.cells[0].source == f"# T\n\n{text}".rstrip("\n")
