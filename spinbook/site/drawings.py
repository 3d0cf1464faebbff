"""Drawings and pictures for pages: renders mermaid diagrams as SVG, and stills moving ones."""

from __future__ import annotations

import base64
import hashlib
import html
import io
import json
import os
import re
import shutil
import subprocess
import tarfile
import tempfile
import urllib.error
import urllib.parse
import urllib.request
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from groundwork.child_process import run_program
from groundwork.files import write_if_changed
from ros_in_python.animation import still
from spinbook.build.digest import digest

# Mermaid comes from npm's registry, with a pinned version and digest, and runs in a headless Chromium.


VERSION = "12.3.0"
#: As printed by `npm view mermaid@12.3.0 dist.integrity`.
INTEGRITY = "sha512-4113TdXeLAsMruJ79OpFL5O8+LTFXhQqZ260rF3tgUmiNAtRm4Uume04I+65PRN6yZ69J4f8rVYWW8zRk65UYw=="
_REGISTRY = "https://registry.npmjs.org"
_SCRIPT = "package/dist/mermaid.min.js"
_BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
_NUMBER = re.compile(r"-?\d+\.\d{2,}(?:e-\d+)?")
_DOWNLOAD_LIMIT_S = 60
_DRAWING_LIMIT_S = 120

_FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'DejaVu Sans', sans-serif"
_LIGHT = {"back": "#e6f2f1", "line": "#0b6b66", "ink": "#14211f", "edge": "#4a5b59", "paper": "#ffffff"}
_DARK = {"back": "#173835", "line": "#66cfc4", "ink": "#eaf4f2", "edge": "#a3b8b5", "paper": "#101817"}


@dataclass(frozen=True)
class Picture:
    """A drawing as two SVGs, for light and for dark pages. `width` and `height` are in CSS pixels."""

    light: str
    dark: str
    width: int
    height: int


class DrawingError(Exception):
    """Raised if mermaid can't draw, for example because there is no Chromium or no network."""


def draw(codes: Sequence[str], cache: Path) -> dict[str, Picture | None]:
    """Return the pictures of these diagrams, by their code; None for one that mermaid can't read.

    Earlier drawings come from `cache`. Raises DrawingError if a new one can't be drawn.
    """
    pictures = {code: _cached(code, cache) for code in codes}
    missing = [code for code, picture in pictures.items() if picture is None]
    if missing:
        for code, pair in zip(missing, _drawn(missing, _script(cache)), strict=True):
            if pair is not None:
                write_if_changed(_file(code, cache), json.dumps(pair))
                pictures[code] = _picture(pair)
    return pictures


def _file(code: str, cache: Path) -> Path:
    return cache / f"{digest(code, VERSION, _FONT, repr(_LIGHT), repr(_DARK), _PAGE)[:32]}.json"


def _cached(code: str, cache: Path) -> Picture | None:
    try:
        return _picture(json.loads(_file(code, cache).read_text(encoding="utf-8")))
    except (OSError, ValueError):
        return None


def _picture(pair: dict[str, str]) -> Picture:
    light, width, height = _sized(pair["light"])
    return Picture(light, _sized(pair["dark"])[0], width, height)


def _sized(svg: str) -> tuple[str, int, int]:
    """Return the SVG with the size of its view box, for use in an `<img>`; and its width and height (px)."""
    box = re.search(r'viewBox="([-\d.]+) ([-\d.]+) ([\d.]+) ([\d.]+)"', svg)
    width, height = (round(float(box.group(3))), round(float(box.group(4)))) if box else (600, 300)
    opening = svg[: svg.index(">")]
    bare = re.sub(r'\s(?:width|height|style|class|role|aria-[\w-]+)="[^"]*"', "", opening)
    # Rounding to a tenth of a pixel is invisible, and makes the file four times smaller.
    body = re.sub(
        r"-?\d+\.\d{2,}(?:e-\d+)?", lambda n: f"{float(n.group()):.1f}".removesuffix(".0"), svg[len(opening) :]
    )
    return f'{bare} width="{width}" height="{height}"{body}', width, height


