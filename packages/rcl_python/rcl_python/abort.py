"""How a program ends within C code, at an assertion that does not hold: at once, whatever it would catch."""

from __future__ import annotations

import os
import sys
from collections.abc import Callable


def _end_process(text: str) -> None:
    print(text, file=sys.stderr, flush=True)
    os.abort()


end: Callable[[str], None] = _end_process
"""Ends the program with this message. If a program is not a process of its own, something else is put here."""


def require_class(value: object, package: str, name: str) -> None:
    """End the program if `value` is not a message `name` of this package, as the generated C code does."""
    if type(value).__name__ != name:
        function = f"{package}__convert_from_py"
        end(f'{function}: Assertion `strncmp("{package}.{name}", full_classname_dest, {len(name)}) == 0\' failed.')
