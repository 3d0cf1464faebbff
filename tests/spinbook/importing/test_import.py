"""`spinbook import` makes a course from an existing book, in the book's order, and reports what runs."""

from __future__ import annotations

import subprocess
import sys
from pathlib import Path

import pytest
from prepared_python import run_prepared

from spinbook.course.course import read_course

CHAPTER = "# {}\n\n```python\nimport no_such_package\n```\n\n```python\nprint(1)\n```\n"


def book(root: Path, *chapters: str) -> Path:
    """Return a book's folder with these chapters."""
    for name in chapters:
        file = root / name
        file.parent.mkdir(parents=True, exist_ok=True)
        file.write_text(CHAPTER.format(file.stem))
    return root


def spinbook_import(place: Path, *words: str) -> subprocess.CompletedProcess[str]:
    return run_prepared("spinbook", "import", str(place), *words, cwd=place.parent)


def order(root: Path) -> list[str]:
    return [chapter.as_posix() for chapter in read_course(root).chapters]


MKDOCS = """\
site_name: "Robots: a course"
markdown_extensions:
  - pymdownx.emoji:
      emoji_index: !!python/name:material.extensions.emoji.twemoji
nav:
  - Home: index.md
  - Part one:
      - part/second.md
      - Elsewhere: https://example.org
  - First: part/first.md
  - Gone: gone.md
"""
TOC = """\
format: jb-book
root: index
parts:
- caption: A
  chapters:
  - file: part/second
    sections:
    - file: part/first
"""
MYST = """\
project:
  title: Robots
  toc:
    - file: index.md
    - title: A
      children:
        - file: part/second.md
        - file: part/first.md
"""
SIDEBARS = """\
// @ts-check
/** @type {import('x').SidebarsConfig} */
const sidebars = {
  tutorial: [
    'index', // the first
    {type: 'category', label: "A, b: {c}", link: {type: 'generated-index'},
     items: ['part/second', {type: 'doc', id: 'part/first'}], ...rest([{a: 1}, more[0]]), key: 'x'},
  ],
  generated(pages) { return {docs: pages}; },
};
module.exports = sidebars;
"""
SUMMARY = "# Summary\n\n- [Home](index.md)\n  - [Second](part/second.md)\n- [First](part/first.md#top)\n"


@pytest.mark.parametrize(
    ("contents", "text", "docs"),
    [
        ("mkdocs.yml", MKDOCS, "docs"),
        ("_toc.yml", TOC, ""),
        ("myst.yml", MYST, ""),
        ("sidebars.js", SIDEBARS, "docs"),
        ("sidebars.ts", SIDEBARS.replace("const sidebars =", "const sidebars: SidebarsConfig ="), "docs"),
        ("SUMMARY.md", SUMMARY, ""),
        ("_sidebar.md", SUMMARY, ""),
    ],
)
@pytest.mark.parametrize("by_file", [True, False])
def test_the_chapters_come_in_the_books_order(
    tmp_path: Path, contents: str, text: str, docs: str, by_file: bool
) -> None:
    names = [str(Path(docs, name).as_posix()) for name in ("index.md", "part/second.md", "part/first.md")]
    root = book(tmp_path / "robots", *names)
    (root / contents).write_text(text)

    said = spinbook_import(root / contents if by_file else root)

    assert said.returncode == 0, said.stderr
    assert order(root) == names
    assert f"in the order of {contents}" in said.stdout


def test_a_folder_without_a_table_of_contents_goes_by_positions_and_numbers(tmp_path: Path) -> None:
    root = book(
        tmp_path / "robots", "10-last.md", "2-middle.md", "deep/a.md", "node_modules/x/README.md", "CONTRIBUTING.md"
    )
    (root / "zero.md").write_text("---\nsidebar_position: 1\n---\n# Zero\n")

    spinbook_import(root)

    assert order(root) == ["zero.md", "2-middle.md", "10-last.md", "deep/a.md"]


STARLIGHT = """\
import { defineConfig } from 'astro/config';
import starlight from '@astrojs/starlight';
export default defineConfig({
  site: 'https://example.org', // {
  integrations: [
    starlight({
      title: 'Robots by night',
      sidebar: [
        'index',
        { label: 'Parts', items: [{ label: 'Two', slug: 'part/second' }, { link: '/part/first/' },
          { label: 'Elsewhere', link: 'https://example.org' }] },
        { label: 'More', autogenerate: { directory: 'more' } },
      ],
    }),
  ],
});
"""


