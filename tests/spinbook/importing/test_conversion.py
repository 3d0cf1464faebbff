"""Books of notebooks and of reStructuredText become courses, with Markdown chapters next to the originals."""

from __future__ import annotations

import base64
import importlib.util
import shutil
import subprocess
import sys
from pathlib import Path
from typing import Any

import nbformat
import pytest
from nbformat.v4 import new_code_cell, new_markdown_cell, new_notebook
from prepared_python import run_prepared

from spinbook.course.course import read_course
from spinbook.importing.conversion import as_markdown
from spinbook.importing.rst import markdown_of
from spinbook.problem import SpinbookError

PICTURE = base64.b64encode(b"a picture").decode()


def spinbook_import(place: Path) -> subprocess.CompletedProcess[str]:
    return run_prepared("spinbook", "import", str(place), cwd=place.parent)


def notebook(file: Path, *cells: Any) -> Path:
    file.parent.mkdir(parents=True, exist_ok=True)
    nbformat.write(new_notebook(cells=list(cells)), file)
    return file


def order(root: Path) -> list[str]:
    return [chapter.as_posix() for chapter in read_course(root).chapters]


def test_a_folder_of_notebooks_becomes_a_course(tmp_path: Path) -> None:
    root = tmp_path / "b"
    for name in ("10-end", "2-middle"):
        notebook(root / f"{name}.ipynb", new_markdown_cell(f"# {name}"), new_code_cell("print(1)"))
    before = {path: path.read_bytes() for path in root.rglob("*.ipynb")}

    said = spinbook_import(root)

    assert (said.returncode, order(root)) == (0, ["2-middle.md", "10-end.md"])
    assert "Converted to Markdown, next to the originals: 2-middle.ipynb, 10-end.ipynb" in said.stdout
    assert {path: path.read_bytes() for path in root.rglob("*.ipynb") if "build" not in path.parts} == before


def test_a_notebook_keeps_text_code_tags_and_pictures(tmp_path: Path) -> None:
    source = notebook(
        tmp_path / "n.ipynb",
        new_markdown_cell("![arm](attachment:arm.png)", attachments={"arm.png": {"image/png": PICTURE}}),
        new_code_cell("x = 1", metadata={"tags": ["hide-input"], "collapsed": True}),
        new_code_cell("# look\n!ros2 topic list"),
        new_code_cell("%%bash\nros2 node list"),
    )

    text = as_markdown(source).read_text()

    assert text == (
        '![arm](n_files/0-arm.png)\n\n```python tags=["hide-input"]\nx = 1\n```\n\n'
        "```bash\n# look\nros2 topic list\n```\n\n```bash\nros2 node list\n```\n"
    )
    assert (tmp_path / "n_files/0-arm.png").read_bytes() == b"a picture"


def test_a_notebook_beside_its_markdown_is_the_same_chapter(tmp_path: Path) -> None:
    root = tmp_path / "b"
    notebook(root / "a.ipynb", new_code_cell("print(1)"))
    (root / "a.md").write_text("# Mine\n")
    (root / "_toc.yml").write_text("format: jb-book\nroot: a.ipynb\n")

    assert spinbook_import(root).returncode == 0
    assert (order(root), (root / "a.md").read_text()) == (["a.md"], "# Mine\n")


INDEX = "Robots\n======\n\n.. toctree::\n   :maxdepth: 1\n\n   The start <one>\n   part/index\n   gone\n\nMore text.\n"
PART = "Part\n====\n\n.. toctree::\n   :glob:\n\n   p*\n"


def test_a_sphinx_book_is_read_by_its_toctrees_and_its_settings_are_not_run(tmp_path: Path) -> None:
    root = tmp_path / "b"
    (root / "docs/part").mkdir(parents=True)
    (root / "docs/conf.py").write_text("project = 'Robots in rows'\nraise SystemExit\n")
    (root / "docs/index.rst").write_text(INDEX)
    (root / "docs/one.md").write_text("# One\n\n```{toctree}\n:hidden:\nlast\n```\n")
    (root / "docs/last.rst").write_text("Last\n====\n\nText.\n")
    (root / "docs/part/index.rst").write_text(PART)
    (root / "docs/part/page.rst").write_text("Page\n====\n\n.. code-block:: bash\n\n   ros2 topic list\n")

    said = spinbook_import(root)

    assert said.stdout.startswith("Robots in rows: 5 chapters, in the order of docs/conf.py"), said.stderr
    assert "of another kind: gone" in said.stdout
    names = ("index", "one", "last", "part/index", "part/page")
    assert order(root) == [f"docs/{name}.md" for name in names]
    assert "%ros2 topic list" in (root / "build/notebooks/page.ipynb").read_text()


