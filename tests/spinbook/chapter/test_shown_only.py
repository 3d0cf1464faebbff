"""Classes in pieces run as a whole; excerpts, templates and what would end the kernel are shown, with a word why."""

from __future__ import annotations

from pathlib import Path

import pytest
from fences import GUARD, IMPORTS, MAIN, TALKER, cells, read, reading

from groundwork.problem import Severity
from spinbook.chapter.classify import CellKind
from spinbook.chapter.python_code import inspect
from spinbook.chapter.read import ReadResult, read_chapter
from spinbook.chapter.surroundings import Surroundings

HEADER = "class Talker(Node):\n"
INIT = "    def __init__(self):\n        super().__init__('talker')\n        self.create_timer(1.0, self.tick)\n"
TICK = "    def tick(self):\n        self.get_logger().info('tick')\n"


@pytest.mark.parametrize("methods", [(INIT, TICK), (INIT.replace("    ", "", 1).replace("\n    ", "\n"), TICK)])
def test_a_class_that_is_shown_method_by_method_runs_with_the_main_below(
    tmp_path: Path, methods: tuple[str, ...]
) -> None:
    result = reading(tmp_path, IMPORTS, HEADER, *methods, MAIN + GUARD)
    assert result.chapter is not None

    *parts, node = cells(result.chapter)

    assert [cell.kind for cell in parts[-3:]] == [CellKind.PART] * 3
    assert (node.kind, node.source) == (CellKind.NODE, MAIN + GUARD)
    assert not inspect(node.whole).needs
    assert inspect(node.whole).lacking == {}
    assert not any(problem.severity is Severity.NOT_RUN for problem in result.problems)


def test_what_repeats_a_piece_of_a_program_explains_it_and_is_no_error(tmp_path: Path) -> None:
    whole = IMPORTS + HEADER + INIT + TICK + MAIN + GUARD

    result = reading(tmp_path, whole, HEADER, INIT.lstrip(), "    def tick(self):\n", MAIN, GUARD)
    assert result.chapter is not None

    assert [cell.kind for cell in cells(result.chapter)] == [CellKind.NODE]
    assert not any(problem.severity is Severity.NOT_RUN for problem in result.problems)


def test_a_call_of_super_outside_a_class_is_shown_only(tmp_path: Path) -> None:
    chapter = read(tmp_path, "super().__init__('talker')\n")

    assert cells(chapter) == []
    assert "outside a class" in chapter.static_fences[0].sign


def test_a_template_whose_init_does_not_call_nodes_is_shown_with_line_and_remedy(tmp_path: Path) -> None:
    template = IMPORTS + "class Pad(Node):\n    def __init__(self):\n        # TODO\n        self.n = 0\n\n"

    result = reading(tmp_path, template + MAIN.replace("Talker", "Pad") + GUARD)
    assert result.chapter is not None

    assert cells(result.chapter) == []
    (problem,) = [item for item in result.problems if item.severity is Severity.NOT_RUN]
    assert (problem.line, "super().__init__" in problem.problem) == (8, True)


CLIENT = f"import sys\n{IMPORTS}{TALKER}{MAIN.replace('args=args', 'args=[sys.argv[1], sys.argv[2]]')}{GUARD}"


def test_a_program_that_reads_words_is_saved_and_started_with_them(tmp_path: Path) -> None:
    named = CLIENT.join(['```python title="client.py"\n', "```\n"])

    node, shell = cells(read(tmp_path, named, "```bash\nros2 run robot client 2 3\n```\n"))

    assert (node.kind, node.keeps, shell.kind) == (CellKind.NODE, True, CellKind.SHELL)


def test_a_command_without_the_words_that_its_program_reads_is_shown_only(tmp_path: Path) -> None:
    named = CLIENT.join(['```python title="client.py"\n', "```\n"])

    chapter = read(tmp_path, named, "```bash\nros2 run arm client\n```\n")

    assert chapter.static_fences[-1].sign == "`client` reads 2 arguments from its command line."


def test_a_program_that_counts_its_words_first_is_started_without(tmp_path: Path) -> None:
    (node,) = cells(read(tmp_path, CLIENT.replace("class", "print(len(sys.argv))\n\n\nclass", 1)))

    assert not node.keeps


