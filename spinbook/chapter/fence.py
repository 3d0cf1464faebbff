"""A code fence of a chapter: language, attributes, title, code, and its line."""

from __future__ import annotations

import itertools
import re
from collections.abc import Mapping
from dataclasses import dataclass, field, replace

from interface_compiler.definition import KINDS
from spinbook.chapter.attributes import options

# The info string is the text after the opening backticks: a language, then attributes such as
# `title="joint_publisher.py"` (the form Docusaurus and others use) or bare words. MyST's `{code-cell} python` with its
# `:option:` lines is read as the same thing.


#: Attribute -> its meaning, for error messages and `docs/writing-chapters.md`.
ATTRIBUTES = {
    "title": "the name of the file, such as my_node.py",
    "seconds": "how long the log is shown, or how long each command may run",
    "until": "the cell is done once the log contains this text",
    "raises": "the cell is expected to fail",
    "expect-error": "the node is expected to log errors, or to fail at some time",
    "static": "shown, never run",
}

_ATTRIBUTE = re.compile(r"""([A-Za-z_][\w-]*)=(?:"([^"]*)"|'([^']*)'|(\S+))|(\S+)""")
_DIRECTIVE = re.compile(r"\{([A-Za-z][\w:-]*)\}(.*)$")

#: Endings of files whose names are titles, whatever the attribute is called.
_FILES = (".py", ".msg", ".srv", ".action")

PYTHON = frozenset({"python", "py", "py3", "python3", "ipython", "ipython3"})
SHELL = frozenset({"bash", "sh", "shell", "zsh", "fish", "ksh", "console", "shell-session", "shellsession", "terminal"})
SHELL |= {"bash-session", "sh-session", "shellscript", "shell-script", "commandline", "command-line", "cli"}


@dataclass(frozen=True)
class Fence:
    """One fenced block. `line` is the line of the opening fence, counted from 1; the code starts below it.

    `code` ends with a newline unless it is empty. There are `skipped` lines of options between the opening and the
    code.
    """

    language: str
    code: str
    line: int
    attributes: Mapping[str, str] = field(default_factory=dict)
    skipped: int = 0
    interface: str = ""
    """The title of the message, service or action that it defines, if so."""

    @property
    def is_python(self) -> bool:
        """Whether the fence says that it is Python."""
        return self.language in PYTHON

    @property
    def is_shell(self) -> bool:
        """Whether the fence says that it is for a terminal."""
        return self.language in SHELL

    @property
    def title(self) -> str | None:
        """The file name that the author gave it."""
        return self.attributes.get("title") or None

    @property
    def is_file(self) -> bool:
        """Whether the title names a file of Python."""
        return bool(self.title and self.title.endswith(".py"))

    @property
    def tags(self) -> tuple[str, ...]:
        """The tags of a MyST code cell, such as `hide-input`."""
        return _tags(self.attributes)

    @property
    def first_code_line(self) -> int:
        """The chapter's line on which the code begins."""
        return self.line + 1 + self.skipped

    def has(self, flag: str) -> bool:
        """Return whether a bare attribute such as `raises` is set."""
        return self.attributes.get(flag, "false").lower() not in {"false", "no", "0"}


def directive(info: str) -> tuple[str, str]:
    """Return (name, argument) of MyST's `{name} argument`; ("", "") if it is not one, such as Pandoc's `{.python}`."""
    match = _DIRECTIVE.match(info.strip())
    if match is None or match[1].lower() in PYTHON | SHELL or info.strip().startswith("{code-cell}"):
        return "", ""
    return match[1].lower(), match[2].strip()


