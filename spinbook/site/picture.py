"""Pictures for pages: as few bytes as look the same."""

from __future__ import annotations

import base64
import io
from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from PIL import Image

from spinbook.build.digest import digest

FOLDER = "_pictures"

_COLOURS = 256


@dataclass(frozen=True)
class Still:
    """What stands for a moving picture in print, and for readers who prefer no motion. `path` is its file in the site.

    An SVG in an `<img>` is not told by browsers that it is printed, or that motion is not wanted: its page has to be.
    """

    path: str
    data: bytes


def still_of(output: Mapping[str, Any]) -> Still | None:
    """The still of an output that moves: one that has an SVG and a PNG of the same."""
    data = output.get("data", {})
    if not {"image/svg+xml", "image/png"} <= set(data):
        return None
    png = base64.b64decode(smaller(data["image/png"]))
    return Still(f"{FOLDER}/{digest(png)[:16]}.png", png)


def smaller(png: str) -> str:
    """A PNG, in base64, with a palette in place of full colour where that makes it smaller.

    Plots and turtles have few colours, so that nothing is lost that an eye could see.
    """
    data = base64.b64decode(png)
    image = Image.open(io.BytesIO(data)).convert("RGBA")
    if image.getchannel("A").getextrema() == (255, 255):
        image = image.convert("RGB")
        reduced = image.quantize(_COLOURS, method=Image.Quantize.MEDIANCUT, dither=Image.Dither.NONE)
    else:
        reduced = image.quantize(_COLOURS, method=Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
    out = io.BytesIO()
    reduced.save(out, "PNG", optimize=True)
    best = min(out.getvalue(), data, key=len)
    return base64.b64encode(best).decode("ascii")
