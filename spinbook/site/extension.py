"""Extends Sphinx: the HTML of code cells, terms, maths and pictures, and the search index."""

from __future__ import annotations

import json
import posixpath
import re
from collections.abc import Iterator
from html import escape
from pathlib import Path
from typing import Any

from docutils import nodes
from latex2mathml.converter import convert
from PIL import Image
from sphinx import addnodes
from sphinx.application import Sphinx
from sphinx.transforms import SphinxTransform
from sphinx.util import logging
from sphinx.writers.html5 import HTML5Translator

from groundwork.files import write_if_changed
from groundwork.words import counted
from spinbook.site.command_lexer import CommandLexer
from spinbook.site.glossary import define_terms
from spinbook.site.guesses import AskGuesses
from spinbook.site.log_lexer import LogLexer
from spinbook.site.page import FRAME_SUFFIX, GLOSSARY, HOME
from spinbook.site.parts import divide
from spinbook.site.tables import readable_tables
from spinbook.site.unbroken import KeepTogether

_IMAGE = re.compile(r"<img\b[^>]*>")
_SOURCE = re.compile(r'\bsrc="([^"]+)"')
_HEADING_LINK = re.compile(r'<a class="headerlink" href="(#[^"]*)" title="[^"]*">[^<]*</a>')
_EMPTY_HEAD = re.compile(r'<th class="head[^"]*">\s*(?:<p></p>)?\s*</th>')
#: Code in a table, and where its lines may break: after the slashes of a type.
_CELL_CODE = re.compile(r"(?<=<td>)(?:(?!</td>).)*<code(?:(?!</td>).)*", re.DOTALL)
_INNER_SLASH = re.compile(r"(?<=\w)/(?=\w)(?=[^<>]*</code>)")
#: What docutils adds for its own style sheets, and Pygments for browsers that are gone and for words without a colour.
_UNUSED = re.compile(
    r'(?<=<pre>)<span></span>|<span class="(?:pre|n|p|o|w)">([^<]*)</span>'
    r'| docutils container(?=")|(?<=<code class=")docutils literal '
)
_STYLE = re.compile(r'\sstyle="[^"]*"')


def finish(app: Sphinx, page: str, template: str, context: dict[str, Any], doctree: nodes.document | None) -> None:
    """Add sizes to pictures, names to the links of headings, and a scrolling frame to tables."""
    context["frame"] = _frame(app, page)
    if "body" not in context:
        return
    body = context["body"]
    # A strict content security policy allows no styles in the page itself.
    body = _STYLE.sub("", body)
    folder = Path(app.outdir, page).parent
    body = _IMAGE.sub(lambda match: _sized(match.group(), folder, app), body)
    body = _HEADING_LINK.sub(r'<a class="headerlink" href="\1" aria-label="Link to this section">#</a>', body)
    body = _UNUSED.sub(lambda match: match[1] or "", body)
    body = fold_mains(body)
    body = _EMPTY_HEAD.sub("<td></td>", body)
    body = _CELL_CODE.sub(lambda match: _INNER_SLASH.sub("/<wbr>", match.group()), body)
    context["body"] = readable_tables(body)


def _frame(app: Sphinx, page: str) -> dict[str, Any]:
    """Return what was staged next to the page for the theme."""
    try:
        frame = json.loads(Path(app.srcdir, f"{page}{FRAME_SUFFIX}").read_text(encoding="utf-8"))
    except OSError:
        return {"kind": "search"}
    return dict(frame)


def in_parts(app: Sphinx, document: nodes.document, page: str) -> None:
    """Divide a chapter into parts."""
    frame = _frame(app, page)
    if frame["kind"] == "chapter":
        divide(document, frame["minutes"])


def depend(app: Sphinx, page: str, source: list[str]) -> None:
    """Rebuild a page when the file next to it changes."""
    app.env.note_dependency(f"{page}{FRAME_SUFFIX}")


def _size(file: Path) -> tuple[int, int]:
    """Return width and height of a picture in CSS pixels. Raises OSError or ValueError if they are unknown."""
    if file.suffix != ".svg":
        with Image.open(file) as image:
            return int(image.width), int(image.height)
    opening = file.read_text(encoding="utf-8").partition(">")[0]
    sizes = dict(re.findall(r'\b(width|height)="([\d.]+)(?:px)?"', opening))
    if len(sizes) < 2:
        raise ValueError(file)
    return round(float(sizes["width"])), round(float(sizes["height"]))


