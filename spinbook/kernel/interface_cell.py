"""`%%interface`: a message, a service or an action that this notebook defines, compiled if its text has changed."""

from __future__ import annotations

import time
from collections.abc import Sequence
from pathlib import Path

from interface_compiler import activation, prefixes, store
from interface_compiler.definition import CompileError, Definition, DefinitionError
from interface_compiler.near import current, make_current, use, use_near
from spinbook.chapter.fence import interface_path
from spinbook.chapter.installed_interfaces import is_someone_elses
from spinbook.kernel.session import Session
from spinbook.package.cell_line import CellFailed
from spinbook.package.workspace import write_interface_packages, written_definitions


def begin(session: Session) -> None:
    """Use what was compiled for the course, or by this notebook before."""
    use_near(Path.cwd())
    if prefix := current(_store(session)):
        use(prefix, _store(session))


def run(session: Session, title: str, text: str) -> None:
    """Define an interface: `title` is `msg/NAME.msg` or `PACKAGE/msg/NAME.msg`. Raises CellFailed."""
    own = f"{session.package.name}_interfaces"
    path = interface_path(title, own)
    if path is None:
        raise CellFailed(
            f"`{title}` is not an interface's name. Write msg/NAME.msg, srv/NAME.srv or action/NAME.action."
        )
    package, kind, file = path.split("/")
    if is_someone_elses(package, own):
        raise CellFailed(f"The package {package} is installed: choose another one for your own interfaces.")
    item = Definition(package, kind, file.rpartition(".")[0], text, Path(title))
    members = [item, *(other for other in _others(session, package) if other.full_name != item.full_name)]
    write_interface_packages(session.workspace, session.package, members)
    if store.is_installed(package, members, prefixes.installed()):
        print(f"{item.full_name}: ready.")
        return
    _compile(session, item)


def _others(session: Session, package: str) -> list[Definition]:
    """Return the package's other definitions: those that this notebook's cells have written, then those in use."""
    written = [item for item in written_definitions(session.workspace) if item.package == package]
    prefix = prefixes.prefix_of(package, prefixes.installed())
    if prefix is None:
        return written
    known = {item.full_name for item in written}
    used = (
        Definition(package, path.split("/")[0], Path(path).stem, text, Path(path))
        for path, text in prefixes.definitions_of(package, prefix).items()
    )
    return [*written, *(item for item in used if item.full_name not in known)]


def _compile(session: Session, item: Definition) -> None:
    began = time.monotonic()
    earlier = activation.active()
    try:
        compiled = store.ensure(_all(session, item), _store(session))
    except DefinitionError as error:
        raise CellFailed("\n".join(map(str, error.faults))) from None
    except CompileError as error:
        raise CellFailed(str(error)) from None
    (_store(session) / "COLCON_IGNORE").touch()
    make_current(_store(session), compiled.prefix)
    stale = activation.imported(compiled.packages, compiled.prefix)
    use(compiled.prefix, _store(session))
    how = f"compiled in {time.monotonic() - began:.1f} s" if compiled.fresh else "compiled before"
    print(f"{item.full_name}: {how}. In Python: from {item.package}.{item.kind} import {item.name}")
    _say_what_is_stale(session, stale, item.package, had_one=bool(earlier) or bool(stale))


def _all(session: Session, item: Definition) -> list[Definition]:
    """Return every definition of the workspace, the new one with the cell's path, so that faults name the cell."""
    return [item, *(other for other in written_definitions(session.workspace) if other.full_name != item.full_name)]


def _say_what_is_stale(session: Session, stale: Sequence[str], package: str, *, had_one: bool) -> None:
    nodes = [name for name in session.nodes.names() if package in session.ran.get(name, "")]
    if had_one and nodes:
        print(f"Run the cells of these nodes again; they still use the old text: {', '.join(nodes)}.")
    if stale:
        print(f"This kernel has imported {', '.join(stale)} already: restart it to use the new text in its own cells.")


def _store(session: Session) -> Path:
    """Return the folder of this notebook's compiled interfaces: hidden, because colcon skips hidden folders."""
    return session.workspace / ".interfaces"
