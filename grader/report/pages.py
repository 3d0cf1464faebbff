"""Renders the grader's pages. Each is one file that needs no network and runs no script but our own."""

from __future__ import annotations

import base64
import hashlib
from collections.abc import Callable
from datetime import datetime
from functools import cache
from importlib import resources
from typing import Any

from jinja2 import Environment, FunctionLoader, StrictUndefined, Template
from markupsafe import Markup

from grader.report.printable import printable

#: The longest text that is shown: a student can publish a name of a megabyte.
LONGEST_TEXT = 4000


def render(page: str, script: str = "", **values: Any) -> str:
    """Return the page that the template `page` (a path below grader/) makes from `values`.

    Every text is escaped, loses its control and direction-changing characters, and is cut after 4000 characters. The
    page contains the shared style sheet and `script` (a path, too). Its policy forbids everything else: other scripts
    and styles, every request, forms.
    """
    style, code = _style(), _source(script) if script else ""
    policy = {
        "default-src": "'none'",
        "style-src": _allowed(style),
        "script-src": _allowed(code) if code else "'none'",
        "img-src": "data:",
        "base-uri": "'none'",
        "form-action": "'none'",
    }
    return template(page).render(
        **values,
        style=Markup(style),
        script=Markup(code),
        policy="; ".join(f"{name} {value}" for name, value in policy.items()),
    )


def template(name: str) -> Template:
    """Return a template by its path below grader/. Whatever it shows is escaped and harmless."""
    return environment(_source).get_template(name)


@cache
def environment(source: Callable[[str], str]) -> Environment:
    """Return the environment of templates whose texts `source` returns by their names."""
    made = Environment(
        loader=FunctionLoader(source),
        autoescape=True,
        undefined=StrictUndefined,
        finalize=_harmless,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    made.filters |= {"points": points, "moment": moment}
    return made


def _source(name: str) -> str:
    """Return the text of a template. In a web page, it is in an archive."""
    folder, _, file = name.rpartition("/")
    return (resources.files(f"grader.{folder.replace('/', '.')}") / file).read_text(encoding="utf-8")


def _harmless(value: Any) -> Any:
    if isinstance(value, str) and not isinstance(value, Markup):
        return printable(value, LONGEST_TEXT)
    return value


@cache
def _style() -> str:
    return _source("report/style.css")


def _allowed(text: str) -> str:
    """Return the hash of this text for a content security policy (CSP level 2, hash sources)."""
    return f"'sha256-{base64.b64encode(hashlib.sha256(text.encode()).digest()).decode()}'"


def points(value: float) -> str:
    """Return points with at most two decimals, as learning platforms store them: 81, 80.5, 33.33."""
    return f"{value:.2f}".rstrip("0").rstrip(".")


def moment(value: datetime | None) -> str:
    """Return a point in time for people, in its own time zone: 21 Nov 2026, 23:59 +01:00."""
    if value is None:
        return ""
    months = ("Jan", "Feb", "Mar", "Apr", "May", "Jun", "Jul", "Aug", "Sep", "Oct", "Nov", "Dec")
    zone = value.strftime("%z")
    shown = f"{value.day} {months[value.month - 1]} {value.year}, {value:%H:%M}"
    return f"{shown} {'UTC' if zone == '+0000' else f'{zone[:3]}:{zone[3:]}'}" if zone else shown
