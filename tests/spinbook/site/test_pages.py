"""What the pages contain: text, outputs, exercises, glossary, downloads; and what they must not contain."""

from __future__ import annotations

import ast
import json
import re
import subprocess
import sys
import xml.etree.ElementTree as ElementTree
from dataclasses import replace
from pathlib import Path
from urllib.parse import unquote, urldefrag

import nbformat
import pytest
from latex2mathml.converter import convert
from small_course import ROOT, SmallCourse

from spinbook.browser.files import pyodide_files, pyodide_folder
from spinbook.chapter.chapter import ChapterCell
from spinbook.chapter.classify import CellKind
from spinbook.site.command_lexer import CommandLexer
from spinbook.site.extension import fold_mains, spaced
from spinbook.site.page import Repository
from spinbook.site.prose import Links, rich
from spinbook.site.repetition import Repetition, repetitions

TALK = "chapters/01-talk.html"
EXERCISE = "exercises/joint_velocity.html"


def text_of(html: str) -> str:
    return re.sub(r"\s+", " ", re.sub(r"<[^>]+>", "", html))


def test_every_page_is_there(built: SmallCourse) -> None:
    assert built.pages == [
        "404.html", "about.html", TALK, "chapters/02-more.html", EXERCISE, "glossary.html", "index.html", "search.html",
    ]  # fmt: skip


def test_a_node_s_log_stands_in_order_below_its_code(built: SmallCourse) -> None:
    page = text_of(built.page(TALK))

    lines = ["class Talker(Node)", "[talker]: number 1", "[talker]: SAFETY: two", "[talker]: number 3"]
    places = [page.index(line) for line in lines]
    assert places == sorted(places)


def test_a_warning_in_a_log_stands_out(built: SmallCourse) -> None:
    assert re.search(r'<span class="gs">\[WARN\] [^<]*SAFETY: two', built.page(TALK))


def test_a_cell_that_is_meant_to_fail_says_so(built: SmallCourse) -> None:
    page = text_of(built.page(TALK))

    assert page.index("it fails, as expected") < page.index("ZeroDivisionError")


def test_the_code_is_shown_as_it_was_written_without_the_notebook_s_magics(built: SmallCourse) -> None:
    assert "%%node" not in built.page(TALK)
    assert (built.site / "downloads" / "talker.py").read_text().startswith('"""Talks."""')


def test_alerts_maths_and_drawings_are_more_than_text(built: SmallCourse) -> None:
    page = built.page(TALK)

    assert 'class="admonition warning"' in page
    assert page.count("<math") == 2
    assert "left toe → /left_foot/toe" in page  # in words, if no drawing can be made


def test_the_chapter_leads_to_the_next_one_and_to_the_source_line(built: SmallCourse) -> None:
    page = built.page(TALK)

    assert 'href="02-more.html"' in page
    line = next(
        n for n, s in enumerate((built.root / "chapters/01-talk.md").read_text().split("\n"), 1) if "Talks" in s
    )
    assert f"https://github.com/example/course/blob/main/chapters/01-talk.md?plain=1#L{line}" in page


def test_a_chapter_opens_in_colab_binder_and_codespaces(built: SmallCourse) -> None:
    page = built.page(TALK)

    for place in ("colab.research.google.com", "mybinder.org", "codespaces.new"):
        assert re.search(rf'href="https://{re.escape(place)}/[^"]*01-talk', page)


def test_the_first_use_of_a_term_leads_to_the_glossary(built: SmallCourse) -> None:
    page = built.page(TALK)

    assert page.count('href="../glossary.html#publisher"') == 1
    assert 'id="publisher"' in built.page("glossary.html")
    assert 'href="../glossary.html#givetake"' in built.page("chapters/02-more.html")


def test_a_term_in_a_link_to_another_page_stays_a_part_of_that_link(built: SmallCourse) -> None:
    page = built.page("chapters/02-more.html")

    assert '<span class="std std-doc">publisher and messages</span></a>. No <a class="term' in page


def test_an_exercise_has_task_interface_starter_and_points(built: SmallCourse) -> None:
    page = text_of(built.page(EXERCISE))

    assert "100 points" in page
    assert re.search(r"publishes on /joint_velocities sensor_msgs/msg/JointState keep last 10.*velocity in rad/s", page)
    assert "It publishes one message for each message after the first." in page
    assert "sensor_msgs/<wbr>msg/<wbr>JointState</code>" in built.page(EXERCISE), "a long type may break in a table"
    starter = (built.site / "downloads" / "joint_velocity.py").read_text()
    assert "SOLUTION" not in starter
    ast.parse(starter)