def _script(cache: Path) -> Path:
    """Return mermaid's script; download it the first time."""
    file = cache / f"mermaid-{VERSION}.min.js"
    if not file.exists():
        registry = next((v for k, v in os.environ.items() if k.lower() == "npm_config_registry" and v), _REGISTRY)
        url = f"{registry.rstrip('/')}/mermaid/-/mermaid-{VERSION}.tgz"
        try:
            with urllib.request.urlopen(url, timeout=_DOWNLOAD_LIMIT_S) as response:
                data: bytes = response.read()
        except (urllib.error.URLError, OSError) as error:
            raise DrawingError(f"mermaid {VERSION} can't be fetched from npm's registry ({error})") from None
        if base64.b64encode(hashlib.sha512(data).digest()).decode() != INTEGRITY.removeprefix("sha512-"):
            raise DrawingError(f"the download from npm's registry is not mermaid {VERSION}: it has another digest")
        with tarfile.open(fileobj=io.BytesIO(data)) as archive:
            member = archive.extractfile(_SCRIPT)
            assert member is not None
            write_if_changed(file, member.read())
    return file


def _drawn(codes: Sequence[str], script: Path) -> list[dict[str, str] | None]:
    browser = next(filter(None, map(shutil.which, _BROWSERS)), None)
    if browser is None:
        raise DrawingError("there is no Chromium (sudo apt-get install chromium)")
    jobs = [{"code": code, "themes": {"light": _theme(_LIGHT), "dark": _theme(_DARK)}} for code in codes]
    with tempfile.TemporaryDirectory(prefix="spinbook-drawing-", ignore_cleanup_errors=True) as folder:
        page = Path(folder, "page.html")
        text = json.dumps(jobs).replace("<", "\\u003c")
        page.write_text(_PAGE.replace("SCRIPT", script.resolve().as_uri()).replace("JOBS", text), encoding="utf-8")
        argv = [browser, "--headless", "--disable-gpu", "--dump-dom", "--virtual-time-budget=60000"]
        argv += [f"--user-data-dir={folder}/profile", *(["--no-sandbox"] if os.geteuid() == 0 else []), page.as_uri()]
        try:
            ran = run_program(argv, _DRAWING_LIMIT_S)
        except (OSError, subprocess.TimeoutExpired) as error:
            raise DrawingError(f"Chromium did not draw ({error})") from None
    drawn = re.search(r"DRAWN:([^<:]*):", ran.stdout)
    if drawn is None:
        raise DrawingError("Chromium showed no drawing")
    results: list[dict[str, str] | None] = json.loads(urllib.parse.unquote(drawn.group(1)))
    return results


def _theme(colours: dict[str, str]) -> dict[str, Any]:
    back, line, ink, edge = colours["back"], colours["line"], colours["ink"], colours["edge"]
    return {
        "background": "transparent",
        "fontFamily": _FONT,
        "fontSize": "15px",
        "primaryColor": back,
        "primaryBorderColor": line,
        "primaryTextColor": ink,
        "lineColor": edge,
        "textColor": ink,
        "clusterBkg": "transparent",
        "clusterBorder": edge,
        # The colour of the page (--paper in site.css), so that arrows do not cross their labels.
        "edgeLabelBackground": colours["paper"],
        "useGradient": False,
        "dropShadow": "none",
    }


#: The page in which mermaid draws. In the end, its text is the result.
_PAGE = """<!DOCTYPE html><meta charset="utf-8"><body><script src="SCRIPT"></script><script>
const jobs = JOBS;
(async () => {
  const results = [];
  for (const [index, job] of jobs.entries()) {
    const drawn = {};
    try {
      for (const [name, themeVariables] of Object.entries(job.themes)) {
        mermaid.initialize({startOnLoad: false, securityLevel: "strict", theme: "base", themeVariables,
          look: "classic", layout: "dagre", deterministicIds: true, htmlLabels: false,
          flowchart: {htmlLabels: false, wrappingWidth: 400, nodeSpacing: 24, rankSpacing: 48, curve: "basis"}});
        drawn[name] = (await mermaid.render(`drawing-${index}-${name}`, job.code)).svg;
      }
      results.push(drawn);
    } catch (error) { results.push(null); }
  }
  document.body.textContent = "DRAWN:" + encodeURIComponent(JSON.stringify(results)) + ":";
})();
</script></body>"""


