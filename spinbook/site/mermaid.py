"""Draws mermaid's diagrams as pictures, once, while the site is built: no page loads mermaid.

Mermaid comes from npm's registry, in one version and with one digest, and runs in a Chromium without a window.
"""

from __future__ import annotations

import base64
import hashlib
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
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from spinbook.build.digest import digest
from spinbook.written import write_if_changed

VERSION = "12.3.0"
#: As `npm view mermaid@12.3.0 dist.integrity` tells it.
INTEGRITY = "sha512-4113TdXeLAsMruJ79OpFL5O8+LTFXhQqZ260rF3tgUmiNAtRm4Uume04I+65PRN6yZ69J4f8rVYWW8zRk65UYw=="
_REGISTRY = "https://registry.npmjs.org"
_SCRIPT = "package/dist/mermaid.min.js"
_BROWSERS = ("chromium", "chromium-browser", "google-chrome", "google-chrome-stable")
_NUMBER = re.compile(r"-?\d+\.\d{2,}(?:e-\d+)?")
_DOWNLOAD_PATIENCE_S = 60
_DRAWING_PATIENCE_S = 120

_FONT = "system-ui, -apple-system, 'Segoe UI', Roboto, 'DejaVu Sans', sans-serif"
_LIGHT = {"back": "#e6f2f1", "line": "#0b6b66", "ink": "#14211f", "edge": "#4a5b59"}
_DARK = {"back": "#173835", "line": "#66cfc4", "ink": "#eaf4f2", "edge": "#a3b8b5"}


@dataclass(frozen=True)
class Picture:
    """A drawing as two SVGs, for light and for dark pages. `width` and `height` are in CSS pixels."""

    light: str
    dark: str
    width: int
    height: int


class CanNotDrawError(Exception):
    """Raised where there is no Chromium, or where mermaid can't be had; says which."""


def draw(codes: Sequence[str], cache: Path) -> dict[str, Picture | None]:
    """The pictures of these diagrams, by their code; None for one that mermaid can't read.

    What was drawn before is taken from `cache`. Raises CanNotDrawError when a new one can't be drawn.
    """
    wanted = dict.fromkeys(codes)
    found = {code: _remembered(code, cache) for code in wanted}
    missing = [code for code in wanted if found[code] is None]
    if missing:
        for code, pair in zip(missing, _drawn(missing, _script(cache)), strict=True):
            if pair is not None:
                write_if_changed(_file(code, cache), json.dumps(pair))
                found[code] = _picture(pair)
    return found


def _file(code: str, cache: Path) -> Path:
    return cache / f"{digest(code, VERSION, _FONT, repr(_LIGHT), repr(_DARK), _PAGE)[:32]}.json"


def _remembered(code: str, cache: Path) -> Picture | None:
    try:
        return _picture(json.loads(_file(code, cache).read_text(encoding="utf-8")))
    except (OSError, ValueError):
        return None


def _picture(pair: dict[str, str]) -> Picture:
    light, width, height = _sized(pair["light"])
    return Picture(light, _sized(pair["dark"])[0], width, height)


def _sized(svg: str) -> tuple[str, int, int]:
    """The SVG with the size of its view box, as a picture of its own needs it."""
    box = re.search(r'viewBox="([-\d.]+) ([-\d.]+) ([\d.]+) ([\d.]+)"', svg)
    width, height = (round(float(box.group(3))), round(float(box.group(4)))) if box else (600, 300)
    opening = svg[: svg.index(">")]
    bare = re.sub(r'\s(?:width|height|style|class|role|aria-[\w-]+)="[^"]*"', "", opening)
    # A tenth of a pixel is as near as anybody sees, and makes the file four times smaller.
    body = re.sub(
        r"-?\d+\.\d{2,}(?:e-\d+)?", lambda n: f"{float(n.group()):.1f}".removesuffix(".0"), svg[len(opening) :]
    )
    return f'{bare} width="{width}" height="{height}"{body}', width, height


def _script(cache: Path) -> Path:
    """mermaid's script, from the registry the first time."""
    file = cache / f"mermaid-{VERSION}.min.js"
    if not file.exists():
        registry = next((v for k, v in os.environ.items() if k.lower() == "npm_config_registry" and v), _REGISTRY)
        url = f"{registry.rstrip('/')}/mermaid/-/mermaid-{VERSION}.tgz"
        try:
            with urllib.request.urlopen(url, timeout=_DOWNLOAD_PATIENCE_S) as answer:
                data: bytes = answer.read()
        except (urllib.error.URLError, OSError) as error:
            raise CanNotDrawError(f"mermaid {VERSION} can't be fetched from npm's registry ({error})") from None
        if base64.b64encode(hashlib.sha512(data).digest()).decode() != INTEGRITY.removeprefix("sha512-"):
            raise CanNotDrawError(f"what npm's registry sent is not mermaid {VERSION}: its digest is another")
        with tarfile.open(fileobj=io.BytesIO(data)) as archive:
            member = archive.extractfile(_SCRIPT)
            assert member is not None
            write_if_changed(file, member.read())
    return file


def _drawn(codes: Sequence[str], script: Path) -> list[dict[str, str] | None]:
    browser = next(filter(None, map(shutil.which, _BROWSERS)), None)
    if browser is None:
        raise CanNotDrawError("there is no Chromium (sudo apt-get install chromium)")
    jobs = [{"code": code, "themes": {"light": _theme(_LIGHT), "dark": _theme(_DARK)}} for code in codes]
    with tempfile.TemporaryDirectory(prefix="spinbook-drawing-", ignore_cleanup_errors=True) as folder:
        page = Path(folder, "page.html")
        text = json.dumps(jobs).replace("<", "\\u003c")
        page.write_text(_PAGE.replace("SCRIPT", script.resolve().as_uri()).replace("JOBS", text), encoding="utf-8")
        argv = [browser, "--headless", "--disable-gpu", "--dump-dom", "--virtual-time-budget=60000"]
        argv += [f"--user-data-dir={folder}/profile", *(["--no-sandbox"] if os.geteuid() == 0 else []), page.as_uri()]
        try:
            ran = subprocess.run(argv, capture_output=True, text=True, timeout=_DRAWING_PATIENCE_S)
        except (OSError, subprocess.TimeoutExpired) as error:
            raise CanNotDrawError(f"Chromium did not draw ({error})") from None
    answer = re.search(r"DRAWN:([^<:]*):", ran.stdout)
    if answer is None:
        raise CanNotDrawError("Chromium showed no drawing")
    results: list[dict[str, str] | None] = json.loads(urllib.parse.unquote(answer.group(1)))
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
        "edgeLabelBackground": "transparent",
        "useGradient": False,
        "dropShadow": "none",
    }


#: The page in which mermaid draws: its text is the answer when all is done.
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
