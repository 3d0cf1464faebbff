"""Parses the lines of a definition (fields, constants, separators) and reports what is wrong in them.

The language is described at https://docs.ros.org/en/jazzy/Concepts/Basic/About-Interfaces.html. ROS's own parser does
not say where an error is, so each line is parsed here first. That parser, `rosidl_adapter.parser`, only decides
whether a value fits its type.
"""

from __future__ import annotations

import difflib
import keyword
import math
import re
from collections.abc import Iterator
from dataclasses import dataclass, field

from interface_compiler.definition import KINDS, Definition, Fault

PRIMITIVES = (
    *("bool", "byte", "char", "float32", "float64", "int8", "uint8", "int16", "uint16", "int32", "uint32"),
    *("int64", "uint64", "string", "wstring"),
)
#: Type names that people write -> their names in ROS 2.
_USUAL_MISTAKES = {
    "Header": "std_msgs/Header",
    "time": "builtin_interfaces/Time",
    "Time": "builtin_interfaces/Time",
    "duration": "builtin_interfaces/Duration",
    "Duration": "builtin_interfaces/Duration",
    **{"int": "int32", "integer": "int32", "long": "int64", "float": "float32", "double": "float64"},
    **{"boolean": "bool", "Bool": "bool", "str": "string", "String": "string", "text": "string"},
}
#: Words that can't name a field, because the generated C or C++ would not compile: ISO C17, 6.4.1 and C++17, [lex.key].
_C_KEYWORDS = (
    "alignas alignof and and_eq asm auto bitand bitor bool break case catch char char16_t char32_t class compl "
    "const const_cast constexpr continue decltype default delete do double dynamic_cast else enum explicit "
    "export extern false float for friend goto if inline int long mutable namespace new noexcept not not_eq "
    "nullptr operator or or_eq private protected public register reinterpret_cast restrict return short signed "
    "sizeof static static_assert static_cast struct switch template this thread_local throw true try typedef "
    "typeid typename union unsigned using virtual void volatile wchar_t while xor xor_eq"
)
_C_WORDS = frozenset(_C_KEYWORDS.split())
_FIELD_NAME = re.compile(r"(?!.*__)(?!.*_$)[a-z][a-z0-9_]*")
_CONSTANT_NAME = re.compile(r"[A-Z](_?[A-Z0-9])*")
_TYPE = re.compile(r"(?P<base>[^\[\]<]+)(?P<bound><=[^\[]*)?(?P<array>\[[^\]]*\])?")
_ARRAY = re.compile(r"\[(?:(?:<=)?[1-9]\d*)?\]")


@dataclass(frozen=True)
class Reference:
    """A field's message type in full, `PACKAGE/NAME`, and the definition's line that it is on."""

    type: str
    written: str
    line: int


@dataclass
class Reading:
    """What a definition refers to, and what is wrong in it. Lines are those of the definition's file."""

    references: list[Reference] = field(default_factory=list)
    faults: list[Fault] = field(default_factory=list)


def read(definition: Definition) -> Reading:
    """Read every line of a definition."""
    reading = Reading()
    _LineReader(definition, reading).read_all()
    return reading


