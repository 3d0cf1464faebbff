"""Reads a chapter: the one entrance to this folder."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

from spinbook.chapter.cells import make_cells
from spinbook.chapter.chapter import Chapter, StaticFence
from spinbook.chapter.classify import Classified, FenceKind, classify
from spinbook.chapter.imports import missing_imports, unknown_executables
from spinbook.chapter.markdown import Outline, outline
from spinbook.chapter.source import Source, read_source
from spinbook.problem import Problem, Severity


@dataclass(frozen=True)
class Surroundings:
    """What a chapter may refer to outside itself.

    `package` is the course's ROS package, `modules` the node modules of the course's other chapters, `exercises`
    the exercises that exist, `interfaces` the messages, services and actions that the course defines, such as
    `my_robot_interfaces/msg/JointLimits`.
    """

    package: str
    modules: frozenset[str] = frozenset()
    exercises: frozenset[str] = frozenset()
    interfaces: frozenset[str] = frozenset()


@dataclass(frozen=True)
class Reading:
    """What came of reading a chapter's file: the chapter, unless an error stopped it, and all that is to be told."""

    chapter: Chapter | None
    problems: tuple[Problem, ...]


def read_chapter(root: Path, file: Path, surroundings: Surroundings) -> Reading:
    """Read the chapter at `root / file`. Never raises for what stands in it: every fault is a Problem."""
    source, problems = read_source(root / file, file)
    if source is None:
        return Reading(None, tuple(problems))
    outlined, outline_problems = outline(source.text, file)
    problems += outline_problems
    classified, fence_problems = _classify_all(outlined, file, interface_package(surroundings.package))
    problems += fence_problems
    problems += _two_of_one_name(classified, file)
    problems += _references(classified, outlined, surroundings, root, file)
    title, title_problems = _title(source, outlined, file)
    problems += title_problems
    problems.sort(key=lambda problem: (problem.line or 0, problem.found))
    if any(problem.is_error for problem in problems):
        return Reading(None, tuple(problems))
    chapter = Chapter(
        name=file.stem,
        file=file,
        title=title,
        summary=str(source.front_matter.get("summary", "")),
        cells=make_cells(source.text, outlined.spans, classified),
        static_fences=tuple(
            StaticFence(item.fence.line, item.fence.language, item.why)
            for item in classified
            if item.kind is FenceKind.STATIC
        ),
    )
    return Reading(chapter, tuple(problems))


def interface_package(package: str) -> str:
    """The package of the interfaces that chapters define, where the nodes' package is `package`."""
    return f"{package}_interfaces"


def _classify_all(outlined: Outline, file: Path, interfaces: str) -> tuple[list[Classified], list[Problem]]:
    classified: list[Classified] = []
    problems: list[Problem] = []
    defined: set[str] = set()
    for span in outlined.spans:
        if span.fence is None:
            continue
        item, found = classify(span.fence, defined, file, interfaces)
        classified.append(item)
        problems += found
        problems += _bad_seconds(item, file)
        if item.kind is FenceKind.SNIPPET and item.code:
            defined |= item.code.defines
    return classified, problems


def _bad_seconds(item: Classified, file: Path) -> list[Problem]:
    given = item.fence.attributes.get("seconds")
    if given is None:
        return []
    try:
        if 0 < float(given) <= 600:
            return []
    except ValueError:
        pass
    return [
        Problem(
            file,
            item.fence.line,
            f"`seconds={given}` is no time.",
            "Write a number of seconds, above 0 and up to 600.",
        )
    ]


def _two_of_one_name(classified: Sequence[Classified], file: Path) -> list[Problem]:
    first: dict[str, int] = {}
    problems = []
    for item in classified:
        if item.kind is not FenceKind.NODE or item.name is None:
            continue
        if item.name in first:
            found = f"a second node is called `{item.name}`; the first one stands in line {first[item.name]}."
            mend = "Give it another file name: starting one would stop the other, and the package can hold only one."
            problems.append(Problem(file, item.fence.line, found, mend))
        first.setdefault(item.name, item.fence.line)
    return problems


def _references(
    classified: Sequence[Classified], outlined: Outline, surroundings: Surroundings, root: Path, file: Path
) -> list[Problem]:
    nodes = {item.name for item in classified if item.kind is FenceKind.NODE and item.name}
    modules = frozenset(nodes) | surroundings.modules
    own = modules | {surroundings.package} | {name.partition("/")[0] for name in surroundings.interfaces}
    problems = []
    for item in classified:
        if item.kind is not FenceKind.STATIC:
            problems += missing_imports(item, own, file, surroundings.interfaces)
            problems += unknown_executables(item, surroundings.package, modules, file)
    for span in outlined.spans:
        if span.exercise and span.exercise not in surroundings.exercises:
            known = ", ".join(sorted(surroundings.exercises)) or "none yet"
            found = f"there is no exercise `{span.exercise}`."
            problems.append(Problem(file, span.start + 1, found, f"The folder exercises/ holds: {known}."))
    for target, line in outlined.links:
        path = target.partition("#")[0]
        if path and not (root / file.parent / path).exists():
            found = f"a link leads to `{target}`, and there is no such file."
            problems.append(
                Problem(file, line, found, "Write the path relative to the chapter's folder.", Severity.WARNING)
            )
    return problems


def _title(source: Source, outlined: Outline, file: Path) -> tuple[str, list[Problem]]:
    given = source.front_matter.get("title")
    if outlined.heading:
        return str(given or outlined.heading), []
    mend = "Begin it with one line such as `# Nodes and Topics`."
    severity = Severity.WARNING if given else Severity.ERROR
    return str(given or file.stem), [Problem(file, 1, "the chapter has no heading.", mend, severity)]
