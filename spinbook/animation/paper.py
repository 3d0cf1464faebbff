"""The SVG element around a picture: its size, what it says to those who do not see it, its paper for light and dark."""

from __future__ import annotations

from html import escape

FONT = "system-ui,-apple-system,'Segoe UI',Roboto,'DejaVu Sans',sans-serif"
_COLOURS = (
    "<style>.{key}i{{fill:#24292f}}.{key}p{{fill:#fff}}"
    "@media(prefers-color-scheme:dark){{.{key}i{{fill:#e6edf3}}.{key}p{{fill:#161b22}}}}</style>"
)


def on_paper(content: str, width: int, height: int, key: str, title: str, words: str) -> str:
    """An SVG document, `width` by `height` px. What has the class `key` + "i" is in ink; `words` describe it all."""
    return (
        f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}" height="{height}" viewBox="0 0 {width} {height}" '
        f'role="img" aria-labelledby="{key}t {key}d" font-family="{FONT}">'
        f'<title id="{key}t">{escape(title)}</title><desc id="{key}d">{escape(words)}</desc>'
        f"{_COLOURS.format(key=key)}"
        f'<rect class="{key}p" width="{width}" height="{height}" rx="6" fill="#fff"/>{content}</svg>'
    )
