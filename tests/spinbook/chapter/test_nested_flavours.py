"""What book tools add to Markdown is also read inside lists, lists in lists and quotations."""

from __future__ import annotations

import re
import shutil
from dataclasses import dataclass

import pytest
from course_folder import CourseFolder
from markdown_it import MarkdownIt

from spinbook.build.notebooks import build_notebooks
from spinbook.course.course import read_course
from spinbook.site.build import build_site

#: Kind of flavour -> how it is written around WORDS, and the title that a reader sees; None where there is none.
FLAVOURS = {
    "docusaurus": ((":::warning[Hot]", "WORDS", ":::"), "Hot"),
    "vitepress": (("::: tip", "WORDS", ":::"), "Tip"),
    "myst-colons": ((":::{important}", "WORDS", ":::"), "Important"),
    "myst-fence": (("```{note}", "WORDS", "```"), "Note"),
    "quarto": (("::: {.callout-tip}", "WORDS", ":::"), "Tip"),
    "mkdocs": (('!!! note "Look"', "    WORDS"), "Look"),
    "mdx": (('<Admonition type="warning" title="Sharp">', "WORDS", "</Admonition>"), "Sharp"),
    "starlight": (('<Aside type="caution" title="Keep off">', "WORDS", "</Aside>"), "Keep off"),
    "nextra": (("<Callout title={'Read'} type=\"info\">", "  WORDS", "</Callout>"), "Read"),
    "mdx-indented": (("<Tabs>", '  <TabItem label="A">', "    WORDS", "  </TabItem>", "</Tabs>"), None),
    "starlight-indented": (('<Aside title="Inside">', "", "    WORDS", "", "</Aside>"), "Inside"),
    "one-line": (('<Aside type="tip" title="Short">WORDS</Aside>',), "Short"),
    "gitbook": (('{% hint style="danger" %}', "WORDS", "{% endhint %}"), "Caution"),
    "kramdown": (("WORDS", "{: .warning }"), "Warning"),
    "kramdown-title": (("{: .note-title }", "> Oiled", ">", "> WORDS"), "Oiled"),
    "docusaurus-property": ((':::note{title="Loud"}', "WORDS", ":::"), "Loud"),
    "quarto-heading": (("::: {.callout-note}", "## Wet", "", "WORDS", ":::"), "Wet"),
    "hugo": (('{{< callout type="warning" >}}', "WORDS", "{{< /callout >}}"), "Warning"),
    "hugo-hint": (("{{< hint danger >}}", "WORDS", "{{< /hint >}}"), "Caution"),
    "hugo-notice": (('{{% notice tip "Dry" %}}', "WORDS", "{{% /notice %}}"), "Dry"),
    "hugo-folded": (('{{< expand "More" >}}', "WORDS", "{{< /expand >}}"), None),
    "docsify": (("?> WORDS",), "Tip"),
    "mkdocs-blocks": (("/// tip | Calm", "    open: true", "", "WORDS", "///"), "Calm"),
    "mkdocs-folded": (("??? tip", "    WORDS"), None),
    "mkdocs-tab": (('=== "Python"', "    WORDS"), None),
    "mdx-tabs": (("<Tabs>", '<TabItem label="Python">', "", "WORDS", "", "</TabItem>", "</Tabs>"), None),
    "mdx-comment": (("{/* for authors */}", "", "WORDS"), None),
    "mdx-import": (("import Tabs from '@theme/Tabs';", "", "WORDS"), None),
    "myst-label": (("(here)=", "WORDS"), None),
    "myst-unseen": (("```{toctree}", "other", "```", "", "WORDS"), None),
    "snippet": (('--8<-- "words.md"', "", "WORDS"), None),
}

#: What holds it: the lines before, the beginning of its first line, the beginning of each other line,
#: and in how many items of lists it is.
HOLDERS = {
    "list": (("- First", ""), "  ", "  ", 1),
    "steps": (("1. First", "", "2. Second", ""), "   ", "   ", 1),
    "list-in-a-list": (("- Outer", "  1. Inner", ""), "     ", "     ", 2),
    "first-in-an-item": ((), "* ", "  ", 1),
    "quotation": (("> First", ">"), "> ", "> ", 0),
    "list-in-a-quotation": (("> - First", ">"), ">   ", ">   ", 1),
}

