"""A shell fence: the commands in it, and whether a notebook can run them.

A notebook runs `ros2 …`, `colcon …`, `rqt_plot …` and `rqt_graph`. A terminal also needs `cd`, `source` and `export`; a
notebook does not, so they become comments. Anything else is shown but not run.
"""

from __future__ import annotations

import contextlib
import functools
import re
import shlex
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from enum import Enum

import click

from groundwork.words import similar

#: The nouns of `ros2` that a package follows, not a verb.
_STARTING = frozenset({"run", "launch"})
#: Next to a command that runs, this is the general form of it.
_FORM = "it holds placeholders for what a reader fills in"
_IN_A_TERMINAL = frozenset({"bag", "multicast", "doctor", "wtf"})
MOVING_ABOUT = frozenset({"cd", "source", ".", "export", "unset", "clear"})
#: Commands that show or make files: a notebook can skip them if the fence has a command that runs.
_BESIDE = frozenset(
    [
        *("mkdir", "touch", "ls", "pwd", "cat", "nano", "vim", "vi", "gedit", "code", "tree", "chmod", "echo"),
        *("sleep", "exit"),
    ]
)
_SHELL_SYNTAX = re.compile(r"[|;<>`]|&&|\$\(|(?<!\S)&(?!\S)|&$")
#: Characters with a special meaning to a shell, and text between quotation marks.
_QUOTING = re.compile(r"[\"'\\]")
_QUOTED = re.compile(r"\"[^\"]*\"|'[^']*'")
#: How alike a program or a verb and its misspelling are at least.
_ALIKE = 0.7
_ZSH = r"(?:(?:[\w.~/-]+\s)?\S*❯|➜\s+\S+(?:\s+git:\(\S+\))?(?:\s+✗)?)"
#: `PS C:\ws>` and `C:\ws>` of Windows; `>` and `%`, which only the command after them makes prompts.
_OTHER = r"|(?:PS\s)?[A-Z]:\\[^>\n]*>|[>%](?=\s+(?:ros2|colcon)\s)"
_WHO = (
    _ZSH + _OTHER + r"|(?:\([\w.-]+\)\s*)?(?:\[?[\w.-]+@[\w.-]+[:\s]?[^\s$#%]*\]?\s?[$#%]|[\w.~/-]*\$|[~/][\w./-]* [$%]"
)
_WHO += r"|[\w.-]+@[\w.-]+ [~/][\w./-]*>|(?:ba|z)?sh-[\d.]+[$#])"
#: A prompt that is certainly one: `$`, `~/ros2_ws$`, `user@host:~$`, `[user@host ws]$`, `(venv) $`, `❯`, `➜ ~`.
SHOWN_PROMPT = re.compile(rf"^\s*(?:{_WHO})\s+(?=\S)")
_PROMPT = re.compile(rf"^\s*(?:{_WHO}|[#>])\s+(?=\S)")
#: What a reader replaces: `{topic_name}`, `[options]`, `<name>`.
_PLACEHOLDER = re.compile(r"\{[A-Za-z][\w -]*\}|\[[A-Za-z][\w .|=-]*\]|<[A-Za-z][^<>]*>")
_CAPITALS = re.compile(
    r"(PACKAGE|PKG|NODE|TOPIC|SERVICE|ACTION|PARAM(ETER)?|TYPE|NAME|FILE|VALUE|DATA|EXECUTABLE)(_[A-Z]+)*"
)
PROGRAMS = frozenset({"ros2", "colcon", "rqt_plot", "rqt_graph"})
#: Windows that a notebook draws in a cell; their packages have the same names.
_WINDOWS = ("rqt_plot", "rqt_graph")
#: What goes on while other commands run: the `&` after it changes nothing here.
_IN_BACKGROUND = re.compile(r"^(?P<command>(?:ros2 (?:run|launch)|rqt_plot|rqt_graph)\b[^&]*?)\s*&$")


class CommandKind(Enum):
    """The program that runs a command in a notebook."""

    ROS2 = "ros2"
    COLCON = "colcon"
    PLOT = "rqt_plot"
    GRAPH = "rqt_graph"
    NOTE = "note"


@dataclass(frozen=True)
class Command:
    """One command (or comment) of a shell fence, with continued lines joined. `line` counts from 1 within the fence."""

    kind: CommandKind
    text: str
    words: tuple[str, ...]
    line: int

    @property
    def runs(self) -> tuple[str, str] | None:
        """(package, executable) of `ros2 run PACKAGE EXECUTABLE`."""
        words = [word for word in self.words[2:4] if not word.startswith("-")]
        is_run = self.kind is CommandKind.ROS2 and self.words[1:2] == ("run",)
        return (words[0], words[1]) if is_run and len(words) == 2 else None


