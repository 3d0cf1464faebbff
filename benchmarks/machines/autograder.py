"""The autograder for Classroom 50 or Gradescope in a bare root folder: seconds and bytes of its first grades.

    python benchmarks/machines/autograder.py /srv/bookworm                  as debootstrap makes it, with python3-venv
    python benchmarks/machines/autograder.py /srv/bookworm --gradescope --mbit 100

Needs root. The packages come from an index on this machine, which sends as fast as `--mbit` says (Mbit/s). The grade
must have full marks, and its file the fields of the platform's format; otherwise this ends with 1.
"""

from __future__ import annotations

import argparse
import functools
import json
import os
import resource
import shutil
import subprocess
import sys
import tempfile
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import dataclass
from http.server import SimpleHTTPRequestHandler, ThreadingHTTPServer
from pathlib import Path
from typing import Any, BinaryIO

from packaging.utils import canonicalize_name, parse_wheel_filename
from table import ROOT, mounted

EXERCISE = "joint_velocity"
PIECE = 16384


class Index(SimpleHTTPRequestHandler):
    """Sends a folder's files; all answers together have the server's rate (bytes per second)."""

    server: Line

    def copyfile(self, source: BinaryIO, outputfile: BinaryIO) -> None:  # type: ignore[override]
        """Send a file piece by piece, each when the line is free."""
        while piece := source.read(PIECE):
            self.server.wait_for(len(piece))
            outputfile.write(piece)

    def log_message(self, *_: Any) -> None:
        """Print nothing."""


class Line(ThreadingHTTPServer):
    """A server behind a line of `rate` bytes per second."""

    def __init__(self, folder: Path, rate: float) -> None:
        super().__init__(("127.0.0.1", 0), functools.partial(Index, directory=os.fspath(folder)))
        self.rate, self.sent, self._free, self._lock = rate, 0, 0.0, threading.Lock()

    def wait_for(self, size: int) -> None:
        """Wait until the line has sent this many bytes."""
        with self._lock:
            self.sent += size
            self._free = max(self._free, time.monotonic()) + size / self.rate
            until = self._free
        time.sleep(max(0.0, until - time.monotonic()))


@contextmanager
def index(wheels: Path, rate: float) -> Iterator[Line]:
    """Serve the wheels as a package index (PEP 503)."""
    for wheel in list(wheels.glob("*.whl")):
        page = wheels / "simple" / canonicalize_name(parse_wheel_filename(wheel.name)[0]) / "index.html"
        page.parent.mkdir(parents=True, exist_ok=True)
        page.write_text(f'<a href="/{wheel.name}">{wheel.name}</a>\n')
    with Line(wheels, rate) as line:
        threading.Thread(target=line.serve_forever, daemon=True).start()
        yield line
        line.shutdown()


def main() -> int:
    """Print seconds and bytes; return 1 if a result is not what it must be."""
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("root", type=Path)
    parser.add_argument("--gradescope", action="store_true")
    parser.add_argument("--mbit", type=float, default=50.0)
    options = parser.parse_args()
    root, on = options.root.resolve(), GRADESCOPE if options.gradescope else CLASSROOM50
    with mounted(root):
        lay_out(root, on)
        with index(download(root, on), options.mbit * 1e6 / 8) as line:
            first = [timed(root, line, command) for command in on.first]
            wrong = on.wrong(root)
            kept = size(root / on.place.lstrip("/") / "venv")
            again = timed(root, line, on.again)
    print(
        f"Set-up and first grade: {' + '.join(first)} at {options.mbit:g} Mbit/s, "
        f"{line.sent / 1e6:.1f} MB downloaded, {kept / 1e6:.0f} MB on disk. The next grade: {again}."
    )
    for text in filter(None, (wrong, on.wrong(root))):
        print(text)
    return 1 if wrong or on.wrong(root) else 0


