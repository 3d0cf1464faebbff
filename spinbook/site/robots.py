"""Moving robots on pages: a still picture and the recorded motion, which a script in the page shows."""

from __future__ import annotations

import base64
import io
import json
from collections.abc import Mapping
from html import escape
from importlib.resources import files
from typing import Any

from PIL import Image

from ros_in_python.robot.drawing import KIND
from ros_in_python.robot.still import HEIGHT, WIDTH
from spinbook.build.digest import digest
from spinbook.site.drawings import PICTURE_FOLDER

#: The script that draws robots, as a file of the site.
SCRIPT = "_static/robot_view.js"
_QUALITY = 62
#: A still is shown until the script draws, and on paper: this many of its pixels per CSS pixel are sharp enough.
_SHARPNESS = 4 / 3
#: Transparency has steps of this size: nobody sees them in the soft shadow, which takes a third of the file otherwise.
_STEP = 4


def script() -> bytes:
    """Return the content of `SCRIPT`."""
    return files("ros_in_python.robot").joinpath("robot_view.js").read_bytes()


def is_robot(output: Mapping[str, Any]) -> bool:
    """Return whether an output is a moving robot."""
    return KIND in output.get("data", {})


def robot_still(output: Mapping[str, Any]) -> tuple[str, bytes]:
    """Return the still picture of a robot: its file in the site, and its content, a fifth of the size of a PNG."""
    out = io.BytesIO()
    # With premultiplied opacity, so that what is transparent colours nothing.
    picture = Image.open(io.BytesIO(base64.b64decode(output["data"]["image/png"]))).convert("RGBa")
    size = (round(WIDTH * _SHARPNESS), round(HEIGHT * _SHARPNESS))
    picture = picture.resize(size, Image.Resampling.BILINEAR).convert("RGBA")
    picture.putalpha(picture.getchannel("A").point([alpha - alpha % _STEP for alpha in range(256)]))
    picture.save(out, "WEBP", quality=_QUALITY, method=5)
    return f"{PICTURE_FOLDER}/{digest(out.getvalue())[:16]}.webp", out.getvalue()


def robot_html(output: Mapping[str, Any], root: str, caption: str = "") -> str:
    """Return a robot for a page from which `root` leads to the site's folder. `caption` is HTML."""
    data = dict(output["data"][KIND])
    words = escape(data.pop("words"))
    moves = json.dumps(data, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c")
    source = root + robot_still(output)[0]
    # One with a caption is at the top of its page: it is loaded at once, so that it can be printed.
    late = "" if caption else ' loading="lazy"'
    still = f'<img src="{source}" alt="{words}" width="{WIDTH}" height="{HEIGHT}"{late}>'
    # The script writes below the picture: the place is kept free, so that nothing moves then.
    below = f'<p class="robot-state"></p>{f"<figcaption>{caption}</figcaption>" if caption else ""}'
    return f'<figure class="robot">{still}<script type="application/json">{moves}</script>{below}</figure>'
