"""Decides what each piece of a chapter's Python becomes: a node, a snippet, a part of a program, or only shown."""

from __future__ import annotations

import ast
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

from groundwork.problem import Problem, Severity
from groundwork.words import did_you_mean
from spinbook.chapter.classify import CellKind, ClassifiedFence, node_name
from spinbook.chapter.complete_program import CompleteProgram, join, usual_import
from spinbook.chapter.imports import MissingPackage, missing_imports
from spinbook.chapter.node_classes import init_returns_nothing, needs_arguments, node_attributes, snake_case
from spinbook.chapter.node_versions import NodeVersions
from spinbook.chapter.python_code import PythonCode, inspect
from spinbook.chapter.syntax import syntax_tree
from spinbook.chapter.wrong_fields import wrong_fields


@dataclass
class Programs:
    """The Python of one chapter, decided fence by fence in order.

    `own` are the packages that are not installed but made by the course, each with its modules; `named_files` has the
    file that the text before a fence names, by the fence's line; `interfaces` are those that the course defines.
    """

    file: Path
    own: Mapping[str, frozenset[str]]
    named_files: Mapping[int, str]
    interfaces: frozenset[str] = frozenset()
    problems: list[Problem] = field(default_factory=list)
    _pieces: list[int] = field(default_factory=list)
    _defined: set[str] = field(default_factory=set)
    _versions: NodeVersions = field(default_factory=NodeVersions)
    _used: dict[int, tuple[int, ...]] = field(default_factory=dict)
    _undefined_names: dict[str, int] = field(default_factory=dict)
    """Names that snippets use and nothing above defines -> line. A snippet that uses `self` is a piece of a class."""
    _has_ros: bool = False
    """Whether snippets above have started ROS in the notebook's kernel."""

    def decide(self, items: Sequence[ClassifiedFence]) -> list[ClassifiedFence]:
        """Decide what each fence becomes; fences without Python stay as they are."""
        out = list(items)
        for number, item in enumerate(items):
            in_kernel = self._goes_on_in_kernel(item) or self._is_gone_on_with(item, items[number + 1 :])
            if item.kind is CellKind.NODE and not in_kernel:
                out[number] = self._node(number, item, out)
            elif item.kind in {CellKind.NODE, CellKind.SNIPPET}:
                out[number] = self._snippet(item)
            if item.code and not item.code.is_setup_script and not item.code.is_launch_file:
                self._pieces.append(number)
        out = _with_parts(out, self._used)
        self.problems += [*_without_file_name(self.file, out), *_without_definition(self.file, self._undefined_names)]
        return out

    def _goes_on_in_kernel(self, item: ClassifiedFence) -> bool:
        """Return whether code spins for a while what snippets above have made, as in a notebook."""
        code = item.code
        is_piece = code is not None and set(code.needs) <= self._defined and not (code.initializes or code.node_classes)
        return self._has_ros and is_piece and "rclpy.spin(" not in item.fence.code and not item.fence.is_file

    def _is_gone_on_with(self, item: ClassifiedFence, below: Iterable[ClassifiedFence]) -> bool:
        """Return whether snippets below use what code made that ends at once, as the cells of a notebook do."""
        code = item.code
        if code is None or self._has_ros or code.spins or code.loops or code.needs or item.fence.is_file:
            return False
        made = code.defines - set(code.node_classes) if code.initializes and not code.has_main else frozenset()
        snippets = (other.code for other in below if other.kind is CellKind.SNIPPET and other.code)
        return any(made & set(snippet.needs) for snippet in snippets)

    def _node(self, number: int, item: ClassifiedFence, out: Sequence[ClassifiedFence]) -> ClassifiedFence:
        code = item.code
        assert code is not None
        joined = self._joined(item.fence.code, code, out)
        # One that is meant to fail runs, whatever is wrong with it.
        refused = None if item.fence.has("raises") else self._not_run(item, code, joined)
        return refused or self._made(number, item, code, joined)

    def _not_run(self, item: ClassifiedFence, code: PythonCode, joined: CompleteProgram) -> ClassifiedFence | None:
        """Return the fence as a static one, with the reason; None if it can run."""
        if joined.missing:
            return self._undefined(item, code, joined.missing)
        if code.with_init and init_returns_nothing():
            why = "`with rclpy.init():` needs ROS 2 Kilted or newer"
            self._report(item, code.with_init, f"{why}, and rclpy here is older.", _INIT_ALONE)
            return _static(item, why)
        if code.never_initialized:
            name, line = next(iter(code.never_initialized.items()))
            why = f"`{name}.__init__` never calls `super().__init__(…)`"
            self._report(item, line, f"{why}, so nothing of this node works.", _INIT_OF_NODE)
            return _static(item, why)
        if code.wants_ros and not _facts(joined, code).initializes:
            if code.is_complete and code.imports:
                problem = "nothing calls `rclpy.init` before this, so the program would fail."
                self._report(item, code.wants_ros, problem, f"Call `rclpy.init()` first, {_ONLY_A_PIECE}")
            return _static(item, _WITHOUT_INIT)
        if reason := _why_fragment(item, code, joined):
            return _static(item, f"it is a fragment: {reason}")
        if code.lacking and code.is_complete and not joined.amends:
            self._lacking(item, code)
            if code.fails_at_once:
                return _static(item, f"`self.{code.fails_at_once}` is never set in it")
        missing = missing_imports(_facts(joined, code), self.own, self.interfaces)
        return self._missing(item, missing, joined) if missing else None

    def _made(self, number: int, item: ClassifiedFence, code: PythonCode, joined: CompleteProgram) -> ClassifiedFence:
        self._check_fields(item, joined.before)
        if joined.used:
            self._used[number] = tuple(self._pieces[i] for i in joined.used)
        return replace(self._named(item, code, joined), before=joined.before, has_main_above=joined.has_main_above)

    def _joined(self, text: str, code: PythonCode, out: Sequence[ClassifiedFence]) -> CompleteProgram:
        is_class = bool(code.node_classes) and not code.is_complete
        if not (code.needs or code.lacking or code.nameless or is_class):
            return CompleteProgram(text)
        return join(text, [out[i].fence.code for i in self._pieces])

    def _snippet(self, item: ClassifiedFence) -> ClassifiedFence:
        code = item.code
        assert code is not None
        item = replace(item, kind=CellKind.SNIPPET)
        missing = [name for name in code.needs if name not in self._defined]
        if item.fence.has("raises"):
            return item
        if missing and all(map(usual_import, missing)):
            before = "".join(f"{line}\n" for line in dict.fromkeys(map(usual_import, missing)))
            item, code, missing = replace(item, before=f"{before}\n"), inspect(f"{before}\n{item.fence.code}"), []
        if missing:
            names = ", ".join(f"`{name}`" for name in missing)
            if "self" not in missing:
                first = missing[0]
                self._undefined_names[first] = item.fence.first_code_line + code.needs[first] - 1
            reason = f"it uses {names}, which no snippet that runs above defines"
            return _static(item, reason, f"{reason}.")
        starts_ros = code.initializes and code.starts_ros
        if code.leaves or (code.wants_ros and not code.initializes and not self._has_ros):
            return _static(item, code.leaves or _WITHOUT_INIT)
        if starts_ros and (self._has_ros or "rclpy" not in code.imports or item.before):
            return _static(item, "it is a piece of a program")
        if absent := missing_imports(code, self.own, self.interfaces):
            return self._missing(item, absent, CompleteProgram(item.fence.code, item.before))
        self._defined |= code.defines
        self._has_ros = (starts_ros or self._has_ros) and "rclpy.shutdown()" not in item.fence.code
        self._check_fields(item, item.before)
        return item

    def _undefined(self, item: ClassifiedFence, code: PythonCode, missing: Mapping[str, int]) -> ClassifiedFence:
        names = ", ".join(f"`{name}`" for name in missing)
        verb = "is" if len(missing) == 1 else "are"
        if code.is_complete and code.imports:
            problem = f"{names} {verb} defined neither here nor above, so this program would fail."
            self._report(item, min(missing.values()), problem, f"Define or import it, {_ONLY_A_PIECE}")
        return _static(item, f"it uses {names}, which nothing above defines")

    def _check_fields(self, item: ClassifiedFence, before: str) -> None:
        """Report fields that messages do not have, in the fence itself, unless its failing is meant."""
        if item.fence.has("raises") or item.fence.has("expect-error"):
            return
        above = before.count("\n")
        for wrong in wrong_fields(before + item.fence.code):
            if wrong.line > above:
                self._report(item, wrong.line - above, wrong.problem, wrong.fix, Severity.WARNING)

    def _report(
        self, item: ClassifiedFence, line: int, problem: str, fix: str, severity: Severity = Severity.NOT_RUN
    ) -> None:
        """Report what is wrong in a line of a fence's code, counted from 1."""
        at = item.fence.first_code_line + line - 1
        self.problems.append(Problem(self.file, at, problem, fix, severity))

    def _lacking(self, item: ClassifiedFence, code: PythonCode) -> None:
        name = code.fails_at_once or next(iter(code.lacking))
        meant = did_you_mean(name, node_attributes() | code.defines, "", "`self.{}`", 0.8)
        fix = f"{meant} Set it in `__init__`, or check its name: the node fails where it is used.".lstrip()
        severity = Severity.NOT_RUN if code.fails_at_once else Severity.WARNING
        self._report(item, code.lacking[name], f"`self.{name}` is used but never set.", fix, severity)

    def _missing(
        self, item: ClassifiedFence, missing: Sequence[MissingPackage], joined: CompleteProgram
    ) -> ClassifiedFence:
        above = joined.before.count("\n")
        packages = list(dict.fromkeys(absent.package for absent in missing))
        alone = len(packages) == 1
        for absent in missing:
            line = item.fence.first_code_line + max(absent.line - above, 1) - 1
            self.problems.append(
                Problem(self.file, line, absent.problem, absent.fix, Severity.NOT_RUN, absent.package, alone)
            )
        names = ", ".join(f"`{name}`" for name in packages)
        if packages == ["relative imports"]:
            return _static(item, "it imports relative to a package")
        verb = "is" if alone else "are"
        return _static(item, f"it needs {names}, which {verb} not installed", f"it needs {names}, not installed here.")

    def _named(self, item: ClassifiedFence, code: PythonCode, joined: CompleteProgram) -> ClassifiedFence:
        """Name a node's cell. A file shown again keeps its name, and so does a node, which is then a newer version."""
        name, named, problems = node_name(item, self.named_files.get(item.fence.line, ""), self.file)
        self.problems += problems
        earlier = self._versions.of(code, joined.whole)
        if not named:
            name = earlier or self._versions.free_name(name, code)
        if name in self.own:
            # Otherwise an import would find the package's folder instead.
            name = f"{name}_node"
        self._versions.add(name, code, joined.whole)
        return replace(item, name=name, named=named, replaces=earlier if earlier != name else "")


