"""In which sandboxes students' programs can be run here."""

from __future__ import annotations

from spinbook.doctor.finding import Finding, missing, ok, warning

_ALLOW = (
    "Install bubblewrap (sudo apt-get install bubblewrap) and allow namespaces (see the finding about them); "
    "docs/installing.md tells how in a container."
)


def examine(name: str) -> Finding:
    """Ask the grader, which runs a program in each of its sandboxes."""
    try:
        from grader.sandbox import Isolation, available
    except ImportError as error:
        return missing(name, f"the grader does not load: {error}", "Make the environment anew: make setup")
    levels = available()
    strong = [level for level in (Isolation.BUBBLEWRAP, Isolation.NAMESPACES) if levels[level] is None]
    reasons = "; ".join(f"{level}: {reason}" for level, reason in levels.items() if reason)
    works = ", ".join(str(level) for level in levels if levels[level] is None and level is not Isolation.NONE)
    if strong:
        return ok(name, works + (f" ({reasons})" if reasons else ""))
    if levels[Isolation.LANDLOCK] is None:
        return warning(
            name,
            f"landlock only ({reasons})",
            f"It denies students' code files, processes and the network, but not every user's Unix sockets. {_ALLOW}",
        )
    return missing(name, f"none ({reasons})", f"Students' code is not run unprotected. {_ALLOW}")
