"""What goes wrong in a node: errors that it logs, exceptions in its output, and how it ends."""

from __future__ import annotations

import re
import signal
from collections import deque
from collections.abc import Sequence
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from spinbook.kernel.long_lines import shortened
from spinbook.kernel.reader_frames import ReaderFrames, is_log_line, line_of_cell
from spinbook.kernel.remedies import remedy, silent_callback

#: The key of an error in the metadata of a cell's output.
ERROR = "spinbook_error"
#: How the report of an error begins that an author expects.
AS_EXPECTED = "— as expected, "
#: How many lines of a node's last output a report quotes.
_QUOTED_LINES = 8
#: `ros2 launch` puts the program's name before each line.
_LAUNCHED = re.compile(r"\[[\w./-]+-\d+\] ")
#: The notebook's log format, with or without a time stamp; that of Python's `logging`; what rclpy says of a lost error.
_LOGGED = re.compile(
    r"\[(?P<level>ERROR|FATAL)\] (?:\[[\d.]+\] )?\[[^\]]*\]: ?(?P<text>.*)"
    r"|(?P<python>ERROR|CRITICAL):[\w.]+:(?P<message>.*)"
    r"|The following exception was never retrieved: (?P<lost>.*)"
)
_COLOURS = re.compile(r"\x1b\[[0-9;]*m")
_TRACEBACK = re.compile(r"(?<!Group )Traceback \(most recent call last\):\s*$")
_FRAME = re.compile(r'\s*File "([^"]+)", line (\d+)(, in <module>)?')
_RAISED = re.compile(r"[A-Za-z_][\w.<>]*(Error|Exception|Interrupt|Exit|Warning|Iteration)?(: .*)?$")
#: What C prints, before it ends the program, of a value that is no message where one belongs: its class.
_NO_MESSAGE = re.compile(r"__convert_from_py: Assertion `strncmp\(\"(?P<name>[\w.]+)\"")
_CHAINED = ("During handling of the above exception", "The above exception was the direct cause")
#: How programs end, and what they say then, when they are interrupted: Ctrl-C itself shuts rclpy's context down, below
#: callbacks that still run in other threads. If the program shuts it down, too, chance decides who is first, and so
#: which of its calls fails.
_ON_CTRL_C = re.compile(
    r"(\w+\.)*(KeyboardInterrupt|ExternalShutdownException|InvalidHandle|CancelledError)\b"
    r"|.*(rcl_shutdown already|must be initialized before it can be shutdown|context is "
    r"|(publisher|subscription|service|client|node|implementation) is invalid)"
)
#: What `ros2 launch` logs of a program that did not end with exit code 0.
_DIED = re.compile(r"process has died \[pid \d+, exit code (-?\d+)")
_FROM_US = frozenset({-signal.SIGINT, -signal.SIGTERM, -signal.SIGKILL, 128 + signal.SIGINT, 128 + signal.SIGTERM})


@dataclass(frozen=True)
class NodeError:
    """Something that went wrong in a node. `file` and `line` (of its cell, whose first line is `%%node`) are where,
    if that is known.

    `meant` says that the author expects it (`expect-error`).
    """

    node: str
    what: str
    file: str = ""
    line: int = 0
    output: str = ""
    meant: bool = False
    advice: str = ""
    """What to do about it, if it says little by itself."""

    @property
    def in_words(self) -> str:
        """The report for readers: one line, and the node's last output below it."""
        where = f"{self.file}, line {self.line}: " if self.file else ""
        if self.meant:
            return f"{AS_EXPECTED}{self.node}: {where}{self.what} —"
        quoted = (f"    | {line}" for line in self.output.splitlines())
        return "\n".join([f"✗ {self.node}: {where}{self.what} {self.advice}".rstrip(), *quoted])

    @property
    def plain(self) -> dict[str, Any]:
        """The error as JSON, for `spinbook build`."""
        what = f"{self.what} {self.advice}".rstrip()
        return {"node": self.node, "what": what, "file": self.file, "line": self.line, "meant": self.meant}


@dataclass(frozen=True)
class _LoggedException:
    """An exception in the output; `frames` are the (file, line) of its traceback.

    One that nothing caught comes from the top of a module: it ends the program.
    """

    text: str
    frames: tuple[tuple[str, int], ...] = ()
    is_uncaught: bool = False
    quoted: str = field(default="", compare=False)
    """The output's last lines up to it."""
    traceback: str = field(default="", compare=False)