#: What to do about a program that would fail.
_ONLY_A_PIECE = "or write `static` after the language if this is only a piece of a program."
_INIT_ALONE = "Call `rclpy.init()` in a line of its own, and `rclpy.try_shutdown()` at the end; this works everywhere."
_INIT_OF_NODE = "Call it first, with the node's name, or write `static` after the language if this is a template."
_WITHOUT_INIT = "nothing calls `rclpy.init` before it"


def _why_fragment(item: ClassifiedFence, code: PythonCode, joined: CompleteProgram) -> str:
    """Return what keeps a class without a main from being a program; empty if nothing does."""
    if code.does_nothing and not item.fence.is_file:
        return "nothing calls what it defines"
    if code.is_complete or not code.node_classes or code.calls_main or joined.has_main_above:
        return ""
    if code.initializes and set(code.node_classes) - set(code.alone):
        # A script that makes its node, and ends.
        return ""
    if code.lacking and not joined.amends:
        names = ", ".join(f"`self.{name}`" for name in list(code.lacking)[:3])
        return f"{names} {'is' if len(code.lacking) == 1 else 'are'} never set in it"
    is_piece = not code.alone or (bool(code.nameless) and not joined.amends)
    if (is_piece and not item.fence.is_file) or _needs_arguments(joined):
        return "nothing makes a node of its class"
    if code.uncalled and not item.fence.is_file:
        return f"nothing calls `{code.uncalled}`, which spins"
    return ""


