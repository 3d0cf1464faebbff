"""The names that book tools use: kinds of admonitions, directives, and the attributes of tags."""

from __future__ import annotations

import re
from collections.abc import Mapping
from html import unescape

import yaml

#: The styles in which admonitions are shown; below, the names that book tools have for them.
STYLES = ("note", "tip", "important", "warning", "caution")
_STYLE = {
    **{style: style for style in STYLES},
    **dict.fromkeys(("info", "abstract", "summary", "quote", "cite", "example", "seealso", "todo"), "note"),
    **dict.fromkeys(("callout-note", "callout", "theorem", "topic", "admonition", "sidebar", "margin"), "note"),
    **dict.fromkeys(("prerequisites", "learninggoals", "keytakeaways", "exercise", "solution", "hint-info"), "note"),
    "secondary": "note",
    **dict.fromkeys(("hint", "success", "check", "done", "question", "help", "faq", "callout-tip", "highlight"), "tip"),
    **dict.fromkeys(("danger", "error", "bug", "failure", "fail", "missing", "callout-caution", "caution"), "caution"),
    **dict.fromkeys(("attention", "warn", "callout-warning", "new"), "warning"),
    **dict.fromkeys(("callout-important",), "important"),
}
#: MyST directives that contain code.
CODE = frozenset({"code-cell", "code-block", "code", "sourcecode", "highlight"})
#: Directives that make lists of pages and similar things, which a reader of one chapter does not need.
UNSEEN = frozenset({"toctree", "tableofcontents", "contents", "index", "bibliography", "only", "raw", "eval-rst"})
#: The kinds of blocks that a misspelt one may mean.
BLOCKS = (
    *(*_STYLE, *CODE, *UNSEEN, "dropdown", "details", "tab", "tab-item", "tab-set", "tabs", "literalinclude", "figure"),
    *("figure-md", "subfigure", "notes", "questions"),
)
#: Tags that hold blocks: MDX's, HTML's, Liquid's.
_TABS = frozenset({"Tabs", "TabItem", "Tab", "tabs", "tab", "CodeGroup", "TabPanel"})
_HOLDING = frozenset({"Admonition", "details", "Details", "highlight", "raw", "capture", "comment", "code"})


_PAIR = re.compile(r"""([A-Za-z_][\w-]*)\s*[=:]\s*(?:\{?\s*"([^"]*)"\s*\}?|\{?\s*'([^']*)'\s*\}?|([^\s,{}>]+))""")
_EXERCISE = re.compile(r"^<!--\s*exercise:\s*([\w-]+)\s*-->")
_OPTION = re.compile(r"^:([\w-]+):\s*(.*)$")
_SNIPPET = re.compile(r"\s*(?:#|//)?\s*-+8<-+\s+[\"'](.+?)[\"']\s*$")
#: Components that hold a box whose kind is a property, and those that fold what they hold.
_BOXES = frozenset({"Admonition", "Aside", "Callout", "Alert", "Notice", "Message", "Box", "Infobox"})
_FOLDED = frozenset(
    {"details", "accordion", "accordionitem", "expandable", "collapsible", "dropdown", "toggle", "spoiler", "expand"}
)
#: The components of MDX that a misspelt one may mean.
COMPONENTS = tuple(name for name in (*_TABS, *_HOLDING, *_BOXES, *map(str.capitalize, _STYLE)) if name[0].isupper())
_PICTURE = r"[^\"'`{}]+\.(?:png|jpe?g|gif|svg|webp|avif)"
_PICTURE_PATH = re.compile(rf"""["'`]({_PICTURE})["'`]""", re.IGNORECASE)
_IMPORT = re.compile(r"""^import\s+(\w+)\s+from\s+["'](!!raw-loader!)?([^"']+)["'];?[ \t]*$""", re.MULTILINE)
#: A tag of HTML in a line, with a property that is code; code between backticks is matched so that it is skipped.
_JSX = re.compile(r"`[^`]*`|<[a-z]\w*\s(?:[^<>{}]|\{(?:[^{}]|\{[^{}]*\})*\})*>")
_PROPERTY = re.compile(r"\s+([\w-]+)=\{((?:[^{}]|\{[^{}]*\})*)\}")
_PATH = re.compile(r"""(["'`])([^"'`]+)\1""")
_QUOTED = re.compile(r"\"((?:[^\"\\]|\\.)*)\"|'((?:[^'\\]|\\.)*)'")


def is_paired(name: str) -> bool:
    """Return whether tags of this name come in pairs: every capitalised one of MDX, and a few others."""
    is_ours = name in _TABS or name in _HOLDING or name in _STYLE
    return is_ours or name[:1].isupper() or name.capitalize() in _BOXES or name in _FOLDED


def exercise(html: str) -> str:
    """Return the exercise that a comment asks for; "" for any other piece of HTML."""
    match = _EXERCISE.match(html.strip())
    return match[1] if match else ""


