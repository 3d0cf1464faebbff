"""Finds fields in a command's YAML that the message, request or goal does not have."""

from __future__ import annotations

import itertools
import re
from collections.abc import Iterator

import yaml

from spinbook.chapter.interface_fields import InterfaceFields, WrongField, fields_of
from spinbook.chapter.terminal import Command
from spinbook.chapter.wrong_fields import missing_field, wrong_literal

#: (noun, verb) of a command that sends values -> the part of the interface that it sends.
_SENDING = {("topic", "pub"): "", ("service", "call"): "Request", ("action", "send_goal"): "Goal"}
_TYPE = re.compile(r"\w+/(msg|srv|action)/\w+")


def wrong_values(command: Command) -> list[WrongField]:
    """Return what is wrong in the values that a command sends; none if they are not YAML or the type is not known."""
    words = command.words
    part = _SENDING.get((words[1], words[2])) if len(words) > 4 else None
    pairs = itertools.pairwise(words[3:])
    typed = next(((kind, text) for kind, text in pairs if _TYPE.fullmatch(kind) and not text.startswith("-")), None)
    if part is None or typed is None:
        return []
    try:
        values = yaml.safe_load(typed[1])
    except yaml.YAMLError:
        return []
    known = fields_of(typed[0], part)
    # `{...}` is for the reader to fill in.
    return list(_wrong(values, known)) if known and "..." not in typed[1] and "…" not in typed[1] else []


def _wrong(values: object, known: InterfaceFields) -> Iterator[WrongField]:
    if not isinstance(values, dict):
        return
    for name, value in values.items():
        kind = known.fields.get(str(name))
        if kind is None and isinstance(name, bool):
            problem = f"`{known.name}` has no field `{name}`."
            yield WrongField(1, problem, "YAML reads on, off, yes and no as True or False: quote the field's name.")
        elif kind is None:
            yield missing_field(str(name), known, 1)
        elif kind.is_message and not kind.is_list and (inner := fields_of(kind.base)):
            yield from _wrong(value, inner)
        elif not (isinstance(value, int) and kind.base.startswith("float")):
            # YAML may write a whole number for a float: the command converts it.
            yield from wrong_literal(str(name), kind, value, known.name, 1)