def test_the_about_page_names_versions(built: SmallCourse) -> None:
    page = text_of(built.page("about.html"))

    assert re.search(r"Python 3\.\d+\.\d+", page)
    assert "rclpy" in page


def test_notebooks_to_download_begin_by_installing_what_is_missing(built: SmallCourse) -> None:
    for file in [*(built.site / "downloads").glob("*.ipynb"), *(built.root / "build" / "launch").glob("*.ipynb")]:
        notebook = nbformat.read(file, as_version=4)
        nbformat.validate(notebook)
        first = next(cell for cell in notebook.cells if cell.cell_type == "code")
        assert "spinbook[ros,colcon,notebooks] @ git+https://github.com/spinbook/spinbook" in first.source
        assert "pip" in first.source


def test_an_exercise_s_notebook_holds_all_that_it_takes_to_do_it_and_check_it(
    built: SmallCourse, tmp_path: Path
) -> None:
    notebook = nbformat.read(built.site / "downloads" / "exercise-joint_velocity.ipynb", as_version=4)
    kinds = [cell.metadata.get("spinbook", {}).get("kind", cell.cell_type) for cell in notebook.cells]
    assert kinds == ["markdown", "install", "exercises", "setup", "exercise", "markdown", "check"]
    assert "/joint_velocities" in notebook.cells[0].source
    assert notebook.cells[-1].source == "%check joint_velocity"
    for name in ("01-talk", "exercise-joint_velocity"):
        alone = nbformat.read(built.root / "build" / "launch" / f"{name}.ipynb", as_version=4)
        brings = next(cell.source for cell in alone.cells if cell.id == "spinbook-exercises")
        (tmp_path / name).mkdir()
        # As in Colab: only the notebook. Then the check in its last cell.
        subprocess.run([sys.executable, "-c", brings], cwd=tmp_path / name, check=True, timeout=60)
    (tmp_path / "node.py").write_text((ROOT / "solutions/joint_velocity/solution.py").read_text())
    check = [sys.executable, "-m", "spinbook", "check", "joint_velocity", "../node.py"]
    done = subprocess.run(check, cwd=tmp_path / "01-talk", capture_output=True, text=True, timeout=280)
    assert done.returncode == 0, done.stdout + done.stderr
    assert "37 of 37 points" in done.stdout


def test_the_branch_of_notebooks_has_a_container_for_each(built: SmallCourse) -> None:
    branch = built.root / "build" / "launch"

    for name in ("01-talk", "02-more", "exercise-joint_velocity"):
        container = json.loads((branch / ".devcontainer" / name / "devcontainer.json").read_text())
        assert (branch / container["customizations"]["codespaces"]["openFiles"][0]).exists()


def test_all_links_and_anchors_lead_somewhere(built: SmallCourse) -> None:
    ids = {page: set(re.findall(r'\bid="([^"]+)"', built.page(page))) for page in built.pages}
    for page in built.pages:
        for target in re.findall(r'\b(?:href|src)="([^"]*)"', built.page(page)):
            if re.match(r"https?:", target):
                continue
            path, anchor = urldefrag(unquote(re.sub(r"\?v=\w+", "", target)))
            file = ((built.site / page).parent / path).resolve() if path else built.site / page
            assert file.is_file(), f"{page}: {target}"
            if anchor:
                assert anchor in ids[file.relative_to(built.site.resolve()).as_posix()], f"{page}: {target}"


def test_a_chapter_begins_with_what_it_is_and_how_long_it_takes(built: SmallCourse) -> None:
    assert "One node that talks. About 1 minute to read 1 node 1 exercise" in text_of(built.page(TALK))
    more = text_of(built.page("chapters/02-more.html"))
    assert "What comes next. Week 2 35 minutes" in more
    assert re.search(r"Page 1 of 2 · about 20 minutes.*Page 2 of 2 · about 15 minutes Last words", more)


def test_numbers_in_a_table_are_aligned(built: SmallCourse) -> None:
    minutes = built.page("chapters/02-more.html").partition("<table")[2].partition("</table>")[0]
    assert re.findall(r'<t[hd] class="number[^>]*>(?:<p>)?(\w+)', minutes) == ["Minutes", "20", "15"]


