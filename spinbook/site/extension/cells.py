"""Says of each code cell what it is: its file, its place in the chapter's source, and whether it is meant to fail."""

from __future__ import annotations

import json
from html import escape
from typing import Any

from docutils import nodes
from sphinx.transforms import SphinxTransform

_LANGUAGES = {"shell": "bash", "node": "python", "part": "python", "interface": "text"}
#: By how a package's file ends.
_FILE_LANGUAGES = {"py": "python", "yaml": "yaml", "yml": "yaml", "xml": "xml"}
_KINDS = {
    "shell": "Terminal",
    "node": "Node",
    "snippet": "Notebook",
    "part": "Part of a node",
    "interface": "Interface",
    "package_file": "File",
}


class DescribeCells(SphinxTransform):
    """Adds a line above a cell's code, a name to its output, and words to its pictures."""

    default_priority = 400

    def apply(self, **kwargs: Any) -> None:
        """Change the document's cells."""
        for cell in list(self.document.findall(nodes.container)):
            about = cell.get("cell_metadata", {}).get("spinbook")
            if cell.get("nb_element") == "cell_code" and about:
                _describe(cell, about)


def _describe(cell: nodes.container, about: dict[str, Any]) -> None:
    kind = about["kind"]
    cell["classes"] += [f"cell-{name}" for name in (kind, about.get("runs_as")) if name]
    for part in cell.children:
        if not isinstance(part, nodes.container):
            continue
        if part.get("nb_element") == "cell_code_source":
            for code in part.findall(nodes.literal_block):
                code["language"] = _language(kind, about)
        elif part.get("nb_element") == "cell_code_output":
            _pictures(part, about["alts"], about["stills"])
            words = "Output: it fails, as it is meant to" if about["fails"] else "Output"
            part.insert(0, nodes.raw("", f'<p class="output-name">{words}</p>', format="html"))
    cell.insert(0, nodes.raw("", _head(kind, about), format="html"))


def _language(kind: str, about: dict[str, Any]) -> str:
    ending = str(about.get("package_file", "")).rpartition(".")[2]
    return _FILE_LANGUAGES.get(ending) or _LANGUAGES.get(kind, "ipython3")


def _head(kind: str, about: dict[str, Any]) -> str:
    file = about.get("file", "")
    shown = file or about.get("interface", "") or about.get("package_file", "")
    name = f'<span class="cell-file">{escape(shown)}</span>' if shown else ""
    name += f'<span class="cell-kind">{escape(about["after"])}</span>' if about.get("after") else ""
    of = shown or f"this {_KINDS.get(kind, 'cell').lower()} block"
    source = (
        f'<a class="cell-source" href="{escape(about["source"])}" '
        f'aria-label="Source of {escape(of)}, line {about["line"]}">source</a>'
        if about["source"]
        else ""
    )
    download = (
        f'<a class="cell-download" href="../{escape(about["download"])}" download aria-label="Download {escape(file)}">'
        "Download</a>"
        if file
        else ""
    )
    kind_name = f'<span class="cell-kind">{_KINDS.get(kind, "Cell")}</span>'
    run = f' data-run="{escape(json.dumps(about["run"]))}"' if about.get("run") else ""
    return f'<div class="cell-head"{run}>{kind_name}{name}<span class="cell-links">{download}{source}</span></div>'


def _pictures(output: nodes.container, alts: list[str], stills: list[str]) -> None:
    """Gives each picture its words, and a moving one its still; a picture in several formats is one picture."""
    pictures: dict[int, list[nodes.image]] = {}
    for image in output.findall(nodes.image):
        bundle = image.parent
        while bundle is not output and bundle.get("nb_element") != "mime_bundle":
            bundle = bundle.parent
        pictures.setdefault(id(bundle), []).append(image)
    for images, alt, still in zip(pictures.values(), alts, stills, strict=False):
        for image in images:
            image["alt"] = alt
        if still:
            _beside(images[0], still)


def _beside(image: nodes.image, still: str) -> None:
    """Puts the still after the image. Style sheets show one of the two: browsers choose no other source to print."""
    image["classes"].append("moving")
    alt = escape(image["alt"])
    shown = nodes.raw("", f'<img class="still" src="../{escape(still)}" alt="{alt}">', format="html")
    image.parent.insert(image.parent.index(image) + 1, shown)
