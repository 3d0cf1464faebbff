"""The kind of a single fence: a program, a snippet, shell, or static, with the reason if it is not run."""

from __future__ import annotations

import re
from dataclasses import dataclass, replace
from enum import Enum
from pathlib import Path

from groundwork.problem import Problem, Severity
from groundwork.words import did_you_mean, similar
from spinbook.chapter.attributes import not_included
from spinbook.chapter.fence import ATTRIBUTES, Fence, interface_of, interface_title
from spinbook.chapter.installed_interfaces import is_someone_elses
from spinbook.chapter.launch_files import is_package_file, unsupported_in_launch_file
from spinbook.chapter.node_classes import snake_case
from spinbook.chapter.own_packages import is_setup_excerpt
from spinbook.chapter.python_code import CodeError, PythonCode, facts_of, has_magics, inspect, programs_in_magics
from spinbook.chapter.terminal import (
    SHOWN_PROMPT,
    Command,
    CommandKind,
    UnsupportedCommand,
    looks_like_shell,
    read_commands,
)
from spinbook.chapter.transcripts import is_session, split_session, split_transcript, without_gaps

#: Programs that a chapter never runs here, wherever they are named, because they change the machine or download
#: something.
NEVER_RUN = frozenset(
    [
        *("sudo", "su", "apt", "apt-get", "aptitude", "dpkg", "snap", "brew", "yum", "dnf", "pacman", "rm", "rmdir"),
        *("mv", "dd", "mkfs", "git", "pip", "pip3", "pipx", "uv", "conda", "mamba", "npm", "yarn", "curl", "wget"),
        *("ssh", "scp", "docker", "podman", "reboot", "shutdown", "poweroff", "kill", "pkill", "killall", "chown"),
        *("systemctl", "service", "rosdep"),
    ]
)


#: Languages of fences whose content says whether they are for a notebook's terminal.
_ANY = frozenset({"", "text", "plaintext", "powershell", "ps1", "pwsh", "cmd", "bat", "batch"})
#: Languages of what is only shown, whatever it is.
_SHOWN = frozenset({"diff", "patch", "output", "log", "markdown", "md", "history"})
#: Languages of what Python shows in a terminal.
_SESSIONS = frozenset({"pycon", "doctest", "python-repl", "python-console", "", "text", "console"})
_SESSIONS |= {"ipython", "ipython3", "ipy"}


class CellKind(str, Enum):
    """The kind of a cell or a fence. It decides what the cell becomes in each product.

    A part is code that later programs of the chapter use; a file is a launch or parameter file. Prose and exercises
    come from the text around fences. A static fence is shown in the prose and becomes no cell of its own.
    """

    PROSE = "prose"
    NODE = "node"
    SNIPPET = "snippet"
    PART = "part"
    SHELL = "shell"
    INTERFACE = "interface"
    FILE = "package_file"
    EXERCISE = "exercise"
    STATIC = "static"