def test_the_glossary_is_a_list_of_definitions_with_its_letters(built: SmallCourse) -> None:
    page = built.page("glossary.html")
    assert '<a href="#message">M</a>' in page
    assert re.search(r'<dt id="publisher">Publisher</dt><dd><p>Whoever sends', page)


def test_every_picture_says_what_it_shows(built: SmallCourse) -> None:
    for page in built.pages:
        for image in re.findall(r"<img[^>]*>", built.page(page)):
            assert re.search(r'alt="[^"]+"', image), f"{page}: {image}"


def test_no_page_holds_a_script_or_a_style_of_its_own(built: SmallCourse) -> None:
    for page in built.pages:
        html = built.page(page)
        assert not re.search(r"<script(?![^>]*\bsrc=)|<style|\sstyle=|\son\w+=", html), page
        # WebAssembly is for the pages whose cells run; no script but the site's own is for any.
        policy = "default-src 'none'; script-src 'self'( 'wasm-unsafe-eval'; connect-src 'self')?; style-src 'self'"
        assert re.search(policy, html), page


def secret_lines() -> set[str]:
    """Return lines that are in solutions or hidden checks and nowhere that students may look."""
    exercise, solutions = ROOT / "exercises" / "joint_velocity", ROOT / "solutions" / "joint_velocity"
    secret = [exercise / "hidden_checks.py", *solutions.rglob("*.py")]
    lines = {line.strip() for file in secret for line in file.read_text().splitlines()}
    solution = (solutions / "solution.py").read_text()
    begun = re.sub(r"# BEGIN SOLUTION.*?# END SOLUTION", "", solution, flags=re.DOTALL)
    shown = [begun, *((exercise / name).read_text() for name in ("task.md", "checks.py", "exercise.toml"))]
    public = "\n".join([*shown, *(file.read_text() for file in (ROOT / "chapters").glob("*.md"))])
    return {line for line in lines if len(line) > 24 and line not in public}


@pytest.mark.parametrize("folder", ["site", "launch", "site-source"])
def test_no_solution_and_no_hidden_check_is_published(built: SmallCourse, folder: str) -> None:
    secrets = secret_lines()
    assert len(secrets) > 100
    secrets |= {"NOTE_OF_THE_CHAPTER", "NOTE_IN_A_LINE", "NOTE_OF_THE_GLOSSARY", "NOTE_OF_THE_TASK"}
    seen = [file for file in (built.root / "build" / folder).rglob("*") if file.is_file()]
    assert ".ipynb" in {file.suffix for file in seen}
    # Pyodide's own files are large, and have nothing of a course in them while they are the same byte for byte.
    place = pyodide_folder()
    of_pyodide = pyodide_files(place) if place else {}
    for file in seen:
        if of_pyodide.get(file.name) != file.read_bytes():
            assert_holds_none(file, secrets)


def test_hidden_checks_are_not_named(built: SmallCourse) -> None:
    tree = ast.parse((ROOT / "exercises" / "joint_velocity" / "hidden_checks.py").read_text())
    checks = [node for node in tree.body if isinstance(node, ast.FunctionDef) and ast.get_docstring(node)]
    assert checks
    for check in checks:
        title = (ast.get_docstring(check) or "").split("\n\n")[0]
        for page in built.pages:
            assert title not in text_of(built.page(page)), page
            assert check.name not in built.page(page), page


def assert_holds_none(file: Path, secrets: set[str]) -> None:
    text = file.read_text(encoding="utf-8", errors="replace")
    for html, plain in (("&quot;", '"'), ("&#39;", "'"), ("&lt;", "<"), ("&gt;", ">"), ("&amp;", "&")):
        text = text.replace(html, plain)
    for version in {text, re.sub(r"</?span[^>]*>", "", text), text.replace('\\"', '"')}:
        found = [line for line in secrets if line in version]
        assert not found, f"{file}: {found[:3]}"


def test_names_of_functions_stand_apart_in_formulas() -> None:
    thin = '<mspace width="0.167em" />'
    assert f"<mn>0.5</mn>{thin}<mi>sin</mi>{thin}<mi>t</mi>" in spaced(convert(r"0.5 \sin t"))
    assert f"</msup>{thin}<mi>t</mi>" in spaced(convert(r"\sin^2 t"))
    assert f"<mn>3</mn>{thin}<mi>cos</mi><mo" in spaced(convert(r"3\cos(t)"))


