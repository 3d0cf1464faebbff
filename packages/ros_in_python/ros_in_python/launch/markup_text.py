"""Substitutions in texts of YAML and XML launch files: `$(var gain)`, `$(find-pkg-share arm)/config`, nested too."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from ros_in_python.launch import conditions, places, substitutions
from ros_in_python.launch.substitutions import Text, TextSubstitution
from ros_in_python.ros2.cli import CommandError


def parse(text: str) -> Text:
    """Return a text with its substitutions. Raises `CommandError` for one that is not known or not closed."""
    reader = _MarkupReader(text)
    parts = reader.parts(until="")
    return parts[0] if len(parts) == 1 and isinstance(parts[0], str) else parts


class _MarkupReader:
    """Reads a text from left to right."""

    def __init__(self, text: str) -> None:
        self._text, self._at = text, 0

    def parts(self, until: str) -> list[Any]:
        """Return texts and substitutions up to one of these characters, or to the end."""
        found: list[Any] = [""]
        while self._at < len(self._text) and not (until and self._text[self._at] in until):
            if self._text.startswith("$(", self._at):
                found += [self._substitution(), ""]
            else:
                if self._text[self._at : self._at + 1] == "\\" and self._at + 1 < len(self._text):
                    self._at += 1  # the next character is meant as it is
                found[-1] += self._text[self._at]
                self._at += 1
        return [part for part in found if part != ""] or [""]

    def _substitution(self) -> Any:
        begin = self._at
        self._at += 2
        words = self._words()
        if self._at >= len(self._text):
            raise CommandError(f"`{self._text[begin:]}` has no closing parenthesis")
        self._at += 1
        return _made(words, self._text[begin : self._at])

    def _words(self) -> list[list[Any]]:
        words = []
        while self._skip_spaces() and self._text[self._at] != ")":
            words.append(self._word())
        return words

    def _skip_spaces(self) -> bool:
        while self._at < len(self._text) and self._text[self._at].isspace():
            self._at += 1
        return self._at < len(self._text)

    def _word(self) -> list[Any]:
        quote = self._text[self._at]
        if quote not in "'\"":
            return self.parts(until=" \t\n)")
        self._at += 1
        found = self.parts(until=quote)
        self._at += 1
        return found


#: Name -> how many words come after it (at least and at most), and what it is.
_KNOWN: dict[str, tuple[int, int, Callable[..., Any]]] = {
    "var": (1, 2, lambda name, default=None: substitutions.LaunchConfiguration(name, default=default)),
    "env": (1, 2, lambda name, default=None: substitutions.EnvironmentVariable(name, default_value=default)),
    "optenv": (1, 2, lambda name, default="": substitutions.EnvironmentVariable(name, default_value=default)),
    "find-pkg-share": (1, 1, places.FindPackageShare),
    "find-pkg-prefix": (1, 1, places.FindPackagePrefix),
    "exec-in-pkg": (2, 2, places.ExecutableInPackage),
    "find-exec": (1, 1, lambda name: places.FindExecutable(name=name)),
    "dirname": (0, 0, places.ThisLaunchFileDir),
    "filename": (0, 0, places.ThisLaunchFile),
    "anon": (1, 1, substitutions.AnonName),
    "file-content": (1, 1, places.FileContent),
    "param": (1, 2, lambda name, default=None: substitutions.GlobalParameter(name, default=default)),
    "command": (1, 2, lambda line, on_stderr="fail": substitutions.CommandOutput(line, on_stderr=on_stderr)),
    "equals": (2, 2, conditions.EqualsSubstitution),
    "not-equals": (2, 2, conditions.NotEqualsSubstitution),
    "not": (1, 1, conditions.NotSubstitution),
    "and": (2, 2, conditions.AndSubstitution),
    "or": (2, 2, conditions.OrSubstitution),
    "any": (1, 99, conditions.AnySubstitution),
    "all": (1, 99, conditions.AllSubstitution),
    "if": (1, 3, conditions.IfElseSubstitution),
}


def _made(words: list[list[Any]], text: str) -> Any:
    name, rest = "".join(map(str, words[0])) if words else "", words[1:]
    if name == "eval" and rest:
        return substitutions.PythonExpression([part for word in rest for part in (*word, " ")])
    least, most, make = _KNOWN.get(name, (0, -1, TextSubstitution))
    if least <= len(rest) <= most:
        return make(*rest)
    there = ", ".join(f"$({known})" for known in (*_KNOWN, "eval"))
    problem = "has too many or too few words" if name in _KNOWN else "is not supported here"
    raise CommandError(f"`{text}` {problem}. There is: {there}.")