def test_starlights_sidebar_gives_the_order_and_its_front_matter_the_titles(tmp_path: Path) -> None:
    docs = "src/content/docs"
    root = book(tmp_path / "b", *(f"{docs}/{name}.md" for name in ("index", "part/first", "part/second", "more/a")))
    (root / docs / "more/b.mdx").write_text("---\ntitle: Before a\nsidebar:\n  order: 1\n---\nText.\n")
    (root / "astro.config.mjs").write_text(STARLIGHT)

    said = spinbook_import(root)

    assert said.stdout.startswith("Robots by night: 5 chapters, in the order of astro.config.mjs")
    names = ("index.md", "part/second.md", "part/first.md", "more/b.mdx", "more/a.md")
    assert order(root) == [f"{docs}/{name}" for name in names]
    assert "# Before a" in (root / "build/notebooks/b.ipynb").read_text()


@pytest.mark.parametrize("key", ["sort", "nav_order"])
def test_jekylls_front_matter_gives_the_order(tmp_path: Path, key: str) -> None:
    root = book(tmp_path / "b", "_includes/part.md")
    for name, place in (("c", 1), ("a", 2), ("b", 3)):
        (root / f"{name}.md").write_text(f"---\ntitle: {name}\n{key}: {place}\n---\nText.\n")

    assert spinbook_import(root).returncode == 0
    assert order(root) == ["c.md", "a.md", "b.md"]


def test_jekylls_pages_follow_their_parents(tmp_path: Path) -> None:
    root = tmp_path / "b"
    root.mkdir()
    pages = (("z", 1, ""), ("arm", 2, ""), ("grip", 2, "arm"), ("base", 1, "arm"), ("knob", 1, "grip"))
    for name, place, parent in pages:
        above = f"parent: {parent}\n" if parent else ""
        (root / f"{name}.md").write_text(f"---\ntitle: {name}\nnav_order: {place}\n{above}---\nText.\n")

    assert spinbook_import(root).returncode == 0
    assert order(root) == ["z.md", "arm.md", "base.md", "grip.md", "knob.md"]


def test_docusaurus_finds_pages_by_their_ids_without_numbers(tmp_path: Path) -> None:
    root = book(tmp_path / "robots", "docs/02-topics/01-start.md", "docs/intro.md")
    (root / "docs/intro.md").write_text("---\nid: hello\n---\n# Hello\n")
    (root / "sidebars.js").write_text("export default { s: ['hello', 'topics/start'] };")

    spinbook_import(root)

    assert order(root) == ["docs/intro.md", "docs/02-topics/01-start.md"]


def test_mkdocs_pages_files_give_the_order_and_leave_out_what_they_do_not_list(tmp_path: Path) -> None:
    root = book(tmp_path / "b", "docs/a.md", "docs/part/one.md", "docs/part/two.md", "docs/part/hidden.md")
    (root / "mkdocs.yaml").write_text("site_name: B\nplugins:\n  - awesome-pages\n")
    (root / "docs/.pages").write_text("nav:\n  - The part: part\n  - ...\n")
    (root / "docs/part/.pages").write_text("nav:\n  - two.md\n  - First: one.md\n")

    assert spinbook_import(root).returncode == 0
    assert order(root) == ["docs/part/two.md", "docs/part/one.md", "docs/a.md"]


def test_a_folder_that_is_not_listed_follows_the_page_of_its_name(tmp_path: Path) -> None:
    root = book(tmp_path / "b", "docs/part1.md", "docs/part1/code.md", "docs/part2.md", "docs/old/x.md")
    (root / "mkdocs.yml").write_text("site_name: B\n")
    (root / "docs/.pages").write_text("nav:\n  - part1.md\n  - part2.md\n")

    assert spinbook_import(root).returncode == 0
    assert order(root) == ["docs/part1.md", "docs/part1/code.md", "docs/part2.md"]


