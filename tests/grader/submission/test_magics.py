"""Which lines of a cell are the notebook's commands: exactly those that IPython takes for its own."""

from __future__ import annotations

import pytest
from IPython.core.inputtransformer2 import TransformerManager

from grader.submission.magics import cell_magic, without_commands

CODES = {
    "commands": "%pip install x\nimport os\n!ls -l\n!!ls\n%matplotlib inline\n",
    "text": "x = '''\n%done\n!important\n'''\ny = \"\"\"\n?\n\"\"\"\n",
    "brackets": "x = [\n%a\n]\ny = f(1,\n%b\n, {\n!c\n})\n",
    "continued": "x = 5 \\\n% 3\ny = '%d' \\\n% 4\n",
    "blocks": "if x:\n    !ls\n    %cd ..\nfor i in y:\n\t%time f()\n",
    "assigned": "a = !ls\nb = %pwd\nc = a != b\nd = 7 % 3\ne.f = !ls\n",
    "help": "foo?\n?foo\nos.path??\nx = 'what?'\ny = 1  # why?\n",
    "apostrophes": "!echo it's\nx = 'it''s'\n# it's\n%echo don't\ny = 2\n",
    "long commands": "!echo one \\\n  two \\\n  three\nx = 1\n%pip install \\\n  y\n",
    "docstring": 'class A:\n    """Say.\n\n%done\n    """\n    %ls\n    x = 1\n',
    "modulo at the begin of a line in a call": "print('%s'\n% x)\n",
    "formatted": 'x = f"{y!r}"\nz = "%s" % y\n!ls\n',
    "comments with brackets": "# (\n%ls\n# '''\n!ls\nx = 1\n",
}


@pytest.mark.parametrize("code", CODES.values(), ids=CODES)
def test_the_same_lines_are_commands_as_for_ipython(code: str) -> None:
    lines = code.split("\n")
    ipython = TransformerManager().transform_cell(code)
    left = without_commands(code).split("\n")

    assert len(left) == len(lines)
    kept = [line for line in left if line.strip() not in ("", "pass") and not line.endswith("= None")]
    assert [line.rstrip() for line in kept] == [
        line.rstrip() for line in ipython.split("\n") if line.strip() and "get_ipython()" not in line
    ] or "%time" in code


def test_a_block_of_commands_stays_a_block_and_an_assigned_name_a_name() -> None:
    assert without_commands("if x:\n    !ls\n") == "if x:\n    pass\n"
    assert without_commands("files = !ls\n") == "files = None\n"


def test_calls_without_brackets_are_commands_too() -> None:
    assert without_commands("x = 1\n/print 1\n,print a b\n;print a b\n") == "x = 1\n\n\n\n"


def test_a_timed_statement_is_a_statement() -> None:
    assert without_commands("%time node = Heartbeat()\n") == "node = Heartbeat()\n"


def test_commands_without_their_sign_count_where_the_cell_is_no_python() -> None:
    assert without_commands("pip install x\nimport os\n", automagic=True) == "\nimport os\n"


@pytest.mark.parametrize(
    ("source", "name", "code"),
    [
        ("%%node heartbeat --keep\nx = 1", "node", "\nx = 1"),
        ("\n\n%%bash\nls", "bash", "\n\n\nls"),
        ("# mine\n%%node heartbeat\nx = 1", "node", "\n\nx = 1"),
        ("x = 1\n%%node heartbeat", "", "x = 1\n%%node heartbeat"),
        (">>> x = 1\n>>> if x:\n...     y = 2", "", "x = 1\nif x:\n    y = 2"),
        ("    x = 1\n    y = 2", "", "x = 1\ny = 2"),
        ("    x = 1\n  # less\n    y = 2", "", "x = 1\n  # less\ny = 2"),
        (" %%node heartbeat\n x = 1", "node", "\nx = 1"),
    ],
)
def test_a_cell_is_split_from_its_magic_and_its_prompts(source: str, name: str, code: str) -> None:
    found = cell_magic(source)
    assert (found.name, found.code) == (name, code)


@pytest.mark.parametrize(
    "code",
    [
        "'" * 300_000,
        '"""' + r"\a" * 200_000,
        "(" * 200_000,
        "\\" * 300_001,
        "%\\\n" * 100_000,
        (" " * 400 + "\n") * 500,
    ],
    ids=["quotes", "text", "brackets", "backslashes", "a long command", "blanks"],
)
@pytest.mark.timeout(30)
def test_code_written_to_keep_the_reader_busy_is_read(code: str) -> None:
    assert without_commands(code).count("\n") == code.count("\n")
