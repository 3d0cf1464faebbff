"""Says why Python can't read a file, if Python's own message is unclear or Python would run out of memory."""

from __future__ import annotations

import re

#: The byte order marks of UTF-16 (Unicode 15, chapter 23.8, "Byte Order Mark").
UTF_16 = (b"\xff\xfe", b"\xfe\xff")


#: What is handed in under a wrong name, by its first bytes, and what to do.
_HAND_IN = "Hand in your code as a .py file or a notebook."
_OTHER_KINDS = {
    rb"\s*<(?i:!doctype|html)\b": ("a web page", "Download the file itself: on GitHub, with Download raw file."),
    rb"\{\\rtf": ("rich text", "Save it as plain text: in TextEdit, choose Format > Make Plain Text."),
    rb"%PDF-": ("a PDF document", _HAND_IN),
    rb"\xd0\xcf\x11\xe0": ("a document of an office program", _HAND_IN),
    rb"\x89PNG|\xff\xd8\xff|GIF8": ("a picture", _HAND_IN),
    rb"\x7fELF|MZ.{0,200}\0": ("a compiled program", _HAND_IN),
    rb"..\r\n[\0-\3]\0\0\0": ("Python's compiled code", "Hand in the .py file that you wrote."),
}


def text_of(code: bytes) -> str:
    """Return a file's text without its byte order mark: UTF-8, or UTF-16 if it begins with such a mark."""
    return code.decode("utf-16" if code.startswith(UTF_16) else "utf-8-sig", errors="replace")


def other_kind(content: bytes) -> str:
    """Return what a file is that is neither Python nor a notebook nor an archive, and what to do; "" if not known."""
    for start, (kind, todo) in _OTHER_KINDS.items():
        if re.match(start, content, re.DOTALL):
            return f"Your file is {kind}, not Python. {todo}"
    return ""


def not_python(code: bytes) -> str:
    """Return why Python can't read a file, if Python's own message is unclear; otherwise an empty text."""
    if code.startswith(UTF_16):
        return (
            "Your file is saved as UTF-16, which Python can't read. Save it as UTF-8: in VS Code, click UTF-16 below."
        )
    if problem := other_kind(code):
        return problem
    if b"\0" in code:
        line = code[: code.index(b"\0")].count(b"\n") + 1
        return (
            f"Line {line} of your file contains a NUL byte, so it is not a text file. Save your code as text, in UTF-8."
        )
    deepest = max(map(_nested, code.splitlines()), default=0)
    if deepest > DEEPEST:
        return f"A line of your file nests {deepest:,} operators or brackets. Python can't read such deep nesting."
    return ""


#: Python's parser gives up, or takes all memory, at some thousands (CPython, Parser/parser.c, MAXSTACK).
DEEPEST = 5_000


#: Text in quotes, up to the end of the line if they are not closed. The alternatives exclude each other, so that
#: a line of backslashes does not take exponential time.
_QUOTED = re.compile(rb"""(['"])(?:\\.|(?!\1)[^\\])*(?:(?P<end>\1)|\\?$)""", re.DOTALL)


def _nested(line: bytes) -> int:
    """Return about how deeply the expressions of a line are nested; text in quotes is left out."""
    if len(line) <= DEEPEST:
        return 0
    bare = _QUOTED.sub(lambda quoted: b"" if quoted["end"] else quoted[0], line)
    depth = deepest = 0
    for bracket in re.findall(rb"[([{)\]}]", bare):
        depth += 1 if bracket in b"([{" else -1
        deepest = max(deepest, depth)
    operators = (len(re.findall(rb"[-+~*/%@&|^]|\bnot\b", part)) for part in re.split(rb"[,:()\[\]{}]", bare))
    return deepest + max(operators, default=0)