def note(text: str, line: int) -> Command:
    """Return a comment with this text, which may stand for a command that is not run."""
    return Command(CommandKind.NOTE, f"# {text}", (), line)


@dataclass(frozen=True)
class UnsupportedCommand:
    """A command that a notebook can't run, and why; `meant` is the command of which it looks like a misspelling.

    `is_unknown` is whether `ros2` has no such noun or verb.
    """

    text: str
    line: int
    why: str
    meant: str = ""
    is_unknown: bool = False

    @property
    def is_ros(self) -> bool:
        """Whether it is one of the commands that a notebook runs, but in a form that it can't run."""
        return self.text.split(" ")[0] in PROGRAMS


def read_commands(code: str) -> list[Command | UnsupportedCommand]:
    """Return the commands of a shell fence, in order. If one can run, commands for a terminal become notes."""
    read = [_read(part, line) for text, line in _logical_lines(code) for part in _parts(text)]
    runs = any(isinstance(command, Command) and command.kind is not CommandKind.NOTE for command in read)
    return [_noted(command) if runs and isinstance(command, UnsupportedCommand) else command for command in read]


def looks_like_shell(code: str) -> bool:
    """Return whether each line of a text begins like a terminal command, and at least one like a ROS command."""
    texts = [text for text, _ in _logical_lines(code) if not text.startswith("#")]
    known = PROGRAMS | MOVING_ABOUT | {"mkdir"}
    firsts = [text.split()[0] for text in texts]
    says_what = len(texts[0].split()) > 1 or texts[0] == "rqt_graph" if texts else False
    return bool(firsts) and set(firsts) <= known and bool(set(firsts) & PROGRAMS) and says_what


#: What stands for the name of a package: `PACKAGE_NAME`, `<package>`, `{[1]`, `your_package`.
_PACKAGE_PLACEHOLDER = re.compile(
    r"[A-Z][A-Z0-9_]+|.*[^\w/.~-].*|(your|the|some|any|a|my_ros2?|ros2?)?_?(package|pkg)(_?name)?|(your|some)_\w+"
)


def is_placeholder(package: str) -> bool:
    """Return whether a word in the place of a package's name is for a reader to fill in.

    >>> [is_placeholder(name) for name in ("PACKAGE_NAME", "{[1]", "package_name", "my_package", "turtlesim")]
    [True, True, True, False, False]
    """
    return bool(_PACKAGE_PLACEHOLDER.fullmatch(package))


def _is_to_fill_in(word: str) -> bool:
    """Return whether a word of a command is for a reader to fill in.

    >>> [_is_to_fill_in(word) for word in ("/<node>", "NODE_NAME", "...", "/cmd_vel", "Q")]
    [True, True, True, False, False]
    """
    name = word.strip("/")
    return name in {"...", "…"} or bool(_PLACEHOLDER.fullmatch(name) or _CAPITALS.fullmatch(name))


def programs_of(code: str) -> list[tuple[str, ...]]:
    """Return the words of each command, whether a notebook runs it or not."""
    commands = []
    for part in (part for text, _ in _logical_lines(code) for part in _parts(text)):
        with contextlib.suppress(ValueError):
            commands.append(tuple(shlex.split(part, comments=True)))
    return [words for words in commands if words]


def _noted(command: UnsupportedCommand) -> Command | UnsupportedCommand:
    is_form = command.why == _FORM
    if is_form or (command.text.split(" ")[0] in _BESIDE and not _SHELL_SYNTAX.search(command.text)):
        return note(command.text, command.line)
    return command


def _parts(text: str) -> list[str]:
    """Return the commands of a line that are joined with `&&`, or with `;` after a change of folder."""
    if text.startswith("#") or ("&&" not in text and ";" not in text):
        return [text]
    try:
        words = list(shlex.shlex(text, posix=False, punctuation_chars="&;|<>"))
    except ValueError:
        return [text]
    marks = {word for word in words if set(word) <= set("&;|<>")}
    is_quoted = any("&&" in quoted or ";" in quoted for quoted in _QUOTED.findall(text))
    if is_quoted or not marks or marks - {"&&", ";"}:
        return [text]
    return [part.strip() for part in re.split(r"&&|;", text)]