@pytest.mark.parametrize(
    "code",
    [
        "import os\ncommand = 'sudo apt update'\nos.system(command)\n",
        "import subprocess as sp\nsp.run(['git', 'clone', 'x'])\n",
        "from subprocess import run\nrun('rm -r x', shell=True)\n",
        "from os import system\nsystem('pip install x')\n",
        "import os\nos.execvp('rm', ['rm', 'x'])\n",
        "import subprocess\nwords = ['apt']\nwords += ['sudo']\nsubprocess.Popen(args=words)\n",
        "get_ipython().system('git pull')\n",
    ],
)
def test_what_changes_the_machine_is_found_behind_names(tmp_path: Path, code: str) -> None:
    assert cells(read(tmp_path, code)) == []


def test_ros2_service_is_not_the_program_service(tmp_path: Path) -> None:
    (cell,) = cells(read(tmp_path, "import subprocess\nsubprocess.run(['ros2', 'service', 'list'])\n"))

    assert cell.kind is CellKind.SNIPPET


def test_a_piece_that_spins_what_nothing_initialized_is_shown_only(tmp_path: Path) -> None:
    chapter = read(tmp_path, IMPORTS + "node = Node('talker')\n", "try:\n    rclpy.spin(node)\nfinally:\n    pass\n")

    assert all(cell.kind is CellKind.SNIPPET for cell in cells(chapter))
    assert "rclpy.init" in chapter.static_fences[-1].sign


@pytest.mark.parametrize(
    "code",
    [
        "import rclpy\nimport sys\nrclpy.shutdown()\nsys.exit(0)\n",
        "from rclpy.node import Node\nnode = Node('talker')\n",
        "import argparse\nparser = argparse.ArgumentParser()\nargs = parser.parse_args()\n",
        "print('done')\nexit()\n",
    ],
)
def test_what_would_fail_or_end_the_kernel_is_no_cell_of_it(tmp_path: Path, code: str) -> None:
    chapter = read(tmp_path, code)

    assert cells(chapter) == []
    assert chapter.static_fences[0].sign


def test_a_parser_that_is_given_its_words_is_a_snippet(tmp_path: Path) -> None:
    code = "import argparse\nparser = argparse.ArgumentParser()\nprint(parser.parse_args([]))\n"

    assert [cell.kind for cell in cells(read(tmp_path, code))] == [CellKind.SNIPPET]


def test_a_fence_that_includes_a_file_which_is_not_here_is_shown_only(tmp_path: Path) -> None:
    result = reading(tmp_path, '--8<-- "code/talker.py"\n')
    assert result.chapter is not None

    assert cells(result.chapter) == []
    assert "`code/talker.py`" in result.chapter.static_fences[0].sign
    assert [(item.line, item.severity) for item in result.problems] == [(3, Severity.NOT_RUN)]


INCLUDES = ['--8<-- "{}"', "```{{include}} {}\n```", "{{{{< include {} >}}}}", "{{% include_relative {} %}}"]
SHOWN = ["import Part from './{0}';\n\n<Part name='x' />", "import Part from '@site/{0}';\n\n<Part/>"]


def page(root: Path, text: str) -> ReadResult:
    (root / "c.md").write_text(f"# One\n\n{text}\n")
    return read_chapter(root, Path("c.md"), Surroundings("robot"))


@pytest.mark.parametrize("written", [*INCLUDES, *SHOWN])
def test_a_text_that_is_included_is_part_of_the_chapter_or_said_to_be_missing(tmp_path: Path, written: str) -> None:
    missing = page(tmp_path, written.format("words.md"))
    assert missing.chapter is not None
    assert [(one.severity, "words.md` can't be included" in one.problem) for one in missing.problems] == [
        (Severity.NOT_RUN, True)
    ]
    assert "words.md`, which is not here" in missing.chapter.static_fences[0].sign

    (tmp_path / "words.md").write_text("Some words.\n\n```python\nprint(1)\n```\n")
    shown = page(tmp_path, written.format("words.md"))
    assert shown.chapter is not None
    assert not shown.problems
    assert [cell.kind for cell in cells(shown.chapter)] == [CellKind.SNIPPET]


@pytest.mark.parametrize("written", ["{{% include {} %}}", SHOWN[0]])
def test_texts_that_include_each_other_are_read_once(tmp_path: Path, written: str) -> None:
    for name, other in (("a.md", "b.md"), ("b.md", "a.md")):
        includes = f"{written.format(other)}\n\n"
        (tmp_path / name).write_text(f"Words of {name}\n\n{includes * 3}")
    result = page(tmp_path, written.format("a.md"))
    assert result.chapter is not None
    assert sum(cell.source.count("Words of a.md") for cell in result.chapter.cells) == 1
    assert {item.problem.partition(" can't")[0].replace("./", "") for item in result.problems} == {"`a.md`"}


