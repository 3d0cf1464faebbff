"""Shows the site while its author writes: each saved file builds it again, and the browser loads it again."""

from __future__ import annotations

import mimetypes
import re
import subprocess
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import click
from livereload import Server

from spinbook.course.course import FILE, Course

_HOST = "127.0.0.1"
#: What reloads the page is a script in the page itself, which the published site's policy forbids.
_POLICY = re.compile(rb'<meta http-equiv="Content-Security-Policy"[^>]*>\n?')

Start = Callable[[str, list[tuple[str, str]]], Any]


def serve_site(course: Course, port: int, no_run: bool) -> None:
    """Build the site, show it, and build it again on each save, until Ctrl-C."""
    argv = [sys.executable, "-m", "spinbook", "site", "--course", str(course.root), *(["--no-run"] if no_run else [])]

    def build() -> None:
        # A process of its own each time: what an author has broken for one build is fixed for the next.
        subprocess.run(argv, check=False)

    build()
    server = Server(pages_of(course.build_folder / "site"))
    for place in map(str, (FILE, "chapters", "exercises", "solutions", *course.chapters, course.glossary or FILE)):
        server.watch(str(course.root / place), build)
    click.echo(f"The site is at http://{_HOST}:{port} and follows what you save. Ctrl-C ends it.")
    server.serve(port=port, host=_HOST, debug=False)


def pages_of(site: Path) -> Callable[[dict[str, Any], Start], Iterable[bytes]]:
    """A WSGI application that shows the files of `site`: https://peps.python.org/pep-3333/."""

    def answer(environ: dict[str, Any], start: Start) -> Iterable[bytes]:
        asked = str(environ.get("PATH_INFO", "/")).lstrip("/") or "index.html"
        file = (site / asked).resolve()
        if not file.is_relative_to(site.resolve()) or not file.is_file():
            start("404 Not Found", [("Content-Type", "text/plain; charset=utf-8")])
            return [b"There is no such page."]
        kind = mimetypes.guess_type(file.name)[0] or "application/octet-stream"
        data = file.read_bytes()
        if kind == "text/html":
            kind, data = "text/html; charset=utf-8", _POLICY.sub(b"", data)
        start("200 OK", [("Content-Type", kind), ("Content-Length", str(len(data))), ("Cache-Control", "no-store")])
        return [data]

    return answer
