"""A cell that failed for a reason that its reader can mend: told in words, without a traceback."""

from __future__ import annotations


class CellFailed(Exception):
    """Raised by a notebook command. Shown as its message alone, yet the cell counts as failed everywhere."""

    def _render_traceback_(self) -> list[str]:
        """What IPython prints in place of a traceback."""
        return [str(self)]