@dataclass(frozen=True)
class ClassifiedFence:
    """A fence and its kind. `why` says why a static one is not run; `sign` tells readers in a few words.

    `name` is a node's, a part's or an interface's. `before` is the code that completes a node, `after` names the nodes
    and parts from which that code comes, `runs_in_kernel` says that a part also runs as a snippet. `executables` are a
    node's names for `ros2 run`: (package, executable).
    """

    fence: Fence
    kind: CellKind
    why: str = ""
    sign: str = ""
    name: str | None = None
    code: PythonCode | None = None
    commands: tuple[Command, ...] = ()
    before: str = ""
    after: tuple[str, ...] = ()
    runs_in_kernel: bool = True
    executables: tuple[tuple[str, str], ...] = ()
    output: str = ""
    """What the author's terminal printed, if the fence is a transcript."""
    named: bool = True
    """Whether the author named its file."""
    replaces: str = ""
    """The node of which this is a newer version, if that has another file."""
    waits: bool = False
    """Whether it counts its command-line arguments, and a command below gives it some."""
    has_main_above: bool = False
    """Whether `before` has the `main` of an earlier version."""
    problems: tuple[Problem, ...] = ()
    """What is wrong in the fence itself."""

    @property
    def is_static(self) -> bool:
        """Whether it becomes no cell."""
        return self.kind is CellKind.STATIC

    @property
    def runs_main(self) -> bool:
        """Whether the runtime must call the code's `main`."""
        return self.kind is CellKind.NODE and self.code is not None and (self.code.runs_main or self.has_main_above)

    @property
    def keeps(self) -> bool:
        """Whether the code is only saved, for a command to start: it reads command-line arguments, or nothing calls
        its method that spins.
        """
        if self.kind is not CellKind.NODE or self.code is None:
            return False
        return self.waits or self.code.words_read > 0 or bool(self.spin_classes and self.code.uncalled)

    @property
    def spin_classes(self) -> tuple[str, ...]:
        """The classes that the runtime must run with `rclpy.spin`, if the code only defines them: `Class`, or
        `Class.method` for one whose method spins.
        """
        code = self.code
        if self.kind is not CellKind.NODE or code is None or code.is_complete or code.calls_main or self.has_main_above:
            return ()
        method = code.called or code.uncalled
        return (method,) if method else code.alone

    @property
    def whole(self) -> str:
        """A node's program as it runs."""
        return self.before + self.fence.code


def static(
    fence: Fence, why: str, *problems: Problem, sign: str = "", code: PythonCode | None = None
) -> ClassifiedFence:
    """Return a fence that is only shown; `sign` is what readers are told below it, "" for nothing."""
    return ClassifiedFence(fence, CellKind.STATIC, why, sign, code=code, problems=problems)


def first_look(fence: Fence, file: Path, interface_package: str) -> ClassifiedFence:
    """Classify a fence by itself. Python that can run is a snippet here, or a node if it is a program.

    `interface_package` is the package of an interface whose title does not name one.
    """
    item = _by_title(fence, file, interface_package) or _by_content(with_language(fence), file)
    return replace(item, problems=(*_unknown_attributes(fence, file), *_unknown_tags(fence, file), *item.problems))


def _by_title(fence: Fence, file: Path, interface_package: str) -> ClassifiedFence | None:
    """Return what the title or the word `static` makes of a fence; None if its content decides."""
    title = fence.title or ""
    if fence.has("static"):
        return static(fence, "it says `static`")
    if path := interface_of(fence, interface_package):
        package = path.partition("/")[0]
        if is_someone_elses(package, interface_package):
            return static(fence, f"it shows an interface of {package}, which is installed")
        return ClassifiedFence(fence, CellKind.INTERFACE, name=path)
    if meant := interface_title(title):
        problem = f"this definition is shown and not compiled: its title `{title}` is not an interface's name."
        fix = f'Write title="{meant}", or write `static` after the language if it is only to be shown.'
        not_run = Problem(file, fence.line, problem, fix, Severity.NOT_RUN)
        return static(fence, "its title is not an interface's name", not_run)
    if is_package_file(title) and not (fence.is_python and _is_no_launch_file(fence.code)):
        return ClassifiedFence(fence, CellKind.FILE, name=title)
    return None


def _is_no_launch_file(code: str) -> bool:
    """Return whether `ros2 launch` can't run a file here: it is not Python, or uses what is not supported."""
    try:
        return bool(unsupported_in_launch_file(code))
    except SyntaxError:
        return True


def _by_content(fence: Fence, file: Path) -> ClassifiedFence:
    if (fence.is_python or fence.is_shell or not fence.language) and (name := not_included(fence.code)):
        fix = "Write the path relative to the chapter's folder, or to the course's."
        text = f"`{name}` can't be included: the course has no such file, or it includes itself."
        problem = Problem(file, fence.line, text, fix, Severity.NOT_RUN, "files to include")
        why = f"it includes `{name}`, which is not here"
        return static(fence, why, problem, sign=f"{why}.")
    if fence.is_shell:
        return _shell(fence, file)
    if fence.is_python:
        code, output = split_session(fence.code)
        return replace(_python(replace(fence, code=code), file), output=output)
    what = f"`{fence.language}` is" if fence.language else "a fence without a language is"
    return static(fence, f"{what} neither Python nor shell")