FOLDER = "_drawings"
#: A drawing wider than this (px) would be unreadable if it were scaled down to a phone: there, it scrolls.
_WIDE = 640
#: A node of a flowchart: A(["left toe"]), A["/topic"], A{{…}} or a bare A.
_NODE = r"""(?P<{0}>\w+)(?:[(\[{{<>]+\s*"?(?P<{0}_label>[^"\])}}]*)"?\s*[)\]}}]+)?"""
_LINK = r"""\s*(?:<?[-=.]+(?:\s*"?(?P<on>[^"|>-]+)"?\s*[-=.]+)?>?(?:\|(?P<label>[^|]*)\|)?)\s*"""
_EDGE = re.compile(_NODE.format("start") + _LINK + _NODE.format("end"))
_SAYS = re.compile(r"^\s*acc(?:Title|Descr)\s*:\s*(.+)$", re.MULTILINE)


def in_words(code: str) -> str:
    """Return a drawing in words, for readers who can't see it: its own accDescr, otherwise its edges.

    Returns "" if it is not a flowchart, or if its edges can't be read.
    """
    if titles := _SAYS.findall(code):
        return ". ".join(line.strip().rstrip(".") for line in titles) + "."
    steps = [f"{start} to {end}" for start, end in _edges(code)]
    return f"Drawing: {'; '.join(steps)}." if steps else ""


def _edges(code: str) -> Iterator[tuple[str, str]]:
    labels: dict[str, str] = {}
    edges: list[tuple[str, str]] = []
    for line in code.splitlines():
        match = _EDGE.search(line)
        if not match:
            continue
        for end in ("start", "end"):
            if match.group(f"{end}_label"):
                labels[match.group(end)] = match.group(f"{end}_label").strip()
        edges.append((match.group("start"), match.group("end")))
    for start, end in edges:
        yield labels.get(start, start), labels.get(end, end)


def drawing_files(code: str, picture: Picture) -> dict[str, str]:
    """Return the files of a drawing: path in the site -> SVG."""
    return {_path(code, "light"): picture.light, _path(code, "dark"): picture.dark}


def drawing_html(code: str, picture: Picture | None, root: str) -> str:
    """Return a drawing as one line of HTML, for a page from which `root` leads to the site's folder."""
    words = html.escape(in_words(code))
    if picture is None:
        return _without_picture(code)
    wide = " drawing-wide" if picture.width > _WIDE else ""
    size = f'width="{picture.width}" height="{picture.height}" loading="lazy"'
    images = "".join(
        f'<img class="only-{theme}" src="{root}{_path(code, theme)}" alt="{words or "Drawing"}" {size}>'
        for theme in ("light", "dark")
    )
    return f'<figure class="drawing{wide}">{images}</figure>'


def _without_picture(code: str) -> str:
    edges = list(_edges(code))
    if not edges:
        lines = "&#10;".join(html.escape(line) for line in code.splitlines() if line.strip())
        return f'<pre class="drawing-code" tabindex="0">{lines}</pre>'
    items = "".join(f"<li>{html.escape(start)} → {html.escape(end)}</li>" for start, end in edges)
    return f'<ul class="drawing-words">{items}</ul>'


def _path(code: str, theme: str) -> str:
    return f"{FOLDER}/{digest(code)[:16]}-{theme}.svg"


PICTURE_FOLDER = "_pictures"


@dataclass(frozen=True)
class StillPicture:
    """Replaces a moving picture in print, and for readers who prefer no motion. `path` is its file in the site.

    Browsers do not apply print and reduced-motion media queries to an SVG in an `<img>`, so the page has to switch.
    """

    path: str
    data: bytes


def still_of(output: Mapping[str, Any]) -> StillPicture | None:
    """Return the still picture of a moving output; None for any other."""
    moving = "".join(output.get("data", {}).get("image/svg+xml", ""))
    svg = still(moving)
    return StillPicture(f"{PICTURE_FOLDER}/{digest(svg)[:16]}.svg", svg.encode()) if svg != moving else None
