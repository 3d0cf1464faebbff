"""`spinbook site`: the course's website; `--serve` shows it while its author writes.

With --serve, each save rebuilds the site and reloads the browser.
"""

from __future__ import annotations

import mimetypes
import os
import re
import subprocess
import sys
from collections.abc import Callable, Iterable
from pathlib import Path
from typing import Any

import click
from rich.console import Console

from groundwork.problem import AuthorError
from spinbook.course.course import FILE, Course, find_course
from spinbook.site.build import Site, build_site, unchanged_site


@click.command()
@click.option("--course", "start", type=click.Path(path_type=Path), default=".", help="The course's folder.")
@click.option("--no-run", is_flag=True, help="Run no notebook: show the existing outputs, even if they are old.")
@click.option("--strict", is_flag=True, help="Stop if a cell fails, or if code is shown but not run.")
@click.option("--serve", is_flag=True, help="Serve the site, and rebuild it whenever a file is saved.")
@click.option("--port", type=click.IntRange(1, 65535), default=8000, show_default=True, help="Where --serve listens.")
def site(start: Path, no_run: bool, strict: bool, serve: bool, port: int) -> None:
    """Make the course's website in build/site/.

    Real nodes produce every output on it: a chapter whose code has changed since it ran is run first, as with
    `spinbook build --execute`. Only changed pages are rebuilt.

    \b
      spinbook site                    build/site/index.html, to open in any browser
      spinbook site --serve            while you write: http://127.0.0.1:8000
      spinbook site --serve --no-run   the same, without waiting for nodes when code changes

    You can copy the folder to any web server, or open it without one. Next to it, build/launch/ has the notebooks that
    Colab, Binder and Codespaces open: push it to the branch `notebooks` (docs/site.md).

    The site shows how a cell failed. With --strict, for the CI of your own course, a failed cell stops the build.

    Exit code: 0 the site is built, 1 something must be fixed first; the last successful site is then unchanged.
    """
    course = find_course(start)
    console = Console(soft_wrap=True, highlight=False)
    if serve:
        serve_site(course, port, no_run)
        return
    before = unchanged_site(course, as_it_ran=no_run)
    if before is not None:
        _report(console, before)
        return
    # Imported here, as an unchanged site needs no notebooks.
    from spinbook.site.notebooks import bring_up_to_date

    if not bring_up_to_date(course, console, is_strict=strict, run=not no_run):
        console.print("The site was not built. Fix the errors above first.", style="red")
        sys.exit(1)
    try:
        with console.status("Making the pages …") as status:
            built = build_site(course, lambda page: status.update(f"Making the pages: {page}"), as_it_ran=no_run)
    except AuthorError as error:
        for problem in error.problems:
            console.print(str(problem), markup=False, style="red")
        console.print("The site was not built.")
        sys.exit(1)
    _report(console, built)


def _report(console: Console, built: Site) -> None:
    for problem in built.problems:
        console.print(str(problem), markup=False)
    if built.fresh:
        console.print(f"{built.pages} pages, {len(built.made)} made in {built.seconds:.1f} s")
    else:
        console.print(f"{built.pages} pages, unchanged")
    console.print(f"Site: {os.path.relpath(built.folder)}/index.html", markup=False)


_HOST = "127.0.0.1"
#: The policy of the published site, which would forbid the script that reloads the page.
_POLICY = re.compile(rb'<meta http-equiv="Content-Security-Policy"[^>]*>\n?')

StartResponse = Callable[[str, list[tuple[str, str]]], Any]


def serve_site(course: Course, port: int, no_run: bool) -> None:
    """Build the site, serve it, and rebuild it on each save, until Ctrl-C."""
    from livereload import Server

    argv = [sys.executable, "-m", "spinbook", "site", "--course", str(course.root), *(["--no-run"] if no_run else [])]

    def build() -> None:
        # A new process each time, so that each build starts from a clean state, whatever happened to the last one.
        subprocess.run(argv, check=False)

    build()
    server = Server(pages_of(course.build_folder / "site"))
    for watched in map(str, (FILE, "chapters", "exercises", "solutions", *course.chapters, course.glossary or FILE)):
        server.watch(str(course.root / watched), build)
    click.echo(f"The site is at http://{_HOST}:{port} and is rebuilt on each save. Press Ctrl-C to stop.")
    server.serve(port=port, host=_HOST, debug=False)


def pages_of(site: Path) -> Callable[[dict[str, Any], StartResponse], Iterable[bytes]]:
    """Return a WSGI application that serves the files of `site`: https://peps.python.org/pep-3333/."""

    def answer(environ: dict[str, Any], start: StartResponse) -> Iterable[bytes]:
        path = str(environ.get("PATH_INFO", "/")).lstrip("/") or "index.html"
        file = (site / path).resolve()
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
