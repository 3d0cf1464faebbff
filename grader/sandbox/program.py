"""What is started in a sandbox: a student's files, how they are run, where they lie, and what they may see."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path, PurePosixPath

from .middleware import Middleware

SUBMISSION = "/submission"
HUB = "/run/lockstep/hub"


@dataclass(frozen=True)
class Program:
    """A student's program.

    Attributes:
        main: the Python file to run as `__main__`: a name in `files`, or an absolute path inside one of `readonly`
            (the executable of an installed package).
        files: name to content, written into the read-only folder /submission. Contents and not paths, so that neither a
            symlink nor a change made meanwhile can show the program another file of this machine.
        arguments: what follows the file's name in sys.argv.
        environment: variables beyond those that Python and ROS 2 need; nothing of the caller's own is passed on.
        readonly: files and folders of this machine that are to be seen, read-only, at the same path.
        hidden: files and folders of this machine that are never seen, also inside one that is.
        hub: the socket of the hub that each of its processes connects to, over rmw_lockstep; alone in a folder that
            belongs to the caller. The program then has no network at all. None: it uses Fast DDS, in the network of the
            calling process.
        warm: run in a fork of the nursery, in which rclpy has been imported already. Otherwise in a new Python process.
    """

    main: str
    files: Mapping[str, bytes] = field(default_factory=dict)
    arguments: tuple[str, ...] = ()
    environment: Mapping[str, str] = field(default_factory=dict)
    readonly: tuple[Path, ...] = ()
    hidden: tuple[Path, ...] = ()
    warm: bool = True
    hub: Path | None = None

    def __post_init__(self) -> None:
        """Refuses what could leave the submission's folder or does not exist in it.

        Raises:
            ValueError: for a file name with a folder or a NUL in it, or a main file that is nowhere.
        """
        for name in self.files:
            if name in ("", ".", "..") or "/" in name or "\0" in name:
                raise ValueError(f"{name!r} is not a plain file name")
        absolute = PurePosixPath(self.main).is_absolute()
        if not absolute and self.main not in self.files:
            raise ValueError(f"the main file {self.main!r} is not among the files: {', '.join(self.files) or 'none'}")
        if absolute and not any(Path(self.main).is_relative_to(shown) for shown in self.readonly):
            raise ValueError(f"the main file {self.main} lies in none of the readonly folders")

    @property
    def middleware(self) -> Middleware:
        """Over which it talks."""
        return Middleware.LOCKSTEP if self.hub else Middleware.FASTDDS


@dataclass(frozen=True)
class Place:
    """The folders of a student's program, as it sees them: its files, its home, for temporary files; and its hub."""

    folder: str
    home: str
    temporary: str
    hub: str | None = None