def _facts(joined: CompleteProgram, code: PythonCode) -> PythonCode:
    return inspect(joined.whole) if joined.before else code


def _needs_arguments(joined: CompleteProgram) -> bool:
    """Return whether the class that the code extends can't be created without arguments."""
    above = syntax_tree(joined.before).body if joined.amends else []
    classes = [item for item in above if isinstance(item, ast.ClassDef) and item.name == joined.amends]
    return bool(classes) and needs_arguments(classes[-1])


def _static(item: ClassifiedFence, why: str, sign: str = "") -> ClassifiedFence:
    return replace(item, kind=CellKind.STATIC, why=why, sign=sign or f"{why}.")


def _with_parts(items: list[ClassifiedFence], used: Mapping[int, Iterable[int]]) -> list[ClassifiedFence]:
    """Name the pieces that complete later nodes, and turn those that are not programs by themselves into parts."""
    out = list(items)
    needed = {i for number, pieces in used.items() if out[number].kind is CellKind.NODE for i in pieces}
    names: dict[int, str] = {}
    taken: set[str | None] = {item.name for item in items if item.name}
    for number in sorted(needed):
        item = out[number]
        if item.kind is CellKind.NODE and _goes_on(number, used, out):
            # `--after` names parts and earlier versions of nodes.
            is_shared = any(other.name == item.name for other in items if other is not item)
            name = f"{item.name}_part" if is_shared else item.name
            out[number] = replace(item, kind=CellKind.PART, name=name, runs_in_kernel=False)
        elif item.kind is not CellKind.NODE:
            runs = item.kind is CellKind.SNIPPET
            name = _part_name(item, taken)
            out[number] = replace(item, kind=CellKind.PART, name=name, runs_in_kernel=runs, why="", sign="")
        names[number] = out[number].name or ""
        taken.add(names[number])
    for number, pieces in used.items():
        if out[number].kind in {CellKind.NODE, CellKind.PART}:
            after = tuple(dict.fromkeys(names[i] for i in pieces if i in names))
            out[number] = replace(out[number], after=after)
    return out