def test_blocks_of_other_tools_are_not_taken_for_misspelt_ones(tmp_path: Path) -> None:
    pandoc = "notes aside column-margin panel-tabset proof card grid subfigure figure-md code-group details"
    carpentries = "tab questions objectives keypoints challenge instructor prereq spoiler testimonial"
    assert not page(
        tmp_path, "".join(f":::{kind}\nA.\n:::\n\n" for kind in (pandoc + " " + carpentries).split())
    ).problems


def test_the_source_that_a_component_shows_is_the_program(tmp_path: Path) -> None:
    (tmp_path / "talker.py").write_text(IMPORTS + TALKER + MAIN + GUARD)
    shows = "<CodeBlock language='py'>{Source}</CodeBlock>"
    result = page(tmp_path, f"import Source from '!!raw-loader!./talker.py';\n\n{shows}")
    assert result.chapter is not None
    assert [(cell.kind, cell.name) for cell in cells(result.chapter)] == [(CellKind.NODE, "talker")]


@pytest.mark.parametrize(
    "words",
    [
        "topic pub {topic} {type} {data}",
        "run [package] [executable]",
        "topic echo <x>",
        "node info /<x>",
        "topic echo ...",
        "param get NODE_NAME PARAM",
        "topic pub /TOPIC TYPE DATA",
    ],
)
def test_a_command_with_placeholders_is_shown_only(tmp_path: Path, words: str) -> None:
    assert cells(read(tmp_path, f"```bash\nros2 {words}\n```\n")) == []


def test_what_init_calls_may_not_use_what_nothing_sets(tmp_path: Path) -> None:
    code = "class Asker(Node):\n    def __init__(self):\n        super().__init__('asker')\n        self.ask()\n\n"
    code += "    def ask(self):\n        self.client.call_async(None)\n\n\n"

    result = reading(tmp_path, IMPORTS + code + MAIN.replace("Talker", "Asker") + GUARD)
    assert result.chapter is not None

    assert cells(result.chapter) == []
    assert [(item.line, item.severity) for item in result.problems if not item.group] == [(13, Severity.NOT_RUN)]


def test_snippets_that_use_what_nothing_defines_are_one_warning(tmp_path: Path) -> None:
    snippets = ["```python\nprint(first)\nprint(second)\n```\n", "```python\n\nprint(third)\n```\n"]
    method = "```python\nself.pub.publish(message)\n```\n"

    (problem,) = reading(tmp_path, *snippets, method).problems

    assert problem.severity is Severity.WARNING
    assert "no snippet that runs above defines `first` (line 4), `third` (line 10)." in problem.problem
    assert "Define it in a snippet above" in problem.fix


def test_an_executor_needs_init_too(tmp_path: Path) -> None:
    code = "from rclpy.executors import SingleThreadedExecutor\nfrom rclpy.node import Node\n\n\n"
    code += "class A(Node):\n    pass\n\n\nrunner = SingleThreadedExecutor()\nrunner.add_node(A('a'))\nrunner.spin()\n"

    (problem,) = reading(tmp_path, f'```python title="a.py"\n{code}```\n').problems

    assert (problem.line, problem.problem) == (12, "nothing calls `rclpy.init` before this, so the program would fail.")


@pytest.mark.parametrize(
    ("options", "code"),
    [
        (":lines: 1,3-", "a = 1\nc = 3\n"),
        (":start-after: a =\n:end-before: c", "b = 2\n"),
        (":start-at: b\n:end-at: b", "b = 2\n"),
        ("", "a = 1\nb = 2\nc = 3\n"),
    ],
)
def test_a_literalinclude_shows_the_lines_that_it_asks_for(tmp_path: Path, options: str, code: str) -> None:
    (tmp_path / "values.py").write_text("a = 1\nb = 2\nc = 3\n")

    (cell,) = cells(read(tmp_path, f"```{{literalinclude}} values.py\n{options}\n```\n"))
    missing = reading(tmp_path, "```{literalinclude} none.py\n```\n").problems

    assert cell.source.endswith(code)
    assert [item.problem for item in missing] == [
        "`none.py` can't be included: the course has no such file, or it includes itself."
    ]


def test_prompts_and_tables_of_sphinx_are_read(tmp_path: Path) -> None:
    table = "```{list-table} Two\n* - a\n  - b\n* - long\n    text\n  - d\n```\n"

    chapter = read(tmp_path, "```{prompt} bash $\nros2 node list\n```\n" + table)

    (prompt,) = cells(chapter)
    assert [command.text for command in prompt.commands] == ["ros2 node list"]
    assert "**Two**\n\n| a | b |\n| --- | --- |\n| long text | d |" in chapter.cells[-1].source