def snippet(line: str) -> str:
    """Return the file that a line `--8<-- "file"` includes; "" for any other line."""
    match = _SNIPPET.match(line)
    return match[1] if match else ""


def not_included(code: str) -> str:
    """Return the first file whose line `--8<-- "file"` was not replaced by its text; "" if there is none."""
    names = (snippet(line) for line in code.split("\n")) if "8<--" in code else ()
    return next((name for name in names if name), "")


def options(lines: list[str]) -> tuple[dict[str, str], int]:
    """Return a directive's options (`:key: value` lines, or YAML between two `---`), and how many lines they take.

    The items of a list are joined with commas.
    """
    values: dict[str, str] = {}
    if lines and lines[0].strip() == "---" and "---" in (rest := [line.strip() for line in lines[1:]]):
        end = rest.index("---")
        return _yaml_options("\n".join(lines[1 : end + 1])), end + 2
    count = 0
    while count < len(lines) and (match := _OPTION.match(lines[count].strip())):
        values[match[1]] = match[2].strip()
        count += 1
    return values, count


def _yaml_options(text: str) -> dict[str, str]:
    try:
        values = yaml.safe_load(text)
    except yaml.YAMLError:
        values = dict(line.partition(":")[::2] for line in text.split("\n"))
    if not isinstance(values, dict):
        return {}
    lists = {key: ", ".join(map(str, value)) for key, value in values.items() if isinstance(value, list)}
    return {str(key).strip(): lists.get(key, str(value).strip()) for key, value in values.items()}


def pairs(text: str) -> dict[str, str]:
    """Return the attributes of a tag: `label="Python"`, `title={"Note"}`, `style=info`."""
    return {key: double or single or plain for key, double, single, plain in _PAIR.findall(text)}


def image(path: str, properties: dict[str, str]) -> str:
    """Return an image as HTML if it has a width, otherwise as Markdown."""
    alt = properties.get("alt") or properties.get("caption") or ""
    if "width" in properties:
        width = properties["width"].removesuffix("px")
        return f'<img src="{path}" alt="{alt}" width="{width}">'
    return f"![{alt}](<{path}>)" if " " in path else f"![{alt}]({path})"


def container_name(info: str) -> tuple[str, str]:
    """Return (name, rest) after `:::`, in the forms of Docusaurus, VitePress, MyST and Quarto."""
    info = info.strip().rstrip(":").strip()
    if info.startswith("{"):
        inside, _, rest = info[1:].partition("}")
        words = inside.strip().split(" ")
        title = pairs(inside).get("title", "")
        return words[0].lstrip(".").lower(), (title or rest).strip()
    name, bar, title = info.partition(" | ")
    if bar and " " not in name:
        return name.lower(), title.strip()
    name, bracket, rest = info.partition("[")
    if bracket and " " not in name.strip():
        return name.strip().lower(), rest.rpartition("]")[0].strip()
    name, _, rest = info.partition(" ")
    name, brace, _ = name.partition("{")
    if brace or rest.startswith("{"):
        return name.lower(), pairs(info).get("title", "")
    return name.lower(), rest.partition("{")[0].strip().strip("\"'")


def container(name: str, argument: str, colon: bool = False) -> tuple[str | None, str, str]:
    """Return (kind, style, title) for a name such as `warning` or `tab-item`; the kind of an unknown one is None."""
    name = name.lower()
    if name in {"tab-item", "tab"}:
        return "tab", "", argument
    if name in {"dropdown", "details", "collapse", "toggle"}:
        return "details", "note", argument or "Details"
    if name in {"tab-set", "tabs", "code-group", "grid", "grid-item", "grid-item-card", "card", "div", "column"}:
        return "group", "", argument if name.endswith("card") else ""
    if name in _STYLE:
        own_title = argument if colon or name in {"admonition", "topic", "exercise", "sidebar"} else ""
        return "admonition", _STYLE[name], own_title
    return None, "", ""


def admonition(info: str) -> tuple[str, str]:
    """Return (style, title) after `!!!`: `note "Title"`, `warning inline end`."""
    words, quote, title = info.strip().partition('"')
    name = words.strip().split(" ")[0].lower()
    style = _STYLE.get(name, "note")
    if quote:
        return style, title.rpartition('"')[0]
    return style, "" if name in STYLES else name.capitalize()


def kramdown_style(text: str) -> str:
    """Return the style that kramdown's `{: .warning }` names; "" if it names none."""
    names = [word[1:].removesuffix("-title") for word in text.split() if word.startswith(".")]
    return next((_STYLE[name] for name in names if name in _STYLE), "")