def _goes_on(number: int, used: Mapping[int, Iterable[int]], items: Sequence[ClassifiedFence]) -> bool:
    """Return whether a class without a main, or the beginning of a script, is completed further down."""
    code = items[number].code
    if code is None or code.has_main or code.has_main_guard or code.spins or code.loops:
        return False
    for later, pieces in used.items():
        item = items[later]
        # A later program that only shares its imports leaves it a node of its own.
        takes_class = not code.node_classes or any(f"class {name}(" in item.before for name in code.node_classes)
        if number in pieces and item.kind is CellKind.NODE and item.code and item.code.is_complete and takes_class:
            return True
    return False


def _part_name(item: ClassifiedFence, taken: set[str | None]) -> str:
    """Return a name for a part: its class's, otherwise that of another name that it defines."""
    code = item.code or PythonCode()
    names = sorted(code.defines)
    is_imports = code.imports and set(names) <= _imported(code)
    base = "imports" if is_imports else snake_case((code.own_classes or names or ["part"])[0])
    free = (name for name in (base, *(f"{base}_{count}" for count in range(2, len(taken) + 3))) if name not in taken)
    return next(free)


def _without_file_name(file: Path, items: Sequence[ClassifiedFence]) -> list[Problem]:
    """Return one warning for all nodes of a chapter whose file its author did not name."""
    nodes = [item for item in items if item.kind is CellKind.NODE and not item.named]
    if not nodes:
        return []
    names = ", ".join(f"`{item.name}` (line {item.fence.line})" for item in nodes)
    which = "a node has no file name; it is called" if len(nodes) == 1 else "nodes have no file name; they are called"
    fix = f'Name the file: ```python title="{nodes[0].name}.py"'
    return [Problem(file, nodes[0].fence.line, f"{which} {names}.", fix, Severity.WARNING, group="a file name")]


def _without_definition(file: Path, names: Mapping[str, int]) -> list[Problem]:
    """Return one warning for all snippets of a chapter that use a name that nothing defines."""
    if not names:
        return []
    listed = ", ".join(f"`{name}` (line {line})" for name, line in names.items())
    what = "a snippet is" if len(names) == 1 else "snippets are"
    problem = f"{what} shown and not run, because no snippet that runs above defines {listed}."
    fix = "Define it in a snippet above or import it, or write `static` after the language if it is only to be shown."
    return [Problem(file, min(names.values()), problem, fix, Severity.WARNING, group="a definition")]


def _imported(code: PythonCode) -> set[str]:
    return {name for _, name in code.interfaces} | {name.partition(".")[0] for name in code.imports} | {"np", "plt"}