def with_language(fence: Fence) -> Fence:
    """Return the fence; one without a language, or of one that nobody knows, gets what its content clearly is."""
    if fence.language in _SESSIONS and is_session(fence.code):
        return replace(fence, language="python")
    is_unknown = fence.language not in _ANY
    if fence.is_python or fence.is_shell or fence.language in _SHOWN or (fence.attributes and not is_unknown):
        return fence
    if is_unknown and _is_program(fence):
        return replace(fence, language="python")
    if looks_like_shell(split_transcript(fence.code)[0] if SHOWN_PROMPT.match(fence.code.lstrip()) else fence.code):
        return replace(fence, language="bash")
    if not fence.language and _IMPORTS_ROS.search(fence.code):
        return replace(fence, language="python")
    return fence


_IMPORTS_ROS = re.compile(r"^(import|from) (rclpy|\w+(_msgs|_srvs|_interfaces))\b", re.MULTILINE)


def _is_program(fence: Fence) -> bool:
    """Return whether a fence of a language that nobody knows is a program for rclpy, such as `pyhton`."""
    return "rclpy" in fence.code and bool(_IMPORTS_ROS.search(fence.code)) and not facts_of(fence.code).fragment


def _unknown_attributes(fence: Fence, file: Path) -> list[Problem]:
    """Return attributes that look like misspellings of ours; those of other book tools are ignored."""
    unknown = [name for name in fence.attributes if name not in ATTRIBUTES and similar(name, ATTRIBUTES, 0.75)]
    if not unknown or not (fence.is_python or fence.is_shell):
        return []
    known = "; ".join(f"`{name}`: {meaning}" for name, meaning in ATTRIBUTES.items())
    problem = f"unknown attribute {', '.join(f'`{name}`' for name in unknown)} on this fence."
    return [Problem(file, fence.line, problem, f"Known are {known}.", Severity.WARNING)]


#: MyST's tags that decide whether a cell runs, and what a page shows of it.
_TAGS = tuple(f"{verb}-{part}" for verb in ("hide", "remove") for part in ("input", "output", "cell"))
_TAGS += ("skip-execution", "raises-exception")


def _unknown_tags(fence: Fence, file: Path) -> list[Problem]:
    """Return tags that look like misspellings of MyST's; others may be the author's own."""
    meant = {tag: did_you_mean(tag, _TAGS, "", "`{}`", 0.85) for tag in fence.tags if tag not in _TAGS}
    return [
        Problem(file, fence.line, f"unknown tag `{tag}` on this cell.", question, Severity.WARNING)
        for tag, question in meant.items()
        if question
    ]


def _shell(fence: Fence, file: Path) -> ClassifiedFence:
    code, output = split_transcript(fence.code)
    read = read_commands(code)
    refused = [command for command in read if isinstance(command, UnsupportedCommand)]
    commands = tuple(command for command in read if isinstance(command, Command))
    runnable = [command for command in commands if command.kind is not CommandKind.NOTE]
    if runnable and not refused:
        fence = replace(fence, code=without_gaps(code, output)) if output else fence
        return ClassifiedFence(fence, CellKind.SHELL, commands=commands, output=output)
    ros = next((command for command in refused if command.is_ros or command.meant), None) or next(
        (command for command in refused if re.search(r"\bros2 (run|launch|\w+ \w+)", command.text)), None
    )
    if runnable or ros:
        shown = ros or refused[0]
        return static(fence, shown.why, _not_run(fence, shown, file), sign=f"{shown.why}.")
    return static(fence, refused[0].why if refused else "it contains no command that a notebook runs")


