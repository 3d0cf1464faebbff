"""Moving pictures as SVG and CSS, without script; in print, and for readers who prefer no motion, the last frame."""

from __future__ import annotations

import re
from collections.abc import Iterable
from dataclasses import dataclass
from html import escape

#: An animation begins and ends with a pause (s), so that readers find the start and see the whole.
BEFORE_S, AFTER_S = 0.4, 2.6


@dataclass(frozen=True)
class Cycle:
    """`moving_s` seconds of motion between two pauses, repeated. The names of all classes and animations begin with
    `key`, because a page may have several pictures.
    """

    key: str
    moving_s: float

    @property
    def whole_s(self) -> float:
        """The cycle with its pauses (s)."""
        return BEFORE_S + self.moving_s + AFTER_S

    def keyframes(self, name: str, frames: Iterable[tuple[float, str]]) -> str:
        """Return CSS that animates the class `key` + `name`; `frames` are times (s of the motion) and declarations.

        Between two of them CSS moves steadily; before the first and after the last it pauses.
        """
        at = {coord(100 * (BEFORE_S + seconds) / self.whole_s, 2): declaration for seconds, declaration in frames}
        first, last = next(iter(at.values())), list(at.values())[-1]
        at = {"0": first, **at, "100": last}
        steps = "".join(f"{percent}%{{{declaration}}}" for percent, declaration in at.items())
        name = f"{self.key}{name}"
        return f"@keyframes {name}{{{steps}}}.{name}{{animation:{name} {self.whole_s:.2f}s linear infinite}}"

    def style(self, *rules: str) -> str:
        """Return a style element whose rules apply only on a screen, and not for readers who prefer no motion."""
        return f"{_MOTION}{''.join(rules)}}}</style>"


_MOTION = "<style>@media screen and (prefers-reduced-motion:no-preference){"


def still(svg: str) -> str:
    """Return a picture without its motion, as print shows it."""
    return re.sub(f"{re.escape(_MOTION)}.*?</style>", "", svg, flags=re.DOTALL)


def coord(value: float, digits: int = 1) -> str:
    """Return a number in as few characters as possible, with this many digits after the point."""
    text = f"{value:.{digits}f}".rstrip("0").rstrip(".") if digits else f"{value:.0f}"
    return "0" if text in ("-0", "") else text.replace("0.", ".", 1) if text.startswith(("0.", "-0.")) else text


FONT = "system-ui,-apple-system,'Segoe UI',Roboto,'DejaVu Sans',sans-serif"
#: As on the pages of a course: text and paper, and in the dark the parts that would be glaring.
_COLOURS = (
    "<style>.{key}i{{fill:#16211f}}.{key}p{{fill:#fff}}"
    "@media(prefers-color-scheme:dark){{.{key}i{{fill:#e6eeec}}.{key}p{{fill:#101817}}.{key}b{{opacity:.6}}}}</style>"
)


def on_paper(content: str, width: int, height: int, key: str, title: str, words: str) -> str:
    """Return an SVG document, `width` by `height` px. `words` describe the picture.

    Elements with the class `key` + "i" have the text colour, those with `key` + "b" are dimmed in the dark.
    """
    svg = (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" '
        f'role="img" aria-labelledby="{key}t {key}d" font-family="{FONT}">'
        f'<title id="{key}t">{escape(title)}</title><desc id="{key}d">{escape(words)}</desc>'
        f"{_COLOURS.format(key=key)}"
        f'<rect class="{key}p" width="{width}" height="{height}" rx="6" fill="#fff"/>{content}</svg>'
    )
    # XML has no control characters, which the names of joints and frames may have.
    return re.sub(r"[^\t\n\r -\ud7ff\ue000-\ufffd\U00010000-\U0010ffff]", "\ufffd", svg)