def _logical_lines(code: str) -> Iterator[tuple[str, int]]:
    """Yield each command without its prompt; a line that ends in a backslash or inside quotes is joined to the next."""
    joined, start = "", 0
    for number, raw in enumerate(code.split("\n"), start=1):
        if not joined:
            start = number
            prompt = _PROMPT.match(raw)
            # `# text` is a comment; `root@machine:~# text` is a prompt.
            joined = (
                raw[prompt.end() :].strip()
                if prompt and (prompt[0].strip() not in {"#", ">"} or SHOWN_PROMPT.match(raw))
                else raw.strip()
            )
        else:
            joined += "\n" + raw if inside_quotes(joined) else " " + raw.strip()
        if joined.endswith("\\"):
            joined = joined[:-1].rstrip()
        elif joined and not (inside_quotes(joined) and not joined.startswith("#")):
            yield joined, start
            joined = ""
    if joined:
        yield joined, start


def inside_quotes(text: str) -> bool:
    """Return whether a text ends between quotation marks, or after a backslash."""
    if not _QUOTING.search(text):
        return False
    try:
        shlex.split(text)
    except ValueError:
        return True
    return False


def _read(text: str, line: int) -> Command | UnsupportedCommand:
    if text.startswith("#"):
        return Command(CommandKind.NOTE, text, (), line)
    background = _IN_BACKGROUND.match(text)
    text = background["command"] if background else text
    try:
        words = tuple(shlex.split(text, comments=True) if _QUOTING.search(text) or "#" in text else text.split())
    except ValueError:
        return UnsupportedCommand(text, line, "a quotation mark is never closed")
    if not words:
        return note(text, line)
    text = _without_comment(text)
    program = words[0]
    if program in MOVING_ABOUT:
        return note(text, line)
    if program not in PROGRAMS:
        why = f"`{program}` is not ros2, colcon, rqt_plot or rqt_graph"
        return UnsupportedCommand(text, line, why, similar(program, PROGRAMS, _ALIKE))
    if any(map(_is_to_fill_in, words[1:])):
        return UnsupportedCommand(text, line, _FORM)
    if _SHELL_SYNTAX.search(_QUOTED.sub("", text)):
        return UnsupportedCommand(text, line, "pipes, `;`, `&` and redirections need a real shell")
    if program == "ros2":
        return _ros2(text, words, line)
    if program == "colcon":
        return Command(CommandKind.COLCON, text, words, line)
    return _window(text, words, line)


def _window(text: str, words: tuple[str, ...], line: int) -> Command | UnsupportedCommand:
    """Return the command that draws what `rqt_plot` or `rqt_graph` shows."""
    if words[0] == "rqt_graph":
        return Command(CommandKind.GRAPH, text, words, line)
    if len(words) == 1:
        return UnsupportedCommand(text, line, "rqt_plot needs a topic here, such as rqt_plot /turtle1/pose/x")
    return Command(CommandKind.PLOT, text, words, line)


def _without_comment(text: str) -> str:
    """Return a command without the comment after it."""
    # Text between quotation marks is blanked out, so that a # in it is none.
    comment = re.search(r"\s#", _QUOTED.sub(lambda quoted: "_" * len(quoted[0]), text))
    return text[: comment.start()].rstrip() if comment else text


def _unknown(text: str, line: int, before: str, word: str, known: Iterable[str]) -> UnsupportedCommand:
    """Return a command whose `word`, after `before`, is not one of those that are known there."""
    why, close = f"there is no `{before} {word}` here", similar(word, known, _ALIKE)
    if close:
        return UnsupportedCommand(text, line, why, f"{before} {close}", is_unknown=True)
    return UnsupportedCommand(text, line, f"{why}; there are: {', '.join(sorted(known))}", is_unknown=True)


@functools.cache
def _verbs(noun: str) -> tuple[str, ...]:
    """Return the verbs of `ros2 NOUN`."""
    from ros_in_python.ros2.command import ros2

    context = click.Context(ros2)
    menu = None if noun in _STARTING else ros2.get_command(context, noun)
    return tuple(menu.list_commands(context)) if isinstance(menu, click.Group) else ()


def _ros2(text: str, words: tuple[str, ...], line: int) -> Command | UnsupportedCommand:
    from ros_in_python.ros2.command import NOUNS

    noun = words[1] if len(words) > 1 else ""
    if noun in _IN_A_TERMINAL:
        return UnsupportedCommand(text, line, f"`ros2 {noun}` runs in a terminal, not in a notebook")
    if noun not in NOUNS:
        return _unknown(text, line, "ros2", noun, NOUNS)
    if noun == "run" and words[2:3] == words[3:4] and words[2:3] and words[2] in _WINDOWS:
        return _window(text.partition(words[2])[2].strip(), words[3:], line)
    verb, verbs = words[2] if len(words) > 2 else "", _verbs(noun)
    if verbs and verb not in verbs and not verb.startswith("-"):
        return _unknown(text, line, f"ros2 {noun}", verb, verbs)
    return Command(CommandKind.ROS2, text, words, line)