def _sized(tag: str, folder: Path, app: Sphinx) -> str:
    source = _SOURCE.search(tag)
    if source is None or " width=" in tag:
        return tag
    # Sphinx copies pictures after it has written the pages, but already knows their new names.
    name = Path(source.group(1)).name
    original = next((Path(app.srcdir, at) for at, (_, to) in app.env.images.items() if to == name), folder / name)
    try:
        width, height = _size(original)
    except (OSError, ValueError):
        return f'{tag.rstrip("/> ")} loading="lazy">'
    return f'{tag.rstrip("/> ")} width="{width}" height="{height}" loading="lazy">'


_LANGUAGES = {"shell": "bash", "node": "python", "part": "python", "interface": "text"}
#: The language of a package's file, by its suffix.
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
    """Adds a line above a cell's code, a heading to its output, and alternative texts to its pictures."""

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
                _mark(code, about["repeats"])
        elif part.get("nb_element") == "cell_code_output":
            _pictures(part, about["alts"], about["stills"])
            part.insert(0, nodes.raw("", _output_name(about), format="html"))
    if about["repeats"]["housekeeping"] and not (about["wrong"] or about["fails"] or cell.get("hide_mode")):
        cell["classes"].append("cell-strip")
        cell["hide_mode"] = "output"
    _fold(cell)
    cell.insert(0, nodes.raw("", _head(kind, about), format="html"))


def _mark(code: nodes.literal_block, repeats: dict[str, Any]) -> None:
    """Let Pygments mark the lines that an earlier version of the program did not have; `finish` folds its `main`."""
    code["highlight_args"] = {"hl_lines": repeats["changed"]}
    if repeats["main_from"] is not None:
        code["classes"].append(f"main-from-{repeats['main_from']}")


#: The code of a block whose `main` is as before, from a line on.
_AS_BEFORE = re.compile(r'(<div class="main-from-(\d+) .*?<pre>)(.*?)(</pre>)', re.DOTALL)


def fold_mains(body: str) -> str:
    """Return a page's HTML with a button below each program whose `main` is as before; without scripts, it is shown."""
    return _AS_BEFORE.sub(_folded, body)


def _folded(match: re.Match[str]) -> str:
    # Pygments ends every element of code with its line, or, if it marks the line, right after it.
    lines = match[3].replace("\n</span>", "</span>\n").split("\n")
    start = int(match[2])
    same = f'<span class="as-before">{chr(10).join(lines[start:])}</span>'
    button = '<button class="unfold" type="button" aria-expanded="false">main() as before</button>'
    return "\n".join([match[1] + lines[0], *lines[1:start], same]) + match[4] + button


#: MyST's tags -> what is folded: hide-input, hide-output, both of them, hide-cell.
_FOLDED = {
    "input": {"cell_code_source"},
    "output": {"cell_code_output"},
    "input+output": {"cell_code_source", "cell_code_output"},
    "all": {"cell_code_source", "cell_code_output"},
}


def _fold(cell: nodes.container) -> None:
    """Fold what the cell's tags hide. myst-nb would do it later, but does not recognise a cell with a head."""
    hidden = _FOLDED.get(cell.attributes.pop("hide_mode", ""), set())
    for part in [child for child in cell.children if isinstance(child, nodes.container)]:
        if part.get("nb_element") in hidden:
            words = "Show the code" if part["nb_element"] == "cell_code_source" else "Show the output"
            words = "Output" if "cell-strip" in cell["classes"] else words
            opening = f'<details class="hidden-part"><summary>{words}</summary>'
            cell.insert(cell.index(part), nodes.raw("", opening, format="html"))
            cell.insert(cell.index(part) + 1, nodes.raw("", "</details>", format="html"))


def _output_name(about: dict[str, Any]) -> str:
    """Return the heading of a cell's output. If something went wrong, the page's first lines link to it."""
    if about["wrong"]:
        return f'<p class="output-name went-wrong" id="{about["wrong"]}">✗ Output: something went wrong</p>'
    words = "Output: it fails, as expected" if about["fails"] else "Output"
    return f'<p class="output-name">{words}</p>'


def _language(kind: str, about: dict[str, Any]) -> str:
    ending = str(about.get("package_file", "")).rpartition(".")[2]
    return _FILE_LANGUAGES.get(ending) or _LANGUAGES.get(kind, "ipython3")


