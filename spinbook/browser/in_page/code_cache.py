"""Hands the code that one process of a page has compiled to the next, which reads it in a tenth of that time.

The archives have sources: a page's Python is another version than the one that makes the site.
"""

from __future__ import annotations

import marshal
import zipimport
import zlib
from collections.abc import Callable
from types import CodeType

_Key = tuple[str, int]

_compile: Callable[[str, bytes], CodeType] = zipimport._compile_source  # type: ignore[attr-defined]
_kept: dict[_Key, bytes] = {}


def keep() -> None:
    """Keep all code that is compiled from archives from now on."""

    def compile_and_keep(path: str, source: bytes) -> CodeType:
        code = _compile(path, source)
        _kept[_key(path, source)] = marshal.dumps(code)
        return code

    zipimport._compile_source = compile_and_keep  # type: ignore[attr-defined]


def kept() -> bytes:
    """Return what was kept, and keep no more."""
    zipimport._compile_source = _compile  # type: ignore[attr-defined]
    return marshal.dumps(_kept)


def use(given: bytes | memoryview) -> None:
    """Compile nothing that another process has kept: `given` is what its `kept` has returned."""
    known: dict[_Key, bytes] = marshal.loads(given)

    def read_or_compile(path: str, source: bytes) -> CodeType:
        code = known.get(_key(path, source))
        return _compile(path, source) if code is None else marshal.loads(code)

    zipimport._compile_source = read_or_compile  # type: ignore[attr-defined]


def _key(path: str, source: bytes) -> _Key:
    # A site may be made anew while its page is open: then the same file has another text.
    return path, zlib.crc32(source)