@pytest.mark.parametrize(
    ("rst", "markdown"),
    [
        ("Title\n=====\n\nPart\n----\n\nSub\n~~~\n", "# Title\n\n## Part\n\n### Sub\n"),
        (
            "*a* **b** ``c`` snake_case `d <https://x.org>`_ 2*3\n",
            "*a* **b** `c` snake_case [d](https://x.org) 2\\*3\n",
        ),
        (":ref:`words <label>` :doc:`page`\n", "{ref}`words <label>` {doc}`page`\n"),
        (":guilabel:`Go` :py:func:`~rclpy.spin` :math:`x`\n", "**Go** `rclpy.spin` $x$\n"),
        (".. _label:\n\nTitle\n=====\n", "(label)=\n# Title\n"),
        (".. _title:\n\nTitle\n=====\n", "(title)=\n# Title\n"),
        (
            ".. code-block:: python\n   :caption: a.py\n   :linenos:\n\n   x = 1\n",
            '```python title="a.py"\nx = 1\n```\n',
        ),
        ("So::\n\n  $ ros2 node list\n", "So:\n\n```\n$ ros2 node list\n```\n"),
        (".. warning:: Hot.\n", ":::{warning}\nHot.\n:::\n"),
        (".. admonition:: Look\n\n   Hot.\n", ":::{admonition} Look\nHot.\n:::\n"),
        (".. tabs::\n\n   .. group-tab:: A\n\n      a\n", "::::{tab-set}\n:::{tab-item} A\na\n:::\n::::\n"),
        ("#. a\n\n   .. code:: bash\n\n      ls\n\n#. b\n", "1. a\n\n   ```bash\n   ls\n   ```\n\n2. b\n"),
        (".. image:: a.png\n   :width: 50%\n   :alt: An arm\n", '![An arm](a.png){width="50%"}\n'),
        ("== ==\na  b\n== ==\n1  2\n== ==\n", "| a | b |\n| --- | --- |\n| 1 | 2 |\n"),
        (".. literalinclude:: a.py\n   :language: python\n", "```{literalinclude} a.py\n:language: python\n```\n"),
        ('.. code:: python\n\n   a = """\n\n\n   """\n', '```python\na = """\n\n\n"""\n```\n'),
        (".. prompt:: bash $\n\n   ros2 node list\n", "```bash\nros2 node list\n```\n"),
        (".. ipython::\n\n   In [1]: 1 + 1\n   Out[1]: 2\n", "```python\nIn [1]: 1 + 1\nOut[1]: 2\n```\n"),
        (".. csv-table:: Two\n\n   1, 2\n", "**Two**\n\n| 1 | 2 |\n"),
        (".. math::\n\n   a = b\n", "$$\na = b\n$$\n"),
        (".. comment\n\n.. contents::\n\nText with |word|.\n\n.. |word| replace:: *more*\n", "Text with *more*.\n"),
        (".. no-such:: thing\n   :of: x\n\n   Inside.\n", "Inside.\n"),
        ("Broken `text and ``more.\n", "Broken"),
    ],
)
def test_restructuredtext_becomes_markdown(tmp_path: Path, rst: str, markdown: str) -> None:
    assert markdown_of(rst, tmp_path / "a.rst").startswith(markdown)


@pytest.mark.parametrize(("name", "package"), [("a.ipynb", "jupytext"), ("a.rst", "docutils")])
def test_a_missing_package_is_named_with_its_remedy(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: str, package: str
) -> None:
    (tmp_path / name).write_text("{}")
    monkeypatch.setattr(importlib.util, "find_spec", lambda _: None)

    with pytest.raises(SpinbookError, match=rf"with {package}, which is not installed\.\s+Install it: pip install"):
        as_markdown(tmp_path / name)


def test_a_broken_notebook_is_named(tmp_path: Path) -> None:
    (tmp_path / "a.ipynb").write_text("{")

    said = spinbook_import(tmp_path)

    assert said.returncode == 1
    assert "a.ipynb" in said.stderr
    assert "Traceback" not in said.stderr


@pytest.mark.parametrize(
    ("file", "words"), [("a.tex", "pandoc chapter.tex -o chapter.md"), ("a.c", "Name their folder")]
)
def test_a_folder_without_chapters_is_told_what_to_do(tmp_path: Path, file: str, words: str) -> None:
    (tmp_path / file).write_text("x")

    said = spinbook_import(tmp_path)

    assert words in said.stderr
    assert "course.toml" not in said.stderr


def test_the_site_of_an_imported_book_runs_nothing_that_nobody_asked_to_run(tmp_path: Path) -> None:
    root = tmp_path / "b"
    root.mkdir()
    (root / "a.md").write_text("# A\n\n```python\nopen('ran', 'w')\n```\n")
    (root / "b.md").write_text("# B\n\n```python\nprint(1)\n```\n")
    spinbook_import(root)

    said = subprocess.run(
        [sys.executable, "-m", "spinbook", "site"], cwd=root, capture_output=True, text=True, timeout=300
    )

    assert said.returncode == 0, said.stdout + said.stderr
    assert "2 chapters are shown without outputs" in said.stdout
    assert (root / "build/site/chapters/a.html").exists()
    assert not list(root.rglob("ran"))


def test_a_chapter_is_run_if_course_toml_says_so_or_if_it_has_been_run(tmp_path: Path) -> None:
    text = 'title = "T"\nchapters = ["a.md", "b.md", "c.md"]\nrun = ["a.md"]\n[package]\nname = "r"\n'
    (tmp_path / "course.toml").write_text(text)
    (tmp_path / "build/executed").mkdir(parents=True)
    shutil.copy(tmp_path / "course.toml", tmp_path / "build/executed/b.ipynb")

    course = read_course(tmp_path)

    assert [course.is_run(chapter) for chapter in course.chapters] == [True, True, False]
    (tmp_path / "course.toml").write_text(text.replace('run = ["a.md"]', 'run = ["d.md"]'))
    with pytest.raises(SpinbookError, match=r"`run` names `d\.md`"):
        read_course(tmp_path)