def parse_info(info: str) -> tuple[str, dict[str, str]]:
    """Split an info string into its language and its attributes; a bare word is an attribute that is "true".

    >>> parse_info('python title="joint_publisher.py" raises')
    ('python', {'title': 'joint_publisher.py', 'raises': 'true'})
    >>> parse_info('{.python .annotate title="a.py"}')
    ('python', {'annotate': 'true', 'title': 'a.py'})
    >>> parse_info('{#first .sourceCode .py}')
    ('py', {'sourceCode': 'true'})
    """
    info = info.strip()
    myst = re.match(r"\{code-cell\}\s*(\S*)\s*(.*)$", info)
    if myst:
        language, rest = myst.group(1) or "python", myst.group(2)
    elif info.startswith("{"):
        # Pandoc's and MkDocs' `{.python title="…"}`, Quarto's `{python}`.
        inside = re.sub(r"(?<!\S)#[\w:.-]+", "", info[1:].replace("}", " ")).strip()
        classes = re.findall(r"(?<!\S)\.?([\w+-]+)(?=,?(?:\s|$))", inside)
        # `{.sourceCode .py}` is Python, too.
        language = next((name for name in classes if name.lower() in PYTHON | SHELL), (classes or [""])[0])
        rest = re.sub(r"(?<!\S)\.(?=\w)", "", re.sub(rf"(?<!\S)\.?{re.escape(language)}(?!\S)", "", inside, count=1))
    else:
        language, _, rest = info.partition(" ")
    # ```python{title=...} and ```python {1,3} are written by people who come from other tools; so is ```python:a.py.
    language, brace, glued = language.partition("{")
    if brace:
        rest = glued.rstrip("}") + " " + rest
    # Hugo's ```python {linenos=true,filename="a.py"}.
    rest = re.sub(r"(?<!\S)\{|\}(?!\S)|,(?=\w+=)", " ", rest)
    language, colon, file = language.partition(":")
    if colon and file.endswith(".py"):
        rest = f'title="{file}" {rest}'
    attributes: dict[str, str] = {}
    for key, double, single, plain, word in _ATTRIBUTE.findall(rest):
        if key:
            attributes[key] = double or single or plain.rstrip("}")
        elif re.fullmatch(r"[A-Za-z_][\w-]*", word):
            attributes[word] = "true"
        elif word.strip("[]").endswith(_FILES):
            # VitePress' ```python [a.py].
            attributes["title"] = word.strip("[]")
    for name in ("filename", "file", "caption", "name"):
        if "title" not in attributes and attributes.get(name, "").endswith(_FILES):
            attributes["title"] = attributes[name]
    return language.rstrip(",").lower(), attributes


def make_fence(info: str, content: str, line: int) -> Fence:
    """Make a fence of its info string and content; the option lines of a MyST code cell become attributes.

    `raises-exception` among a code cell's tags is `raises`.
    """
    language, attributes = parse_info(info)
    skipped = 0
    if info.strip().startswith("{code-cell}"):
        lines = content.splitlines(keepends=True)
        values, skipped = options([line.rstrip("\n") for line in lines])
        attributes |= {key: value or "true" for key, value in values.items()}
        while skipped and skipped < len(lines) and not lines[skipped].strip():
            skipped += 1
        content = "".join(lines[skipped:])
    if info.strip().startswith("{"):
        attributes |= _quarto(content, attributes)
    if "raises-exception" in _tags(attributes):
        attributes["raises"] = "true"
    for name in ("caption", "filename"):
        if attributes.get(name, "").endswith(_FILES):
            attributes["title"] = attributes[name]
    return _written(Fence(language=language, code=content, line=line, attributes=attributes, skipped=skipped))


#: `cat > msg/Limits.msg <<EOF`, and the cell that Jupyter runs in a shell.
_HERE_DOCUMENT = re.compile(
    r"^\s*(?:\$\s+)?cat\b(?=[^\n]*?>\s*(?P<file>[\w./~-]+))[^\n]*<<-?\s*(?P<quote>[\"']?)(?P<end>\w+)(?P=quote)[^\n]*\n"
    r"(?P<text>.*?)^(?P=end)\s*",
    re.DOTALL | re.MULTILINE,
)
_SHELL_CELL = re.compile(r"%%(?:bash|sh|script bash)[^\n]*\n")
_FILE_CELL = re.compile(r"%%writefile +(?P<file>[\w./~-]+) *\n")


def in_pieces(fence: Fence) -> list[Fence]:
    """Return a fence for a terminal in pieces: each program or definition that it writes, and the commands between."""
    if "<<" not in fence.code or not fence.is_shell:
        return [fence]
    written = [match for match in _HERE_DOCUMENT.finditer(fence.code) if match["file"].endswith(_FILES)]
    cuts = sorted({0, len(fence.code), *(end for match in written for end in match.span())})
    pieces = [(start, fence.code[start:end]) for start, end in itertools.pairwise(cuts)]
    return [
        _written(replace(fence, code=code, line=fence.line + fence.code[:start].count("\n")))
        for start, code in pieces
        if code.strip()
    ]