def test_a_pattern_stands_for_its_pages_and_those_that_are_not_listed_are_named(tmp_path: Path) -> None:
    root = book(tmp_path / "b", "index.md", "part/10.md", "part/2.md", "_words.md", "other.md")
    patterns = "".join(f"    - pattern: {pattern}\n" for pattern in ("part/*.md", "../*.md", "/a**b"))
    (root / "myst.yml").write_text(f"project:\n  toc:\n    - file: index.md\n{patterns}")
    (tmp_path / "beyond.md").write_text("# Not of the book\n")

    said = spinbook_import(root).stdout
    assert "Left out because they are missing or of another kind: ../*.md, /a**b\n" in said
    assert order(root) == ["index.md", "part/2.md", "part/10.md"]
    assert "\nNot listed there, so no chapters: other.md\n" in said


def test_links_of_a_sidebar_are_percent_decoded(tmp_path: Path) -> None:
    root = book(tmp_path / "b", "docs/two words.md", "docs/日本.md")
    (root / "docs/日本.md").write_bytes(b"# \xfcber\n")
    (root / "docs/_sidebar.md").write_text("- [Two](two%20words.md)\n- [J](%E6%97%A5%E6%9C%AC.md)\n")

    said = spinbook_import(root)
    assert said.returncode == 0
    assert order(root) == ["docs/two words.md", "docs/日本.md"]
    assert "docs/日本.md:1: error: byte 0xfc is not UTF-8." in said.stdout


def test_the_first_build_and_a_page_say_what_runs_and_what_to_do_first(tmp_path: Path) -> None:
    root = book(tmp_path / "robots", "docs/index.md", "docs/part/second.md", "docs/part/first.md")
    (root / "mkdocs.yml").write_text(MKDOCS)
    before = {path: path.read_bytes() for path in root.rglob("*.md")}

    argv = [sys.executable, "-m", "spinbook", "import", str(root)]
    said = subprocess.run(argv, capture_output=True, text=True, timeout=120, cwd=root.parent)

    assert said.stdout.startswith("Robots: a course: 3 chapters")
    assert "gone.md" in said.stdout
    assert "3 of 3 chapters built: 3 cells, 0 of them nodes" in said.stdout
    assert "3 fences need no_such_package in 3 chapters." in said.stdout
    page = (root / "build/import.html").read_text()
    assert "3 fences need no_such_package" in page
    assert "docs/part/first.md:4" in page
    assert {path: path.read_bytes() for path in root.rglob("*.md")} == before
    assert (root / "build/notebooks/second.ipynb").exists()


def test_the_page_shows_the_opening_line_of_a_fence_as_it_is_written(tmp_path: Path) -> None:
    root = tmp_path / "b"
    root.mkdir()
    (root / "one.md").write_text("# One\n\n```python\nimport rclpy\nrclpy.init()\nrclpy.spin(1)\n```\n")

    assert spinbook_import(root).returncode == 0
    assert "Name the file: <code>```python title=&#34;node.py&#34;</code>" in (root / "build/import.html").read_text()


def test_the_page_lists_what_is_broken_in_the_chapters_own_code(tmp_path: Path) -> None:
    root = tmp_path / "b"
    root.mkdir()
    (root / "one.md").write_text("# One\n\n```python\nprint(\n```\n")

    said = spinbook_import(root)

    assert said.returncode == 0, said.stderr
    assert "one.md:4</code></td><td>not Python: " in (root / "build/import.html").read_text()


def test_a_course_is_not_overwritten(tmp_path: Path) -> None:
    root = book(tmp_path / "robots", "a.md")
    (root / "course.toml").write_text("mine")

    said = spinbook_import(root)

    assert said.returncode == 1
    assert "is already a course" in said.stderr
    assert (root / "course.toml").read_text() == "mine"


@pytest.mark.parametrize("text", ["nav: [", "const x = {", "", "nav: [gone.md]"])
def test_a_broken_or_empty_table_of_contents_is_reported(tmp_path: Path, text: str) -> None:
    root = tmp_path / "robots"
    root.mkdir()
    (root / "mkdocs.yml").write_text(text)

    said = spinbook_import(root)

    assert said.returncode == 1
    assert "Traceback" not in said.stderr
    assert "error:" in said.stderr
    assert ("none of the pages that it lists is there: gone.md." in said.stderr) == ("gone" in text)