def _head(kind: str, about: dict[str, Any]) -> str:
    file = about.get("file", "")
    shown = file or about.get("interface", "") or about.get("package_file", "")
    name = f'<span class="cell-file">{escape(shown)}</span>' if shown else ""
    notes = [escape(about["after"])] if about.get("after") else []
    notes += _changes(about["repeats"]["changed"])
    name += "".join(f' <span class="cell-kind">{note}</span>' for note in notes)
    of = shown or f"the block in line {about['line']}"
    source = f'<a class="cell-source" href="{escape(about["source"])}">Source, line {about["line"]}</a>'
    path = escape(about.get("download", ""))
    download = f'<a class="cell-download" href="../{path}" download>Download {escape(file)}</a>'
    kind_name = f'<span class="cell-kind">{_KINDS.get(kind, "Cell")}</span>'
    # JSON has many double quotes, so its attribute is in single ones.
    data = escape(json.dumps(about.get("run"), separators=(",", ":")), quote=False).replace("'", "&#x27;")
    run = f" data-run='{data}'" if about.get("run") else ""
    return (
        f'<div class="cell-head"{run}><p class="cell-name">{kind_name} {name}</p><div class="cell-links">'
        f'<details class="more"><summary aria-label="More about {escape(of)}">…</summary>'
        f'<div class="places">{download if file else ""}{source if about["source"] else ""}</div></details></div></div>'
    )


def _changes(lines: list[int]) -> Iterator[str]:
    """Yield what the marks at the lines of a changed program mean, for a page's head."""
    if lines:
        where = f'<span class="hidden-text">: {", ".join(map(str, lines))}</span>'
        yield f'<span class="hll">{counted(len(lines), "line")} changed</span>{where}'


def _pictures(output: nodes.container, alts: list[str], stills: list[str]) -> None:
    """Add alternative texts, and still pictures for moving ones. Several formats of a picture are one picture."""
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
            _add_still(images[0], still)


def _add_still(image: nodes.image, still: str) -> None:
    """Add the still picture after the image. Style sheets show one of the two."""
    image["classes"].append("moving")
    alt = escape(image["alt"])
    shown = nodes.raw("", f'<img class="still" src="../{escape(still)}" alt="{alt}">', format="html")
    image.parent.insert(image.parent.index(image) + 1, shown)


_LOG = logging.getLogger(__name__)


def visit_inline(translator: HTML5Translator, node: nodes.math) -> None:
    """Render `$…$` in a line."""
    translator.body.append(_mathml(node, "inline"))
    raise nodes.SkipNode


def visit_block(translator: HTML5Translator, node: nodes.math_block) -> None:
    """Render `$$…$$`, on a line of its own."""
    translator.body.append(f'<div class="math">{_mathml(node, "block")}</div>\n')
    raise nodes.SkipNode


#: Functions that LaTeX sets upright, with a thin space around them (The TeXbook, chapter 18: "Op" atoms).
_NAMES = "arccos|arcsin|arctan|arg|cos|cosh|cot|det|dim|exp|gcd|inf|ker|lim|ln|log|max|min|sec|sin|sinh|sup|tan|tanh"
_OPERATOR = re.compile(
    rf"(?P<before></m(?:i|n|row|sup|sub|frac|sqrt)>)?"
    rf"(?P<name><mi>(?:{_NAMES})</mi>|<m(?P<script>sup|sub)><mi>(?:{_NAMES})</mi>.*?</m(?P=script)>)"
    rf"(?P<after>(?=<m(?:i|n|row|sup|sub|frac|sqrt)>))?"
)
_THIN = '<mspace width="0.167em" />'


def spaced(mathml: str) -> str:
    """Add thin spaces around names of functions, which the library leaves out: 0.5 sin t, and not 0.5sint."""
    return _OPERATOR.sub(_with_spaces, mathml)


def _with_spaces(match: re.Match[str]) -> str:
    before = f"{match['before']}{_THIN}" if match["before"] else ""
    return f"{before}{match['name']}{_THIN if match['after'] is not None else ''}"


def _mathml(node: nodes.Element, display: str) -> str:
    text = node.astext()
    try:
        return spaced(str(convert(text, display=display)))
    except Exception as error:  # the library raises many kinds, for what an author wrote
        _LOG.warning("this is not valid LaTeX: %s (%s)", text, error, location=node)
        return f"<code>{node.astext()}</code>"


# Sphinx's own index lists pages, and needs a server to show excerpts. Chapters are long, so readers need sections; and
# a page that is opened from a folder has no server.


FILE = "_static/search-data.js"


def no_index_of_sphinx(app: Sphinx) -> None:
    """Keep Sphinx from writing its own index, which is unused."""
    app.builder.search = False  # type: ignore[attr-defined]