@dataclass(frozen=True)
class Platform:
    """Where a platform puts the bundle and what was handed in, its commands, and its result's fields."""

    command: str
    place: str
    submission: str
    first: tuple[str, ...]
    again: str
    result: str
    fields: tuple[str, ...]

    def wrong(self, root: Path) -> str | None:
        """Say what is wrong with the result."""
        file = root / self.result.lstrip("/")
        if not file.is_file():
            return f"{self.result} was not written."
        result = json.loads(file.read_text())
        tests = result.get("tests", [])
        lacks = [field for field in self.fields if not result.get(field)]
        points = [sum(test.get(field, 0) for test in tests) for field in ("score", "max-score", "max_score")]
        if lacks or not tests or points[0] != points[1] + points[2]:
            return f"{self.result} lacks {lacks}; the points are {points}."
        return None


CLASSROOM50 = Platform(
    "classroom50",
    "/grader",
    "/repository",
    ("cd /repository && python3 /grader/autograder.py",),
    "cd /repository && python3 /grader/autograder.py",
    "/repository/result.json",
    ("schema", "assignment", "commit", "release", "review", "datetime", "score", "max-score"),
)
GRADESCOPE = Platform(
    "gradescope",
    "/autograder/source",
    "/autograder/submission",
    (
        "bash /autograder/source/setup.sh",
        "cp /autograder/source/run_autograder /autograder/ && /autograder/run_autograder",
    ),
    "/autograder/run_autograder",
    "/autograder/results/results.json",
    (),
)


def lay_out(root: Path, on: Platform) -> None:
    """Put the bundle and the solution where the platform puts them."""
    for place in (on.place, on.submission):
        shutil.rmtree(root / place.lstrip("/"), ignore_errors=True)
        (root / place.lstrip("/")).mkdir(parents=True)
    with tempfile.TemporaryDirectory() as folder:
        made = Path(folder, "bundle.zip")
        spinbook = Path(sys.executable).with_name("spinbook")
        subprocess.run([spinbook, on.command, EXERCISE, "--out", made], cwd=ROOT, check=True)
        if made.is_dir():
            shutil.copytree(made, root / on.place.lstrip("/"), dirs_exist_ok=True)
        else:
            subprocess.run(["unzip", "-q", made, "-d", root / on.place.lstrip("/")], check=True)
    shutil.copy(ROOT / "solutions" / EXERCISE / "solution.py", root / on.submission.lstrip("/") / f"{EXERCISE}.py")


def download(root: Path, on: Platform) -> Path:
    """Download what the autograder installs, with the root's own pip and at full speed; return the folder."""
    wheels = root / "wheels"
    options = "-q -d /wheels --no-deps --require-hashes --only-binary :all:"
    files = f"$(printf -- '-r %s ' {on.place}/course/pins*.txt)"
    script = f"python3 -m venv /pip && /pip/bin/pip download {options} {files} && rm -r /pip"
    pip = {name: value for name, value in os.environ.items() if name in ("PIP_CERT", "PIP_INDEX_URL")}
    if not wheels.exists():
        subprocess.run(["chroot", root, "sh", "-c", script], check=True, env={**PLAIN, **pip})
    return wheels


PLAIN = {"PATH": "/usr/local/sbin:/usr/local/bin:/usr/sbin:/usr/bin:/sbin:/bin", "HOME": "/root"}


def timed(root: Path, line: Line, command: str) -> str:
    """Run a command in the root, with the index; return its seconds, and those of CPUs, which a busy machine leaves."""
    address = f"http://127.0.0.1:{line.server_port}/simple"
    environment = {**PLAIN, "PIP_INDEX_URL": address, "PIP_NO_CACHE_DIR": "1", "GITHUB_SHA": "0" * 40}
    start, computed = time.monotonic(), _of_children()
    subprocess.run(["chroot", root, "bash", "-c", command], check=True, env=environment)
    return f"{time.monotonic() - start:.1f} s ({_of_children() - computed:.1f} CPU s)"


def _of_children() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def size(folder: Path) -> int:
    """Return the bytes of the files in a folder."""
    return sum(file.lstat().st_size for file in folder.rglob("*"))


if __name__ == "__main__":
    sys.exit(main())
