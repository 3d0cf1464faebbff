"""Passes the code that one process of a page has compiled to the next, which loads it ten times faster.

The archives contain source code only: the page's Python has another version than the one that builds the site.
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
    """Return the code that was kept, and stop keeping."""
    zipimport._compile_source = _compile  # type: ignore[attr-defined]
    return marshal.dumps(_kept)


def use(cache: bytes | memoryview) -> None:
    """Load what another process has compiled, and compile the rest. `cache` is what `kept` returned there."""
    known: dict[_Key, bytes] = marshal.loads(cache)

    def read_or_compile(path: str, source: bytes) -> CodeType:
        code = known.get(_key(path, source))
        return _compile(path, source) if code is None else marshal.loads(code)

    zipimport._compile_source = read_or_compile  # type: ignore[attr-defined]


def _key(path: str, source: bytes) -> _Key:
    # The site may be rebuilt while its page is open: then the same path has another text.
    return path, zlib.crc32(source)