def _written(fence: Fence) -> Fence:
    """Return the file that a fence writes and does nothing else, or the commands of a cell with `%%bash`."""
    match = _HERE_DOCUMENT.fullmatch(fence.code) if fence.is_shell and "<<" in fence.code else None
    if match and match["file"].endswith(_FILES):
        language = "python" if match["file"].endswith(".py") else "text"
        attributes = {"title": match["file"], **fence.attributes}
        return Fence(language, match["text"], fence.line, attributes, fence.skipped + 1)
    if fence.is_python and (written := _FILE_CELL.match(fence.code)) and written["file"].endswith(_FILES):
        code, attributes = fence.code[written.end() :], {"title": written["file"], **fence.attributes}
        return replace(fence, code=code, attributes=attributes, skipped=fence.skipped + 1)
    if fence.is_python and (shell := _SHELL_CELL.match(fence.code)):
        return Fence("bash", fence.code[shell.end() :], fence.line, fence.attributes, fence.skipped + 1)
    return fence


#: Quarto's `#| key: value` in a cell -> the tag that means the same in MyST.
_CELL_OPTIONS = {
    ("eval", "false"): "skip-execution",
    ("error", "true"): "raises-exception",
    ("echo", "false"): "remove-input",
    ("output", "false"): "remove-output",
    ("include", "false"): "remove-cell",
}


def _quarto(code: str, in_braces: Mapping[str, str]) -> dict[str, str]:
    """Return the file and the tags that stand for Quarto's options, in the first lines of a cell or in its braces."""
    lines = itertools.takewhile(lambda line: line.startswith("#|"), code.split("\n"))
    parts = (line[2:].partition(":") for line in lines)
    values = {**in_braces, **{key.strip(): value.strip().strip("\"'") for key, _, value in parts}}
    tags = list(filter(None, (_CELL_OPTIONS.get((key, value.lower())) for key, value in values.items())))
    named = {"filename": values["filename"]} if "filename" in values else {}
    return {**named, **({"tags": ", ".join(tags)} if tags else {})}


def _tags(attributes: Mapping[str, str]) -> tuple[str, ...]:
    words = re.findall(r"[\w.:-]+", attributes.get("tags", ""))
    return tuple(word.replace("_", "-") for word in words if word != "true")


_TITLE = re.compile(r"(?:(?P<package>\w+)/)?(?P<kind>msg|srv|action)/(?P<name>[\w-]+)\.(?P=kind)")


def interface_package(package: str) -> str:
    """Return the package of the interfaces that chapters define, given the nodes' package."""
    return f"{package}_interfaces"


def interface_path(title: str, package: str) -> str | None:
    """Return the path `PACKAGE/msg/NAME.msg` that a title stands for, or None if the title is not an interface's.

    `package` is used if the title does not name one.

    >>> interface_path("msg/JointLimits.msg", "my_robot_interfaces")
    'my_robot_interfaces/msg/JointLimits.msg'
    """
    match = _TITLE.fullmatch(title)
    if match is None:
        return None
    return f"{match['package'] or package}/{match['kind']}/{match['name']}.{match['kind']}"


def interface_title(title: str) -> str | None:
    """Return the title that `Limits.msg` or `my-msgs/msg/Limits.msg` was clearly meant to be; None for others.

    >>> interface_title("joint-limits.msg")
    'msg/JointLimits.msg'
    """
    path, dot, kind = title.rpartition(".")
    if not dot or kind not in KINDS or _TITLE.fullmatch(title):
        return None
    *folders, name = path.split("/")
    words = re.findall(r"[A-Za-z0-9]+", name)
    package = folders[-2] if len(folders) > 1 and folders[-1] == kind else ""
    package = re.sub(r"\W+", "_", package).lower() + "/" if package else ""
    return f"{package}{kind}/{''.join(word[:1].upper() + word[1:] for word in words) or 'Name'}.{kind}"


def interface_of(fence: Fence, package: str) -> str | None:
    """Return the path of the interface that a fence defines, such as `my_interfaces/msg/Pose.msg`; None for others.

    `package` is used if neither the fence nor the chapter names one.
    """
    return None if fence.has("static") else interface_path(fence.interface or fence.title or "", package)
