"""Tables of a page's HTML: a scrolling frame, numbers to the right, and what a phone needs to stack a row's cells."""

from __future__ import annotations

import re
from html import unescape

_TABLE = re.compile(r"<table\b(?P<attributes>[^>]*)>(?P<rows>.*?)</table>", re.DOTALL)
_ROW = re.compile(r"<tr\b(?P<attributes>[^>]*)>(?P<cells>.*?)</tr>", re.DOTALL)
_CELL = re.compile(r"<(?P<tag>t[dh])\b(?P<attributes>[^>]*)>(?P<content>.*?)</t[dh]>", re.DOTALL)
_EMPTY_HEAD = re.compile(r"<thead>(?:<t[rh][^>]*>|</t[rh]>|<p>|</p>|\s)*</thead>")
_TAG = re.compile(r"<[^>]+>")
_NUMBER = re.compile(r"[-+−±]?\d[\d.,]*")
#: A phone stacks the cells of tables with this many columns.
_STACKED = 3
_ROLES = {"td": "cell", "th": "columnheader"}


def readable_tables(html: str) -> str:
    """Return the HTML with its tables framed, aligned and labelled."""
    return _EMPTY_HEAD.sub("", _TABLE.sub(_table, html))


def _table(match: re.Match[str]) -> str:
    rows = [_cells(row["cells"]) for row in _ROW.finditer(match["rows"])]
    labels = [_text(content) for _, _, content in rows[0]] if rows else []
    body = [row for row in rows if any(tag == "td" and content for tag, _, content in row)]
    numeric = {at for at in range(len(labels)) if _is_numeric([_text(row[at][2]) for row in body if at < len(row)])}
    stacks = len(labels) >= _STACKED

    def row(found: re.Match[str]) -> str:
        cells = "\n".join(
            _cell(cell, at in numeric, labels[at] if stacks and at < len(labels) else None)
            for at, cell in enumerate(_cells(found["cells"]))
        )
        role = ' role="row"' if stacks else ""
        return f"<tr{found['attributes']}{role}>{cells}</tr>"

    attributes = _with_class(match["attributes"], "stacks") + ' role="table"' if stacks else match["attributes"]
    return f'<div class="table"><table{attributes}>{_ROW.sub(row, match["rows"])}</table></div>'


def _cells(row: str) -> list[tuple[str, str, str]]:
    return [(cell["tag"], cell["attributes"], cell["content"]) for cell in _CELL.finditer(row)]


def _cell(cell: tuple[str, str, str], is_number: bool, label: str | None) -> str:
    tag, attributes, content = cell
    attributes = _with_class(attributes, "number") if is_number else attributes
    if label is not None:
        # Browsers forget what a table's parts are when a style sheet stacks them, so the roles are said.
        attributes += f' role="{_ROLES[tag]}"' + (f' data-label="{label}"' if tag == "td" and label else "")
    return f"<{tag}{attributes}>{content}</{tag}>"


def _is_numeric(texts: list[str]) -> bool:
    shown = [unescape(text) for text in texts if text]
    return bool(shown) and all(_NUMBER.fullmatch(text) for text in shown)


def _text(html: str) -> str:
    return _TAG.sub("", html).strip().replace('"', "&quot;")


def _with_class(attributes: str, name: str) -> str:
    return (
        attributes.replace('class="', f'class="{name} ', 1)
        if 'class="' in attributes
        else f'{attributes} class="{name}"'
    )