def test_other_programs_learn_where_the_pages_are_and_what_they_are_about(built: SmallCourse) -> None:
    site = "https://example.github.io/course/"
    page = built.page(TALK)
    assert f'<link rel="canonical" href="{site}chapters/01-talk.html">' in page
    assert '<meta property="og:title" content="Talk">' in page
    assert '<meta property="og:description" content="One node that talks.">' in page
    assert f'<link rel="canonical" href="{site}">' in built.page("index.html")
    locations = re.findall(r"<loc>(.*?)</loc>", (built.site / "sitemap.xml").read_text())
    assert {f"{site}chapters/01-talk.html", f"{site}chapters/02-more.html", site} <= set(locations)
    feed = ElementTree.parse(built.site / "feed.xml").getroot()
    assert next(item.findtext("title") for item in feed.iter("item")) == "Talk"
    lost = built.page("404.html")
    assert f'href="{site}_static/site.css?v=' in lost
    assert not re.search(r'(?:href|src|action)="(?!https://|#|\./_static/)', lost), "a server shows it at any address"


def test_a_page_can_be_edited_and_a_cell_names_its_source(built: SmallCourse) -> None:
    page = built.page(TALK)
    assert 'href="https://github.com/example/course/edit/main/chapters/01-talk.md">Edit this page</a>' in page
    assert re.search(r'aria-label="More about talker\.py">…</summary>.*>Source, line \d+</a>', page)


def test_a_marked_line_ends_before_a_folded_main() -> None:
    code = '<span></span>a\n<span class="hll">b\n</span>\ndef main():\n'
    page = f'<div class="main-from-2 highlight-python"><div class="highlight"><pre>{code}</pre></div></div>'
    marked = '<span class="hll">b</span>\n<span class="as-before">\ndef main():\n</span></pre><button class="unfold"'
    assert marked in fold_mains(page)


def test_the_lines_of_a_program_that_its_earlier_version_did_not_have_are_known() -> None:
    first = ChapterCell(CellKind.NODE, "a", f"class A(Node):\n    x = 1\n{MAIN.format('A')}", 1, "a")
    newer = replace(first, id="a-2", source=first.source.replace("x = 1", "x = 2"))
    other = replace(first, id="b", source=first.source.replace("A", "B"), name="b")
    own = replace(other, id="c", source=other.source.replace("spin", "spin_once"), name="c")
    tidies = ChapterCell(CellKind.SHELL, "d", "cd ws\ncolcon build\n", 1)
    shows = replace(tidies, id="e", source="colcon build\nros2 run a a")
    assert repetitions([first, newer, other, own, tidies, shows]) == {
        "a": Repetition(),
        "a-2": Repetition(main_from=2, changed=(2,)),
        "b": Repetition(main_from=2),
        "c": Repetition(),
        "d": Repetition(housekeeping=True),
        "e": Repetition(),
    }


MAIN = "\n\ndef main():\n    rclpy.spin({}())\n"


def test_words_of_a_command_are_coloured_by_what_they_mean() -> None:
    line = "ros2 topic pub --rate 2 /arm std_msgs/msg/Float64 '{data: 1}'\n"
    coloured = {value: str(kind).removeprefix("Token.") for kind, value in CommandLexer().get_tokens(line)}
    meanings = {"ros2": "Keyword", "pub": "Keyword", "--rate": "Name.Attribute", "2": "Literal.Number"}
    meanings |= {"/arm": "Name.Variable", "std_msgs/msg/Float64": "Name.Class", "'{data: 1}'": "Literal.String.Single"}
    assert meanings.items() <= coloured.items()


def test_a_drawing_is_the_site_s_own_file_and_no_link_into_the_repository() -> None:
    links = Links({}, Repository(ROOT, "https://github.com/example/course"))
    shown = rich(
        "[it](../course.toml)\n\n```mermaid\nflowchart LR\n```\n", links, "chapters", "chapters", lambda code: DRAWN
    )
    assert DRAWN in shown
    assert "[it](https://github.com/example/course/blob/main/course.toml)" in shown


def test_a_linked_file_is_on_the_site_of_a_course_without_a_repository(tmp_path: Path) -> None:
    (tmp_path / "log one.csv").write_text("a,b\n")
    links = Links({}, Repository(tmp_path, ""))
    shown = rich("[it](<log one.csv>), [code](solutions/a.py)\n", links, "", "chapters", lambda code: DRAWN)

    ((name, data),) = links.pictures.items()
    assert (name.rpartition("/")[2], data) == ("log-one.csv", b"a,b\n")
    assert f"[it](../{name})" in shown


DRAWN = '<figure><img src="../_drawings/a.svg" alt="a"></figure>'
