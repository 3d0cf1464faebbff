"""A terminal's transcript in a fence: which lines are commands, and which are what the author's terminal printed."""

from __future__ import annotations

import re
from dataclasses import dataclass, field

from spinbook.chapter.terminal import MOVING_ABOUT, PROGRAMS, SHOWN_PROMPT, inside_quotes

#: Words with which a line is a command although it has no prompt.
_COMMANDS = PROGRAMS | MOVING_ABOUT
#: What no command begins with, and ROS programs print: a log line, the name of a topic, a service or a node alone on
#: its line, `Type: …`, a message's `data: …` and `---`.
_PRINTED = re.compile(
    r"\[(?:INFO|WARN|ERROR|DEBUG|FATAL)\]|---$"
    r"|/\w[\w/]*(?:: [\w/]+| \[[\w/]+\])?\s*$|[A-Za-z][\w ]*:(?:\s|$)(?!.*\bros2\b)"
)
_CONTINUED = re.compile(r"^\s*>\s?")


@dataclass
class _SplitFence:
    """The lines of a fence so far. `open` is a command that goes on in the next line, `printed` what each printed."""

    has_prompts: bool
    commands: list[str] = field(default_factory=list)
    printed: list[tuple[str, list[str]]] = field(default_factory=list)
    open: str = ""
    last: str = ""
    in_output: bool = False

    def add(self, line: str) -> None:
        if self.open:
            self._command(_CONTINUED.sub("", line) if self.has_prompts else line, self.open)
        elif self._is_printed(line):
            if not self.in_output:
                self.printed.append((self.last, []))
            self.printed[-1][1].append(line.rstrip())
            self.commands.append("")
            self.in_output = True
        else:
            self._command(line, "")

    def _command(self, line: str, begun: str) -> None:
        self.commands.append(line)
        words = SHOWN_PROMPT.sub("", line).strip()
        if not words:
            return
        whole = f"{begun}\n{words}" if begun else words
        goes_on = words.endswith("\\") or (inside_quotes(whole.replace("\\\n", " ")) and not whole.startswith("#"))
        self.open, self.last, self.in_output = whole if goes_on else "", whole, False

    @property
    def output(self) -> str:
        """What was printed; below each command if several printed something."""
        if len(self.printed) < 2:
            return "\n".join(line for _, lines in self.printed for line in lines).strip("\n")
        texts = ["\n".join([f"$ {command}", *lines]).strip("\n") for command, lines in self.printed]
        return "\n\n".join(texts)

    def _is_printed(self, line: str) -> bool:
        text = line.strip()
        if SHOWN_PROMPT.match(line) or text.partition(" ")[0] in _COMMANDS or not self.last:
            return False
        if self.in_output:
            return True
        if text.startswith("#"):
            return self.has_prompts and "interface show" in self.last
        after_ros = self.last.partition(" ")[0] in PROGRAMS
        return bool(text) and (self.has_prompts or (after_ros and bool(_PRINTED.match(text))))


def split_transcript(code: str) -> tuple[str, str]:
    """Return (the commands, the printed lines) of a fence. Lines that are not commands are empty in the commands."""
    lines = code.split("\n")
    split = _SplitFence(any(map(SHOWN_PROMPT.match, lines)))
    for line in lines:
        split.add(line)
    return ("\n".join(split.commands), split.output) if split.printed or split.has_prompts else (code, "")


def split_session(code: str) -> tuple[str, str]:
    """Return (the statements, the printed lines) of what Python or IPython shows in a terminal, with `>>>` or `In [1]:`
    before a statement.

    >>> split_session(">>> for i in range(1):\\n...     print(i)\\n...\\n0\\n")
    ('for i in range(1):\\n    print(i)\\n\\n', '0')
    """
    if not is_session(code):
        return code, ""
    lines = [line.strip("\r") for line in code.rstrip("\n").split("\n")]
    matches = [_STATEMENT.match(line) for line in lines]
    statements = [line[match.end() :] for line, match in zip(lines, matches, strict=True) if match]
    printed = [line for line, match in zip(lines, matches, strict=True) if not match]
    return "".join(f"{line}\n" for line in statements), "\n".join(printed).strip("\n")


def is_session(code: str) -> bool:
    """Return whether a text is what Python or IPython shows in a terminal."""
    return bool(_SESSION.match(code))


_SESSION = re.compile(r"\s*(>>>|In ?\[\d*\]:) ")
_STATEMENT = re.compile(r"(?:>>>|\.\.\.|In ?\[\d*\]:| +\.\.\.:)(?: |$)")


def without_gaps(commands: str, output: str) -> str:
    """Return the commands as code to show, without the lines that the output has left."""
    lines = [line for line in commands.split("\n") if line.strip()] if output else commands.rstrip("\n").split("\n")
    return "".join(f"{line}\n" for line in lines)