def _not_run(fence: Fence, command: UnsupportedCommand, file: Path) -> Problem:
    line, problem = fence.first_code_line + command.line - 1, f"{command.why} (`{command.text}`)."
    if command.meant:
        return Problem(file, line, problem, f"Did you mean `{command.meant}`?", Severity.NOT_RUN)
    problem = f"this shell fence is shown and not run: {problem}"
    fix = "Put what can run into a fence of its own, or write `static` after the language to say that this is meant."
    return Problem(file, line, problem, fix, Severity.WARNING, group="a real shell")


def _python(fence: Fence, file: Path) -> ClassifiedFence:
    try:
        code = inspect(fence.code)
    except CodeError as error:
        return static(fence, "it is a setup.py") if is_setup_excerpt(fence.code) else _broken(fence, error, file)
    if why := _why_static(fence, code):
        return static(fence, why, sign=f"{why}." if why.startswith("it is a fragment") else "", code=code)
    if why := _why_refused(fence, code):
        return static(fence, why, sign=f"{why}.", code=code)
    if not (fence.is_file or code.is_node):
        return ClassifiedFence(fence, CellKind.SNIPPET, code=code)
    if has_magics(fence.code):
        problem = "a node's code contains a notebook command (a line that begins with % or !)."
        fix = "A node is a file of its own, which Python runs: put the command into another fence."
        not_run, why = Problem(file, fence.line, problem, fix, Severity.NOT_RUN), "it contains a notebook command"
        return static(fence, why, not_run, sign=f"{why}.", code=code)
    return ClassifiedFence(fence, CellKind.NODE, code=code)


def _broken(fence: Fence, error: CodeError, file: Path) -> ClassifiedFence:
    line = fence.first_code_line + error.line - 1
    fix = "Fix the code, or write `static` after the language if it is only to be shown and not run."
    text = f"not Python: {error.message} (column {error.column})."
    sign = f"line {error.line} is not valid Python ({error.message})."
    return static(fence, "it is not Python", Problem(file, line, text, fix, Severity.NOT_RUN), sign=sign)


def _why_refused(fence: Fence, code: PythonCode) -> str:
    """Return why Python that could run is not run here, if so."""
    started = {**code.programs, **programs_in_magics(fence.code)}
    if never := sorted(set(started) & NEVER_RUN):
        return f"it runs `{never[0]}`"
    if code.asks and not fence.has("raises"):
        return "it waits for keyboard input"
    return ""


def _why_static(fence: Fence, code: PythonCode) -> str:
    if not fence.code.strip():
        return "it is empty"
    if all(line.lstrip().startswith("#") for line in fence.code.split("\n") if line.strip()):
        return "it holds only comments"
    if is_setup_excerpt(fence.code):
        return "it is a setup.py"
    if code.fragment:
        return f"it is a fragment: {code.fragment}"
    if code.is_setup_script:
        return "it is a setup.py"
    if code.is_launch_file:
        return "it is a launch file"
    if fence.title and re.fullmatch(r"[\w./-]+\.(?!py$)[a-z]{1,6}", fence.title):
        return f"`{fence.title}` is not a Python file"
    return ""


def node_name(item: ClassifiedFence, text: str, file: Path) -> tuple[str, bool, list[Problem]]:
    """Return (a node's file without .py, whether the author named it, problems). The text names the file `text`."""
    code = item.code
    named_file = item.fence.title if item.fence.is_file else text
    if named_file:
        stem = named_file.rsplit("/", 1)[-1].removesuffix(".py")
        if stem.isidentifier():
            return stem, True, []
        name = re.sub(r"\W+", "_", stem).strip("_") or "node"
        name = name if name.isidentifier() else f"node_{name}"
        problem = f"`{named_file}` can't be a module: `{stem}` is not a Python name. It is called `{name}` here."
        fix = "Use letters, digits and underscores, such as my_node.py."
        return name, True, [Problem(file, item.fence.line, problem, fix, Severity.WARNING)]
    assert code is not None
    name = code.ros_name if code.ros_name and code.ros_name.isidentifier() else ""
    if code.own_classes:
        return name or snake_case(code.own_classes[0]), False, []
    return name or re.sub(r"\W+", "_", code.ros_name or "node"), False, []
