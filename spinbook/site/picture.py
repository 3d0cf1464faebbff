"""Pictures for pages: as few bytes as look the same."""

from __future__ import annotations

import base64
import io

from PIL import Image

_COLOURS = 256


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