@dataclass
class NodeLog:
    """Reads a node's output as it arrives, and collects what went wrong in it.

    Other threads may write anything into a traceback, also below Python: a line of the middleware, or half of one.
    """

    logged: list[str] = field(default_factory=list)
    raised: list[_LoggedException] = field(default_factory=list)
    last: deque[str] = field(default_factory=lambda: deque(maxlen=_QUOTED_LINES))
    _says_ctrl_c: bool = False
    _frames_shown: ReaderFrames = field(default_factory=ReaderFrames)
    _part: str = ""
    _chain: list[_LoggedException] = field(default_factory=list)
    _frames: list[tuple[str, int]] | None = None
    _traceback: list[str] = field(default_factory=list)
    _uncaught: bool = False
    _ignored: bool = False
    _is_chained: bool = False

    @property
    def was_interrupted(self) -> bool:
        """Whether the output says that Ctrl-C ended the program, and nothing else did."""
        return self._says_ctrl_c and not self.raised

    @property
    def is_ending(self) -> bool:
        """Whether an exception that was raised is about to end the program."""
        return any(item.is_uncaught for item in self.raised)

    def add(self, text: str, *, stopping: bool = False) -> None:
        """Add output. While a node is `stopping`, the exceptions of an interrupted program are no errors."""
        text = self._part + text
        # However the traceback came out: its exit code alone would look like an error.
        self._says_ctrl_c |= stopping and bool(_ON_CTRL_C.search(text))
        *lines, self._part = text.split("\n")
        for line in lines:
            self.last.extend(shortened(shown.rstrip()) for shown in self._frames_shown.shown([line]) if line.strip())
            self._line(_LAUNCHED.sub("", _COLOURS.sub("", line), count=1), stopping)
        self._end_chain(stopping)

    def _line(self, line: str, stopping: bool) -> None:
        if _TRACEBACK.search(line):
            if not self._is_chained:
                self._end_chain(stopping)
            self._frames, self._uncaught, self._is_chained = [], False, False
            self._traceback = [line[line.index("Traceback (") :]]
        elif self._frames is not None and not is_log_line(line):
            self._in_traceback(line, self._frames)
        elif self._frames is not None:
            # Another thread logs while Python prints the traceback.
            self._log(line, stopping)
        elif line.startswith(_CHAINED):
            self._is_chained = True
        elif not line.strip():
            return
        else:
            self._end_chain(stopping)
            self._ignored = line.startswith("Exception ignored")
            self._log(line, stopping)

    def _log(self, line: str, stopping: bool) -> None:
        if (log := _LOGGED.match(line)) and not (stopping and self._is_of_ctrl_c(_text_of(log))):
            self.logged.append(_in_words(log))

    def _is_of_ctrl_c(self, text: str) -> bool:
        """Return whether a logged text says how Ctrl-C ends a program, also one of `ros2 launch`."""
        died = _DIED.match(text)
        ended = died is not None and not ended_badly(int(died[1]), stopped=True, interrupted=self.was_interrupted)
        return ended or bool(_ON_CTRL_C.match(text))

    def _in_traceback(self, line: str, frames: list[tuple[str, int]]) -> None:
        self._traceback.append(line)
        if frame := _FRAME.match(line):
            frames.append((frame[1], int(frame[2])))
            self._uncaught = self._uncaught or bool(frame[3])
        elif _RAISED.match(line):
            text, quoted, traceback = line.strip(), "\n".join(self.last), "\n".join(self._traceback)
            self._chain.append(_LoggedException(text, tuple(frames), self._uncaught, quoted, traceback))
            self._frames = None

    def _end_chain(self, stopping: bool) -> None:
        """Keep the last exception of a chain, without those that Ctrl-C causes."""
        if self._frames is not None or not self._chain:
            return
        errors = [item for item in self._chain if not (stopping and _ON_CTRL_C.match(item.text))]
        self.raised += [] if self._ignored else errors[-1:]
        self._chain, self._ignored = [], False

    def take(self) -> tuple[list[str], list[_LoggedException]]:
        """Return what was logged and raised since the last call. rclpy also logs what a callback raised: it counts
        once."""
        raised = list(dict.fromkeys(self.raised))
        texts = [item.text.partition(": ")[2] or item.text for item in raised]
        logged = [line for line in dict.fromkeys(self.logged) if not any(text in line for text in texts)]
        self.logged, self.raised = [], []
        return logged, raised


def _text_of(log: re.Match[str]) -> str:
    return log["text"] or log["message"] or log["lost"] or ""


def _in_words(log: re.Match[str]) -> str:
    level = log["level"] or log["python"]
    return f"it logged {level}: {_text_of(log)}" if level else f"an exception was lost: {_text_of(log)}"


def how_it_ended(code: int) -> str:
    """Return how a process ended, in words."""
    if code >= 0:
        return f"ended with exit code {code}."
    try:
        return f"was ended by signal {-code} ({signal.Signals(-code).name})."
    except ValueError:
        return f"was ended by signal {-code}."


def ended_badly(code: int | None, *, stopped: bool, interrupted: bool = False) -> bool:
    """Return whether an exit code means an error. A node that was `stopped` may end as Ctrl-C ends a program, also with
    exit code 1 after an exception that says that it was `interrupted`."""
    if code in (0, None):
        return False
    return not (stopped and (code in _FROM_US or interrupted))


def describe(
    node: str, log: NodeLog, ended: str, *, files: Sequence[str] = (), meant: bool = False
) -> NodeError | None:
    """Return what is new in a node's log as one report; `ended` says how it ended, "" if it did not end badly. `files`
    are its programs.
    """
    logged, raised = log.take()
    no_message = [match["name"].split(".")[-1] for line in log.last if ended and (match := _NO_MESSAGE.search(line))]
    refused = [f"something else was sent where a `{name}` belongs" for name in no_message]
    causes = [*(item.text for item in raised), *logged, *refused]
    if not causes and not ended:
        return None
    traceback = raised[0].traceback if raised else "\n".join(log.last) if refused else ""
    silent = silent_callback(traceback, files)
    first = shortened(causes[0]).rstrip(".") if causes else ""
    first = f"{silent[0]} ({first})" if silent else first
    more = f" (and {len(causes) - 1} more)" if len(causes) > 1 else ""
    message = f"{first}{more}. It {ended}" if causes and ended else f"It {ended}" if ended else f"{first}{more}."
    frames = [frame for item in raised[:1] for frame in item.frames]
    places = [(Path(file).name, shown) for file, line in frames if (shown := line_of_cell(file, line))]
    file, line = silent[1:] if silent else places[-1] if places else ("", 0)
    output = next((item.quoted for item in raised), "\n".join(log.last))
    advice = remedy(traceback, [*files, *(file for file, _ in frames)]) if raised and not meant else ""
    return NodeError(node, message, file, line, output, meant, advice)