def write(app: Sphinx, error: Exception | None) -> None:
    """Write the search data: the sections of every page."""
    if error is None:
        rows = [row for page in sorted(app.env.found_docs) if page != HOME for row in _sections(app, page)]
        text = ",\n".join(json.dumps(row, ensure_ascii=False) for row in rows)
        write_if_changed(Path(app.outdir, FILE), f"const courseSections = [\n{text}\n];\n")


def _sections(app: Sphinx, page: str) -> Iterator[tuple[str, str, str, str]]:
    """Yield each section: address, page title, section title, and its text without subsections."""
    title = app.env.titles[page].astext()
    for section in app.env.get_doctree(page).findall(nodes.section):
        heading = next((child.astext() for child in section.children if isinstance(child, nodes.title)), "")
        words = " ".join(_words(section))
        yield f"{page}.html#{section['ids'][0]}", title, heading, re.sub(r"\s+", " ", words).strip()


def _words(node: nodes.Element) -> Iterator[str]:
    for child in node.children:
        if isinstance(child, (nodes.section, nodes.title, nodes.raw, nodes.comment)):
            continue
        if isinstance(child, nodes.container) and child.get("nb_element") == "cell_code_output":
            continue
        if isinstance(child, (nodes.TextElement, nodes.math_block)):
            yield child.astext()
        elif isinstance(child, nodes.Element):
            yield from _words(child)


#: A link to another page is a pending_xref until Sphinx has read all pages.
_LINKS = (nodes.reference, addnodes.pending_xref)
_NOT_IN = (nodes.title, *_LINKS, nodes.literal, nodes.raw, nodes.math, nodes.caption, nodes.literal_block)


class LinkTerms(SphinxTransform):
    """Links the first use of each term to the glossary, in prose of chapters and exercises only."""

    default_priority = 850

    def apply(self, **kwargs: Any) -> None:
        """Change the document."""
        page = self.env.docname
        terms: dict[str, str] = dict(self.config.spinbook_terms)
        if "/" not in page or not terms:
            return
        glossary = posixpath.relpath(f"{GLOSSARY}.html", posixpath.dirname(page))
        longest = sorted(terms, key=len, reverse=True)
        pattern = re.compile(rf"\b(?:{'|'.join(map(re.escape, longest))})\b", re.IGNORECASE)
        by_lower = {form.lower(): anchor for form, anchor in terms.items()}
        seen: set[str] = set()
        for text in list(self.document.findall(nodes.Text)):
            if _is_prose(text):
                _link(text, pattern, by_lower, seen, glossary)


def _is_prose(text: nodes.Text) -> bool:
    parent = text.parent
    in_paragraph = False
    while parent is not None and not isinstance(parent, nodes.document):
        if isinstance(parent, (*_NOT_IN, nodes.table)):
            return False
        in_paragraph = in_paragraph or isinstance(parent, nodes.paragraph)
        parent = parent.parent
    return in_paragraph


def _link(text: nodes.Text, pattern: re.Pattern[str], anchors: dict[str, str], seen: set[str], glossary: str) -> None:
    whole = text.astext()
    pieces: list[nodes.Node] = []
    position = 0
    for match in pattern.finditer(whole):
        anchor = anchors[match.group().lower()]
        if anchor in seen:
            continue
        seen.add(anchor)
        pieces.append(nodes.Text(whole[position : match.start()]))
        target = f"{glossary}#{anchor}"
        pieces.append(nodes.reference("", match.group(), refuri=target, internal=True, classes=["term"]))
        position = match.end()
    if pieces:
        text.parent.replace(text, [*pieces, nodes.Text(whole[position:])])


NAME = "spinbook.site.extension"


def setup(app: Sphinx) -> dict[str, Any]:
    """Register everything with Sphinx, which calls this function."""
    app.add_config_value("spinbook_terms", [], "env")
    app.add_lexer("ros-log", LogLexer)
    app.add_lexer("bash", CommandLexer)
    app.add_html_math_renderer("mathml", (visit_inline, None), (visit_block, None))
    app.add_transform(DescribeCells)
    app.add_transform(AskGuesses)
    app.add_transform(LinkTerms)
    app.add_transform(KeepTogether)
    app.connect("builder-inited", no_index_of_sphinx)
    app.connect("source-read", depend)
    app.connect("doctree-resolved", define_terms)
    app.connect("doctree-resolved", in_parts)
    app.connect("html-page-context", finish)
    app.connect("build-finished", write)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
