"""Pictures are in the notebook however a chapter refers to them."""

from __future__ import annotations

import json
from pathlib import Path

import pytest

from spinbook.build.notebook import notebook_json
from spinbook.chapters import read_all
from spinbook.course.course import read_course


def cells(root: Path, text: str) -> list[dict[str, object]]:
    """Return the prose cells of a chapter next to the picture img/arm.png."""
    (root / "img").mkdir()
    (root / "img/arm.png").write_bytes(b"picture")
    (root / "c.mdx").write_text(text)
    (root / "course.toml").write_text('title = "T"\nchapters = ["c.mdx"]\n[package]\nname = "robot"\n')
    course = read_course(root)
    (result,) = read_all(course)
    assert result.problems == ()
    assert result.chapter is not None
    notebook = json.loads(notebook_json(result.chapter, course))
    return [cell for cell in notebook["cells"] if cell["cell_type"] == "markdown"]


HTML = '<img src="attachment:img-arm.png" alt="an arm" width="{}">'
IMPORT = "import arm from './img/arm.png';\n\n"


@pytest.mark.parametrize(
    ("before", "written", "shown"),
    [
        ("", "![an arm][a]\n\n[a]: img/arm.png", "![an arm](attachment:img-arm.png)\n\n[a]: ../../img/arm.png"),
        ('[a]: img/arm.png "It"\n', "- ![an arm][a]", '- ![an arm](attachment:img-arm.png "It")'),
        ("[an arm]: img/arm.png\n", "![an arm] and ![an arm][]", "![an arm](attachment:img-arm.png)"),
        ("[a]: other.mdx#x 'It'\n", "See [it][a].", 'See [it](../../other.mdx#x "It").'),
        ("", "![an arm](img/arm.png){width=50%}", HTML.format("50%")),
        ("", 'A ![an arm](img/arm.png){: .big width="40"} b', f"A {HTML.format(40)} b"),
        ("[a]: img/arm.png\n", "![an arm][a]{#fig-arm width=3in}", HTML.format("3in")),
        ("", "![an arm](img/arm.png){.big}", "![an arm](attachment:img-arm.png)"),
        ("", '<img src={require("./img/arm.png").default} alt="an arm" width={40} />', HTML.format(40)[:-1] + " />"),
        ("", '- <img src={require("./img/arm.png").default} alt="an arm" width={40} />', f"- {HTML.format(40)[:-1]}"),
        (
            "",
            '<p>\n  An <img src={useBaseUrl("/img/arm.png")} alt="an arm" width={40} />\n</p>',
            f"<p>\n  An {HTML.format(40)[:-1]} />\n</p>",
        ),
        (IMPORT, '<Image src={arm} alt="an arm" width={40} />', HTML.format(40)),
        (
            IMPORT,
            '<img src={arm} alt="an arm" style={{width: 40}} />',
            '<img src="attachment:img-arm.png" alt="an arm" />',
        ),
        ("", "<Figure path='img/arm.png' caption='an arm' />", "![an arm](attachment:img-arm.png)"),
        ("", "Write `<img src={arm} />` for it.", "Write `<img src={arm} />` for it."),
    ],
)
def test_a_picture_is_attached_with_its_words_and_size(tmp_path: Path, before: str, written: str, shown: str) -> None:
    (tmp_path / "other.mdx").write_text("# Other\n")

    *_, last = cells(tmp_path, f"# T\n\n{before}\n## Look\n\n{written}\n")

    assert str(last["source"]).startswith(f"## Look\n\n{shown}")
    assert ("attachments" in last) == ("attachment:" in shown)


@pytest.mark.parametrize(
    ("written", "shown"),
    [
        ('<Card title="Arms" icon="star">\nText.\n</Card>', "**Arms**\n\nText."),
        ('<Accordion title="Arms">\nText.\n</Accordion>', "<details>\n<summary>Arms</summary>\n\nText.\n\n</details>"),
        ('<Aside title="Arms">\n```bash\nros2 node list\n```\n</Aside>', "**Arms**"),
    ],
)
def test_the_title_of_a_component_is_kept(tmp_path: Path, written: str, shown: str) -> None:
    *_, last = cells(tmp_path, f"# T\n\n## Look\n\n{written}\n")

    assert str(last["source"]).replace("\n\n\n", "\n\n") == f"## Look\n\n{shown}"