class _LineReader:
    """Reads one definition line by line. A field's name must be unique in its part, between two `---`."""

    def __init__(self, definition: Definition, reading: Reading) -> None:
        self._definition = definition
        self._reading = reading
        self._line = 0
        self._names: dict[str, int] = {}
        #: Constants without a comment, in earlier parts and in this one -> line.
        self._bare: dict[tuple[str, str, str], int] = {}
        self._bare_here: dict[tuple[str, str, str], int] = {}
        self._commented = False
        self._at_top = True

    def read_all(self) -> None:
        separators = []
        for number, raw in enumerate(self._definition.text.splitlines(), start=self._definition.line):
            self._line = number
            if raw == "---":
                separators.append(self._line)
                self._begin_part()
            else:
                self._read(raw.replace("\t", " "))
        self._count(separators)

    def _begin_part(self) -> None:
        self._names = {}
        self._bare.update(self._bare_here)
        self._bare_here = {}
        self._commented, self._at_top = False, True

    def _count(self, separators: list[int]) -> None:
        kind, needed = self._definition.kind, KINDS[self._definition.kind]
        if len(separators) == needed:
            return
        self._line = separators[needed] if len(separators) > needed else self._definition.line
        parts = {"msg": "", "srv": "the request from the response", "action": "goal, result and feedback"}[kind]
        fix = f"Write {needed} line{'s' * (needed > 1)} with --- only, to separate {parts}."
        if not needed:
            fix = "A message has none: remove it. A request and a response belong in a .srv file."
        self._fault(
            f"a .{kind} file has {needed} line{'s' * (needed != 1)} with ---, and this one has {len(separators)}.", fix
        )

    def _fault(self, found: str, fix: str) -> None:
        self._reading.faults.append(Fault(self._definition.file, self._line, found, fix))

    def _read(self, raw: str) -> None:
        text, hash_sign, _ = raw.partition("#")
        text = text.strip()
        if not text:
            # Comments at the top of a part are about the part; others are about what follows.
            self._commented = bool(hash_sign) and not self._at_top
            self._at_top = self._at_top and bool(hash_sign)
            return
        commented, self._commented, self._at_top = self._commented or bool(hash_sign), False, False
        if text.strip("-") == "" and len(text) > 1:
            fix = "A separator is exactly three dashes at the left margin, with no space after them."
            self._fault(f"`{text}` is not a separator.", fix)
            return
        written, _, rest = text.partition(" ")
        rest = rest.strip()
        if not rest:
            self._fault(f"`{text}` has no name.", f"Write a type and a name, such as: {written} value")
        elif "=" in rest and not re.match(r"\w+\s+[\"'\[]", rest):
            name, value = (part.strip() for part in rest.split("=", 1))
            self._constant(written, name, value)
            if not commented:
                self._must_be_distinct(written, name, value)
        else:
            name, _, default = rest.partition(" ")
            self._field(raw, written, name, default.strip())

    def _constant(self, written: str, name: str, value: str) -> None:
        if written not in PRIMITIVES:
            found = f"the constant `{name}` has the type `{written}`."
            self._fault(found, f"A constant is one of {', '.join(PRIMITIVES)}; arrays and messages can't be constants.")
        elif not _CONSTANT_NAME.fullmatch(name):
            fix = f"Use capital letters, digits and single underscores: {_as_constant(name)}."
            fix += f" For a field with a default, leave out the `=`: {written} {_as_field(name)} {value}"
            self._fault(f"`{name}` can't be a constant's name.", fix)
        elif not value:
            self._fault(f"the constant `{name}` has no value.", f"Write it behind the `=`, such as: {written} {name}=1")
        elif self._is_new(name):
            self._value(written, name, value, "value")

    def _must_be_distinct(self, *constant: str) -> None:
        """Report equal constants: ROS's parser confuses two identical ones, and its C code does not compile."""
        written, name, value = constant
        if (written, name, value) in self._bare:
            found = f"`{name}={value}` is in line {self._bare[written, name, value]} too, and ROS 2 mixes the two up."
            self._fault(found, "Write a comment after one of them, so that they differ.")
        self._bare_here[written, name, value] = self._line

    def _field(self, raw: str, written: str, name: str, default: str) -> None:
        known = self._type(written)
        if not _FIELD_NAME.fullmatch(name):
            fix = f"Use lower-case letters, digits and single underscores, a letter first: {_as_field(name)}"
            if default and _CONSTANT_NAME.fullmatch(name):
                fix = f"For a constant, write a `=`: {written} {name}={default}. For a field: {_as_field(name)}"
            self._fault(f"`{name}` can't be a field's name.", fix)
        elif name in _C_WORDS or keyword.iskeyword(name):
            language = "C or C++" if name in _C_WORDS else "Python"
            found = f"`{name}` can't be a field's name: it is a reserved word of {language}."
            self._fault(found, f"Choose another name, such as `{name}_value`.")
        elif self._is_new(name) and known and default:
            self._default(raw, written, name, default)

    def _is_new(self, name: str) -> bool:
        if name in self._names:
            found = f"the name `{name}` is already taken in line {self._names[name]}."
            self._fault(found, "Rename or remove one of the two.")
            return False
        self._names[name] = self._line
        return True

    def _default(self, raw: str, written: str, name: str, default: str) -> None:
        if "#" in raw and (default.count('"') % 2 or default.count("'") % 2):
            found = f"the default of `{name}` has a # in it, and # begins a comment."
            self._fault(found, "ROS 2 has no way to write a # in a default: leave it out.")
        elif "=" in default:
            found = f"the default of `{name}` has a = in it, and ROS 2 takes such a line for a constant."
            self._fault(found, "Leave the = out of the default.")
        elif _base(written) not in PRIMITIVES:
            fix = "Only numbers, booleans, strings and arrays of them have defaults: remove it."
            self._fault(f"the field `{name}` is a message, and messages have no default (`{default}`).", fix)
        else:
            self._value(written, name, default, "default")

    def _value(self, written: str, name: str, value: str, what: str) -> None:
        # Also available if ROS 2 is sourced. Loaded when a value has to be checked.
        from rosidl_adapter.parser import Type, parse_value_string

        try:
            parsed = parse_value_string(Type(written), value)
        except Exception as error:  # the parser lets all kinds of exceptions through
            reason = str(error).partition(": ")[2] or f"expected a {written}"
            found = f"the {what} of `{name}` is `{value}`, which is not a valid {written}."
            self._fault(found, f"{reason[:1].upper()}{reason[1:]}." if reason else "Write another one.")
            return
        if not all(math.isfinite(each) for each in _elements(parsed) if isinstance(each, float)):
            found = f"the {what} of `{name}` is `{value}`, and ROS 2 accepts only finite numbers in a definition."
            self._fault(found, "Leave it out, and let the nodes set such a value.")

    def _type(self, written: str) -> bool:
        """Check a field's type, and note the message it refers to. Return whether the type is valid."""
        match = _TYPE.fullmatch(written)
        if match is None:
            return self._no_type(written, "Write a type such as float64, string, float64[] or geometry_msgs/Pose.")
        base, bound, array = match.group("base", "bound", "array")
        if array and not _ARRAY.fullmatch(array):
            return self._no_type(written, "Write an array as [], as [3] or as [<=3], with a whole number above 0.")
        if bound and (base not in ("string", "wstring") or not re.fullmatch(r"<=[1-9]\d*", bound)):
            return self._no_type(written, "Only strings have such a limit, a whole number above 0: string<=20.")
        if base not in PRIMITIVES:
            return self._message(written, base)
        return True

    def _message(self, written: str, base: str) -> bool:
        parts = base.split("/")
        if len(parts) == 3 and parts[1] == "msg":
            return self._no_type(written, f"Write {parts[0]}/{parts[2]}: fields name their types without /msg/.")
        if len(parts) == 3 and parts[1] in KINDS:
            return self._no_type(written, "A field can't be a service or an action: make a message of what it holds.")
        if base in _USUAL_MISTAKES and base[0].islower():
            return self._no_type(written, f"ROS 2 calls it {_USUAL_MISTAKES[base]}.")
        if base[0].islower() and (close := difflib.get_close_matches(base, PRIMITIVES, n=1, cutoff=0.75)):
            return self._no_type(written, f"Did you mean {close[0]}?")
        if len(parts) > 2 or not re.fullmatch(r"[A-Z][A-Za-z0-9]*", parts[-1]):
            fix = "A message's name begins with a capital letter and has letters and digits: geometry_msgs/Pose."
            return self._no_type(written, fix)
        package = parts[0] if len(parts) == 2 else self._definition.package
        self._reading.references.append(Reference(f"{package}/{parts[-1]}", base, self._line))
        return True

    def _no_type(self, written: str, fix: str) -> bool:
        self._fault(f"`{written}` is not a type.", fix)
        return False


def usual_name(written: str) -> str | None:
    """Return ROS 2's name of a type that is often written in another way, such as `Header`."""
    return _USUAL_MISTAKES.get(written)


def _base(written: str) -> str:
    return re.split(r"[\[<]", written, maxsplit=1)[0]


def _elements(value: object) -> list[object]:
    return value if isinstance(value, list) else [value]


def _as_constant(name: str) -> str:
    return "_".join(_words(name)).upper() or "VALUE"


def _as_field(name: str) -> str:
    return "_".join(_words(name)).lower() or "value"


def _words(name: str) -> Iterator[str]:
    """Yield the words of a name in any style, without the characters that a name can't have."""
    for word in re.findall(r"[A-Z]+(?![a-z])|[A-Z]?[a-z0-9]+", name):
        yield word.lstrip("0123456789") if not name[:1].isalpha() else word