def paired(name: str, properties: dict[str, str], words: str) -> tuple[str, str, str]:
    """Return (kind, style, title) for an opening tag of this name."""
    positional = words.strip().strip("\"'") if "=" not in words else ""
    if name in {"TabItem", "Tab", "tab", "TabPanel"}:
        # jekyll-tabs names the group first: `tab group title`.
        positional = (positional.partition(" ")[2] or positional).strip("\"'")
        labels = (properties.get(key) for key in ("label", "title", "value"))
        return "tab", "", next(filter(None, labels), positional)
    title = properties.get("title") or properties.get("summary") or properties.get("header") or ""
    if name.lower() in _FOLDED:
        return "details", "note", title or properties.get("label") or positional
    if name in _BOXES or name.capitalize() in _BOXES or name == "hint":
        keys = ("type", "variant", "kind", "severity", "style", "context", "color")
        # Hugo's `{{< hint warning >}}` and `{{% notice tip "Title" %}}` name it first.
        first, _, rest = positional.partition(" ")
        kind = next((properties[key] for key in keys if key in properties), first.strip("\"'") or "note")
        return "admonition", _STYLE.get(kind.lower(), "note"), title or rest.strip("\"'")
    if name.lower() in _STYLE and name not in {"highlight"}:
        title = properties.get("title") or ("" if name.lower() in STYLES else in_words(name))
        return "admonition", _STYLE[name.lower()], title
    if name == "comment":
        return "dropped", "", ""
    return "group", "", title if name[:1].isupper() or name == "code" else ""


def part_of_file(text: str, options: Mapping[str, str]) -> str:
    """Return the lines of a file that a `literalinclude` asks for: `lines`, `start-after`, `end-before` and so on."""
    lines = text.splitlines()
    numbers = [number for part in options.get("lines", "").split(",") for number in _numbers(part, len(lines))]
    lines = [lines[number - 1] for number in numbers if number <= len(lines)] if numbers else lines
    for key, end, extra in (("start-after", 0, 1), ("start-at", 0, 0), ("end-before", 1, 0), ("end-at", 1, 1)):
        if words := options.get(key, ""):
            at = next((i for i, line in enumerate(lines) if words in line), None)
            lines = lines if at is None else lines[: at + extra] if end else lines[at + extra :]
    return "".join(f"{line}\n" for line in lines)


def _numbers(part: str, last: int) -> range:
    """Return the line numbers of `3`, `3-5` or `3-`."""
    first, dash, end = part.strip().partition("-")
    return range(int(first or 1), int(end or (last if dash else first)) + 1) if (first + end).isdigit() else range(0)


def in_words(name: str) -> str:
    """Return `LearningGoals` as "Learning goals"."""
    return re.sub(r"(?<=[a-z])(?=[A-Z])", " ", name).capitalize()


def words_of(name: str, properties: str) -> list[str]:
    """Return the sentences among a component's properties, as a quotation; nothing if it has none."""
    sentences = [(double or single).replace('\\"', '"') for double, single in _QUOTED.findall(properties)]
    title = pairs(properties).get("title", "")
    sentences = [text for text in sentences if len(text) >= 12 and " " in text and text != title]
    return [f"> **{title or in_words(name)}**", ">", *(f"> - {text}" for text in sentences), ""] if sentences else []


def with_imports(text: str) -> str:
    """Return an MDX chapter with the paths of what it imports, where their names are used.

    `src={arm}` shows a picture, `<Steps />` a text, and `<CodeBlock>{Source}</CodeBlock>` the content of a file.
    """
    for name, is_source, path in _IMPORT.findall(text):
        quoted = f'"{path}"'.replace("\\", r"\\")
        text = re.sub(rf"(?<=\bsrc=)\{{\s*{name}(?:\.\w+)?\s*\}}", quoted, text)
        if is_source or path.endswith((".md", ".mdx")):
            shown = rf"<{name}\b[^<>\n]*/>|(?:<CodeBlock\b[^>\n]*>)?\{{\s*{name}\s*\}}(?:</CodeBlock>)?"
            text = re.sub(rf"(?m)^[ \t]*(?:{shown})[ \t]*$", f"--8<-- {quoted}", text)
    return text


def picture(properties: str) -> str:
    """Return the picture that a component shows, as Markdown or HTML; "" if it shows none."""
    path = _PICTURE_PATH.search(properties)
    return image(path[1], pairs(as_html(f" {properties}"))) if path else ""


def has_jsx(text: str) -> bool:
    """Return whether a tag of HTML in a text has a property that is code, as in MDX."""
    return "={" in text and any("={" in match and match[0] == "<" for match in _JSX.findall(text))


def without_jsx(text: str) -> str:
    """Return a line whose tags have HTML's properties only."""
    return _JSX.sub(lambda match: as_html(match[0]) if match[0].startswith("<") else match[0], text)


def as_html(tag: str) -> str:
    """Return an MDX tag as HTML: a property keeps its path; code in properties is left out."""
    return _PROPERTY.sub(lambda match: _property(match[1], match[2]), tag).replace(" className=", " class=")


def _property(name: str, code: str) -> str:
    path = _PATH.search(code)
    if name in {"src", "href"} and path:
        return f' {name}="{path[2]}"'
    return f' {name}="{code.strip()}"' if code.strip().isdigit() else ""


def plain(html: str) -> str:
    """Return the text of a piece of HTML."""
    return unescape(re.sub(r"<[^>]*>", "", html)).strip()
