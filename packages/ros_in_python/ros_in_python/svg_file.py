"""The type of a command's argument or option that names the file of a picture."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import click


class SvgFile(click.Path):
    """The file that a picture is written into; another kind of picture is refused before anything runs."""

    def convert(self, value: Any, param: click.Parameter | None, ctx: click.Context | None) -> Path:
        """Return the file. Its name ends in `.svg`, or has no ending."""
        file = Path(str(super().convert(value, param, ctx)))
        if file.suffix.lower() not in ("", ".svg"):
            self.fail(f"{file}: pictures are SVG files. Choose a name that ends in .svg.", param, ctx)
        return file
