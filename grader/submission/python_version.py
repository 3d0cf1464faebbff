"""Says which Python version a program needs, if that is newer than the grader's.

Source: "What's New In Python" 3.11 to 3.14.
"""

from __future__ import annotations

import re
import sys

from grader.submission import python_code
from grader.submission.unreadable import not_python

_Version = tuple[int, int]

#: The first version that can read a syntax, a pattern of its line, and its name.
_SYNTAX: tuple[tuple[_Version, str, str], ...] = (
    ((3, 14), r"""(?<![\w'"])[tT][rR]?(?:"|')""", 'a template string (t"…")'),
    ((3, 14), r"^\s*except\*? +[\w.]+ *,[\w., ]+:", "`except A, B:` without parentheses"),
    ((3, 13), r"^\s*(?:class|def|type)\s+\w+\[[^\]=]{0,500}=", "a type parameter's default"),
    ((3, 12), r"^\s*(?:class|(?:async\s+)?def)\s+\w+\[", "type parameters (`def f[T](…)`)"),
    ((3, 12), r"^\s*type\s+\w+(?:\[[^\]]{0,500}\])?\s*=", "a `type` statement"),
    ((3, 11), r"^\s*except\s*\*", "`except*`"),
    ((3, 11), r"\[[^][\n]{0,200}(?<=[\[,])\s*\*\w+[^\]\n]{0,200}\]\s*=", "a starred expression in an index"),
)

#: Names that Python has added since 3.10, by the first version that has them.
_ADDED: dict[_Version, str] = {
    (3, 11): "tomllib math.cbrt math.exp2 datetime.UTC enum.StrEnum enum.verify enum.member enum.nonmember "
    "enum.ReprEnum enum.EnumCheck enum.global_enum typing.Self typing.assert_never typing.assert_type "
    "typing.LiteralString typing.Never typing.NotRequired typing.Required typing.Unpack typing.TypeVarTuple "
    "typing.reveal_type typing.dataclass_transform asyncio.TaskGroup asyncio.timeout asyncio.Runner asyncio.Barrier "
    "operator.call contextlib.chdir hashlib.file_digest wsgiref.types ExceptionGroup BaseExceptionGroup "
    "threading.setprofile_all_threads inspect.getmembers_static",
    (3, 12): "itertools.batched math.sumprod typing.override typing.TypeAliasType random.binomialvariate "
    "collections.abc.Buffer sys.monitoring asyncio.eager_task_factory inspect.markcoroutinefunction calendar.Month "
    "calendar.Day types.get_original_bases Path.walk PosixPath.walk os.listdrives",
    (3, 13): "copy.replace warnings.deprecated math.fma queue.ShutDown os.process_cpu_count typing.TypeIs "
    "typing.ReadOnly typing.NoDefault typing.get_protocol_members statistics.kde statistics.kde_random "
    "PythonFinalizationError itertools.batched.strict asyncio.QueueShutDown pathlib.UnsupportedOperation",
    (3, 14): "annotationlib compression string.templatelib concurrent.interpreters functools.Placeholder "
    "heapq.heapify_max heapq.heappush_max heapq.heappop_max operator.is_none operator.is_not_none pathlib.types "
    "concurrent.futures.InterpreterPoolExecutor",
}
_SINCE = {name: version for version, names in _ADDED.items() for name in names.split()}

_LACKS = (
    re.compile(r"ImportError: cannot import name '(?P<name>\w+)' from '(?P<module>[\w.]+)'"),
    re.compile(r"AttributeError: module '(?P<module>[\w.]+)' has no attribute '(?P<name>\w+)'"),
    re.compile(r"AttributeError: (?:type object )?'(?P<module>\w+)' (?:object )?has no attribute '(?P<name>\w+)'"),
    re.compile(r"ModuleNotFoundError: No module named '(?P<module>[\w.]+)'(?P<name>)"),
    re.compile(r"NameError: name '(?P<module>\w+)' is not defined(?P<name>)"),
)


def running() -> _Version:
    """Return the version of this Python, which also runs the students' programs."""
    return sys.version_info[0], sys.version_info[1]


def _in_words(version: _Version) -> str:
    return f"{version[0]}.{version[1]}"


def newer_syntax(source: str) -> tuple[str, ...]:
    """Return which newer Python a program is written for, if this one can't read it; otherwise nothing."""
    try:
        encoded = source.encode()
        if len(encoded) > python_code.LONGEST or not_python(encoded.replace(b"\\\n", b"")):
            return ()
        with python_code.quietly():
            compile(source, "<program>", "exec", dont_inherit=True, flags=python_code.ONLY_AST)
    except SyntaxError as error:
        return _of_error(error, source)
    except (ValueError, RecursionError, MemoryError):
        pass
    return ()


def _of_error(error: SyntaxError, source: str) -> tuple[str, ...]:
    line = error.lineno or 1
    lines = source.splitlines()
    text = lines[line - 1] if line <= len(lines) else ""
    if running() < (3, 12) and ("f-string" in error.msg or re.search(r"""\b[rR]?[fF][rR]?['"].*\{""", text)):
        return (_needs(line, "an f-string with quotes, backslashes or comments inside its braces", (3, 12)),)
    for version, pattern, feature in _SYNTAX:
        if version > running() and re.search(pattern, text):
            return (_needs(line, feature, version),)
    return ()


def _needs(line: int, feature: str, version: _Version) -> str:
    return (
        f"Line {line} has {feature}, which only Python {_in_words(version)} and newer can read. The grader runs Python "
        f"{_in_words(running())}."
    )


def newer_name(message: str) -> str:
    """Return which newer Python has the name that a program did not find, from the error's text; otherwise ""."""
    for pattern in _LACKS:
        if match := pattern.search(message):
            name = ".".join(filter(None, (match["module"], match["name"])))
            version = _SINCE.get(name) or _SINCE.get(match["module"])
            if version and version > running():
                return f"{name} is new in Python {_in_words(version)}. The grader runs Python {_in_words(running())}."
    return ""


def newer_than_this(version: str) -> str:
    """Return a warning if a notebook or a record names a newer Python than this one, such as "3.13.1"; otherwise ""."""
    match = re.match(r"(\d+)\.(\d+)", version)
    if match and (int(match[1]), int(match[2])) > running():
        return f"It was written with Python {match[1]}.{match[2]}. The grader runs Python {_in_words(running())}."
    return ""
