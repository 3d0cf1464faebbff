"""What a student's folder remembers of its handout: files as they were handed out, to tell who changed what."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import PurePosixPath

#: Where it is, in the handout and in the student's folder.
BASE = PurePosixPath(".spinbook/base")

#: What students may want to change. Of anything else the handout's is taken.
_REMEMBERED = {".ipynb", ".md", ".py", ".toml", ".txt", ".yml"}


def is_remembered(place: PurePosixPath) -> bool:
    """Whether a file of a handout, by its path in it, is remembered."""
    return place.suffix in _REMEMBERED and place.parts[0] != ".spinbook"


def base_files(handout: Mapping[str, bytes]) -> dict[str, bytes]:
    """What a handout of these files, by name, needs to have in it besides, so that it can be updated one day."""
    return {str(BASE / name): content for name, content in handout.items() if is_remembered(PurePosixPath(name))}