CASES = [(flavour, holder) for flavour in FLAVOURS for holder in HOLDERS]


def words(flavour: str, holder: str) -> str:
    return f"Words of {flavour} in {holder}."


def written(flavour: str, holder: str) -> str:
    (before, first, rest, _), lines = HOLDERS[holder], FLAVOURS[flavour][0]
    text = [line.replace("WORDS", words(flavour, holder)) for line in lines]
    held = [f"{rest if number else first}{line}".rstrip() for number, line in enumerate(text)]
    return "\n".join((f"Before {flavour} in {holder}.", "", *before, *held, "", f"After {flavour} in {holder}.", ""))


@dataclass(frozen=True)
class Built:
    """The chapter as its notebook and as its page show it."""

    notebook: str
    page: str


@pytest.fixture(scope="module")
def built(tmp_path_factory: pytest.TempPathFactory) -> Built:
    folder = CourseFolder(tmp_path_factory.mktemp("nested"))
    folder.write(nested="# Nested\n\n" + "\n".join(written(*case) for case in CASES))
    (folder.root / "words.md").write_text("Words of the snippet.\n")
    course = read_course(folder.root)
    assert [item.problems for item in build_notebooks(course)] == [()]
    shutil.copytree(folder.root / "build/notebooks", folder.root / "build/executed")
    assert build_site(course, lambda page: None, as_it_ran=True).problems == ()
    cells = folder.notebook("nested").cells
    prose = "\n\n".join(cell.source for cell in cells if cell.cell_type == "markdown")
    return Built(prose, (folder.root / "build/site/chapters/nested.html").read_text())


def part(text: str, flavour: str, holder: str) -> str:
    """Return what is between the words before and behind a case."""
    return text.partition(f"Before {flavour} in {holder}.")[2].partition(f"After {flavour} in {holder}.")[0]


@pytest.mark.parametrize(("flavour", "holder"), CASES)
def test_a_notebook_shows_it_as_plain_markdown_that_stays_inside(built: Built, flavour: str, holder: str) -> None:
    html = MarkdownIt("commonmark").render(part(built.notebook, flavour, holder))
    inside = html.partition(words(flavour, holder))[0]

    assert html.count(words(flavour, holder)) == 1
    assert inside.count("<blockquote>") == ("quotation" in holder) + (FLAVOURS[flavour][1] is not None)
    assert inside.count("<li>") - inside.count("</li>") == HOLDERS[holder][3]
    assert f"<strong>{FLAVOURS[flavour][1]}</strong>" in inside or FLAVOURS[flavour][1] is None


@pytest.mark.parametrize(("flavour", "holder"), CASES)
def test_a_page_shows_it_with_its_title(built: Built, flavour: str, holder: str) -> None:
    html, title = part(built.page, flavour, holder), FLAVOURS[flavour][1]

    assert html.count(words(flavour, holder)) == 1
    assert title is None or f'<p class="admonition-title">{title}</p>' in html


def test_nothing_of_a_book_tools_own_language_is_left(built: Built) -> None:
    marks = (
        r"\{\{|:::|!!!|\?\?\?|===|\{%|\{:|\{/\*|\)=|8<|</?Tab|</?Adm|</?Aside|</?Call|import Tabs"
        r"|toctree|[!?]&gt; |[!?]> "
    )

    assert re.findall(marks, built.notebook) == []
    assert re.findall(marks, built.page.partition("<article")[2].partition("</article>")[0]) == []


def test_a_folded_block_without_a_title_is_called_as_its_kind(built: Built) -> None:
    assert "<summary>Tip</summary>" in part(built.notebook, "mkdocs-folded", "list")


def test_a_snippet_is_included_where_it_is(built: Built) -> None:
    assert "\n  Words of the snippet." in part(built.notebook, "snippet", "list")
