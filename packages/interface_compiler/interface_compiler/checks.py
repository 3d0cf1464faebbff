"""Everything that can be wrong in definitions, found before anything is generated."""

from __future__ import annotations

import difflib
import re
from collections.abc import Iterator, Mapping, Sequence
from graphlib import CycleError, TopologicalSorter

from interface_compiler import shipped
from interface_compiler.definition import Definition, Fault, by_package
from interface_compiler.grammar import Reading, Reference, read, usual_name

#: ROS's rule for the names of packages (REP 144), and that for the names of interfaces.
_PACKAGE = re.compile(r"(?!.*__)(?!.*_$)[a-z][a-z0-9_]*")
_NAME = re.compile(r"[A-Z][A-Za-z0-9]*")
#: Package -> its interfaces as `msg/String`.
Known = Mapping[str, frozenset[str]]


def check(definitions: Sequence[Definition], known: Known) -> list[Fault]:
    """Return what is wrong in definitions that are to be compiled together, sorted by file and line.

    `known` are the packages that are installed.
    """
    readings = {definition: read(definition) for definition in definitions}
    known = {**known, **_own(definitions)}
    faults = [fault for reading in readings.values() for fault in reading.faults]
    for definition, reading in readings.items():
        faults += _names(definition)
        faults += [fault for reference in reading.references for fault in _unknown(reference, definition, known)]
    faults += _same_names(definitions)
    faults += _circles(readings)
    faults += _package_circles(definitions, readings)
    return sorted(faults, key=lambda fault: (str(fault.file), fault.line or 0, fault.problem))


def dependencies(definitions: Sequence[Definition]) -> dict[str, set[str]]:
    """Return package -> the other packages that its definitions need, for valid definitions."""
    needed = {}
    for package, members in by_package(definitions).items():
        found = {reference.type.split("/")[0] for member in members for reference in read(member).references}
        kinds = {member.kind for member in members}
        # What the generators add to services and actions.
        found |= {"service_msgs", "builtin_interfaces"} if kinds & {"srv", "action"} else set()
        found |= {"action_msgs", "unique_identifier_msgs"} if "action" in kinds else set()
        needed[package] = found - {package}
    return needed


def in_order(definitions: Sequence[Definition]) -> list[str]:
    """Return the packages, each after those that it needs."""
    own = by_package(definitions)
    needed = dependencies(definitions)
    return list(TopologicalSorter({package: sorted(needed[package] & own.keys()) for package in own}).static_order())


def _own(definitions: Sequence[Definition]) -> dict[str, frozenset[str]]:
    packages = by_package(definitions)
    return {
        package: frozenset(f"{member.kind}/{member.name}" for member in members)
        for package, members in packages.items()
    }


def _names(definition: Definition) -> Iterator[Fault]:
    if not _PACKAGE.fullmatch(definition.package):
        fix = "Use lower-case letters, digits and single underscores, a letter first: my_robot_interfaces."
        yield Fault(definition.file, definition.title_line, f"`{definition.package}` can't be a package's name.", fix)
    if not _NAME.fullmatch(definition.name):
        words = re.findall(r"[A-Za-z0-9]+", definition.name)
        better = "".join(word[:1].upper() + word[1:] for word in words) or "JointLimits"
        fix = f"Begin with a capital letter, then letters and digits: {better}.{definition.kind}"
        yield Fault(definition.file, definition.title_line, f"`{definition.name}` can't be an interface's name.", fix)


def _unknown(reference: Reference, definition: Definition, known: Known) -> Iterator[Fault]:
    package, name = reference.type.split("/")
    if f"msg/{name}" in known.get(package, ()):
        return
    place = (definition.file, reference.line)
    if package not in known:
        if remedy := shipped.how_to_add(package):
            yield Fault(*place, f"`{reference.written}` needs the package {package}, which is not installed.", remedy)
            return
        having = [owner for owner, names in known.items() if f"msg/{name}" in names]
        close = difflib.get_close_matches(package, having, n=1)
        fix = f"Did you mean {close[0]}/{name}?" if close else "Install it, or add its definitions to interfaces/."
        yield Fault(*place, f"`{reference.written}`: there is no package `{package}`.", fix)
    elif f"srv/{name}" in known[package] or f"action/{name}" in known[package]:
        fix = "A field is a number, a string or a message: make a message of what it should hold."
        yield Fault(*place, f"`{reference.written}` is a service or an action, not a message.", fix)
    else:
        yield Fault(*place, f"there is no message `{reference.type}`.", _similar(reference, package, name, known))


def _similar(reference: Reference, package: str, name: str, known: Known) -> str:
    if better := usual_name(reference.written):
        return f"Write {better}."
    elsewhere = sorted(f"{owner}/{name}" for owner, names in known.items() if f"msg/{name}" in names)
    if elsewhere:
        return f"Did you mean {' or '.join(elsewhere[:3])}?"
    own = [entry[4:] for entry in known[package] if entry.startswith("msg/")]
    if close := difflib.get_close_matches(name, own, n=1):
        return f"Did you mean {close[0]}?"
    return f"{package} has {', '.join(sorted(own)[:6]) or 'no messages'}."


def _same_names(definitions: Sequence[Definition]) -> Iterator[Fault]:
    """Find definitions that would write the same file: with the same name, or names that differ in capitals only."""
    first: dict[tuple[str, str, str], Definition] = {}
    for definition in definitions:
        known = first.setdefault((definition.package, definition.kind, definition.name.lower()), definition)
        if known is not definition and (known.name != definition.name or known.text != definition.text):
            place = f"{known.file}:{known.line}"
            found = f"`{definition.full_name}` is defined in {place} too, with another text."
            fix = "Give one of them another name, or make the two texts the same."
            yield Fault(definition.file, definition.line, found, fix)


def _circles(readings: Mapping[Definition, Reading]) -> Iterator[Fault]:
    """Find messages that contain themselves."""
    messages = {f"{item.package}/{item.name}": item for item in readings if item.kind == "msg"}
    graph = {name: {ref.type for ref in readings[item].references} & messages.keys() for name, item in messages.items()}
    while cycle := _cycle(graph):
        item = messages[cycle[0]]
        line = next(ref.line for ref in readings[item].references if ref.type == cycle[1])
        found = f"`{cycle[0]}` contains itself: {' -> '.join(cycle)}."
        yield Fault(item.file, line, found, "A message can't contain itself: remove one of these fields.")
        # Without that field, to find the next circle.
        graph[cycle[0]] = graph[cycle[0]] - {cycle[1]}


def _package_circles(definitions: Sequence[Definition], readings: Mapping[Definition, Reading]) -> Iterator[Fault]:
    own = by_package(definitions)
    needed = {
        package: {ref.type.split("/")[0] for member in members for ref in readings[member].references}
        for package, members in own.items()
    }
    graph = {package: (names & own.keys()) - {package} for package, names in needed.items()}
    if cycle := _cycle(graph):
        for member in own[cycle[0]]:
            for ref in readings[member].references:
                if ref.type.split("/")[0] == cycle[1]:
                    found = f"packages that need one another: {' -> '.join(cycle)}."
                    fix = "Put what both need into one package."
                    yield Fault(member.file, ref.line, found, fix)
                    return


def _cycle(graph: Mapping[str, set[str]]) -> list[str] | None:
    """Return names in a cycle, the first one again at the end, each needing the next; None if there is no cycle."""
    try:
        TopologicalSorter({name: sorted(names) for name, names in sorted(graph.items())}).prepare()
    except CycleError as error:
        # graphlib lists each before the one that needs it.
        return list(reversed(error.args[1]))
    return None
