"""What becomes of public chapters: how many build, what their fences are, which of their programs run.

    python benchmarks/public_chapters/measure.py FOLDER            read and build, run nothing
    python benchmarks/public_chapters/measure.py FOLDER --run      run every notebook, too

FOLDER holds chapters (.md, .mdx), in folders as deep as they like; copies are put into a course in a scratch folder.
"""

from __future__ import annotations

import argparse
import json
import os
import shutil
import tempfile
import time
from collections import Counter
from collections.abc import Iterator
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

from spinbook.build.execution import NotebookJob, execute
from spinbook.build.notebooks import build_notebooks
from spinbook.chapter.classify import CellKind
from spinbook.chapter.imports import missing_imports
from spinbook.chapter.python_code import CodeError, PythonCode, inspect
from spinbook.chapter.read import ReadResult
from spinbook.chapters import read_all
from spinbook.course.course import Course, read_course
from spinbook.course.obstacles import ranked

_ENDINGS = {".md", ".mdx"}


@dataclass
class Counts:
    """What was counted. `complete` are programs with every name bound, `ready` those whose imports are here."""

    chapters: int = 0
    built: int = 0
    without_cells: int = 0
    tracebacks: int = 0
    node_fences: Counter[str] = field(default_factory=Counter)
    complete: int = 0
    ready: int = 0
    ready_cells: dict[tuple[str, int], str] = field(default_factory=dict)
    fragments: int = 0
    seconds: float = 0.0


def main() -> None:
    """Read the command line, measure, print."""
    reader = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    reader.add_argument("folder", type=Path)
    reader.add_argument("--run", action="store_true", help="run the notebooks")
    reader.add_argument("--deadline", type=float, default=240, help="seconds per notebook")
    reader.add_argument("--jobs", type=int, default=2 * (os.cpu_count() or 1), help="notebooks run at once")
    given = reader.parse_args()
    with tempfile.TemporaryDirectory(prefix="public-chapters-") as scratch:
        course = make_course(given.folder.resolve(), Path(scratch))
        counts = count(course)
        show(counts)
        if given.run:
            run(course, counts, given.jobs, given.deadline)


def make_course(folder: Path, scratch: Path) -> Course:
    """A course of copies of all chapters in `folder`."""
    chapters = []
    for file in sorted(path for path in folder.rglob("*") if path.is_file()):
        target = scratch / "chapters" / file.relative_to(folder)
        target.parent.mkdir(parents=True, exist_ok=True)
        shutil.copyfile(file, target)
        if file.suffix in _ENDINGS:
            chapters.append(target.relative_to(scratch).as_posix())
    listed = json.dumps(chapters)
    text = f'title = "Public chapters"\nchapters = {listed}\n[package]\nname = "course_nodes"\n'
    (scratch / "course.toml").write_text(text, encoding="utf-8")
    return read_course(scratch)


def count(course: Course) -> Counts:
    """Build each chapter, in CPU seconds of this process, and count."""
    counts = Counts(chapters=len(course.chapters))
    started = time.process_time()
    built = list(build_notebooks(course))
    counts.seconds = time.process_time() - started
    counts.built = sum(item.notebook.exists() and not item.failed for item in built)
    readings = list(read_all(course))
    for reading in readings:
        _count_chapter(course.root, reading, counts)
    print("\n".join(ranked([problem for item in built for problem in item.problems])[:14]), end="\n\n")
    return counts


def _count_chapter(root: Path, reading: ReadResult, counts: Counts) -> None:
    chapter = reading.chapter
    if chapter is None:
        return
    counts.without_cells += all(cell.kind in {CellKind.PROSE, CellKind.EXERCISE} for cell in chapter.cells)
    kinds = {cell.line: cell.kind for cell in chapter.cells if cell.kind is not CellKind.PROSE}
    static = {fence.line: fence.why for fence in chapter.static_fences}
    for cell in chapter.nodes:
        counts.fragments += bool(inspect(cell.whole).needs)
    lines = (root / chapter.file).read_text(encoding="utf-8", errors="replace").split("\n")
    for line, facts in programs(lines):
        unseen = "static" if {line, line + 1} & static.keys() else "not seen"
        shown = kinds[line + 1].value if line + 1 in kinds else unseen
        counts.node_fences[shown] += 1
        if facts.needs or not facts.imports or not facts.is_complete or facts.relative_imports:
            continue
        if facts.never_initialized:
            # A template that the reader fills in.
            continue
        counts.complete += 1
        if not missing_imports(facts, {}):
            counts.ready += 1
            counts.ready_cells[chapter.name, line + 1] = shown


def programs(lines: list[str]) -> Iterator[tuple[int, PythonCode]]:
    """The fences of Python that are ROS programs, found by their marks alone: (line, facts)."""
    opened: tuple[int, str, str] | None = None
    for number, line in enumerate(lines, start=1):
        text = line.strip().removeprefix("> ")
        if opened is None and text.startswith(("```python", "```py", "~~~python")):
            opened = number, text[:3], line[: len(line) - len(line.lstrip())]
        elif opened and text.startswith(opened[1]):
            first, _, indent = opened
            code = "\n".join(part.removeprefix(indent) for part in lines[first : number - 1]) + "\n"
            opened = None
            try:
                facts = inspect(code)
            except CodeError:
                continue
            if facts.is_node and not facts.fragment:
                yield first, facts


def show(counts: Counts) -> None:
    """Print the table."""
    total = sum(counts.node_fences.values())
    kinds = ", ".join(f"{number} {kind}" for kind, number in counts.node_fences.most_common())
    not_cells = {at: kind for at, kind in counts.ready_cells.items() if kind not in {"node", "part"}}
    print(f"chapters that build                      {counts.built} of {counts.chapters}")
    print(f"  of those, without a runnable cell      {counts.without_cells}")
    print(f"program fences                           {total}: {kinds}")
    print(f"node cells that use undefined names      {counts.fragments}")
    print(f"complete scripts; all imports available  {counts.complete}; {counts.ready}")
    print(f"  of those, no node cell                 {len(not_cells)} {list(not_cells.items())[:8]}")
    print(f"CPU seconds per 100 chapters             {100 * counts.seconds / max(counts.chapters, 1):.1f}")


def run(course: Course, counts: Counts, at_once: int, deadline_s: float) -> None:
    """Run every notebook; print the node cells that failed, and how many of the complete scripts ran."""
    built = [item for item in build_notebooks(course) if not item.failed]
    jobs = [NotebookJob(item.chapter, item.notebook, course.build_folder, deadline_s) for item in built]
    outcomes: Counter[str] = Counter()
    for executed in execute(jobs, at_once, lambda progress: None):
        name = executed.file.name.removesuffix(".ipynb")
        notebook = json.loads(executed.file.read_text(encoding="utf-8"))
        for cell in notebook["cells"]:
            outcome = _outcome(cell)
            if outcome:
                about = cell["metadata"]["spinbook"]
                outcomes[f"{about['kind']} {outcome}"] += 1
                if about["kind"] == "node" and (name, about["line"]) in counts.ready_cells:
                    outcomes[f"complete script {outcome}"] += 1
                if outcome == "failed":
                    print(f"  {executed.chapter}:{about['line']}: {about['kind']}: {_words(cell)}")
    for what, number in sorted(outcomes.items()):
        print(f"{what:40} {number}")


def _outcome(cell: dict[str, Any]) -> str:
    if cell["cell_type"] != "code":
        return ""
    if cell["execution_count"] is None:
        return "not reached"
    return "failed" if any(output["output_type"] == "error" for output in cell["outputs"]) else "ran"


def _words(cell: dict[str, Any]) -> str:
    printed = "".join("".join(o["text"]) for o in cell["outputs"] if o["output_type"] == "stream").strip()
    error = next(o for o in cell["outputs"] if o["output_type"] == "error")
    return f"{error['evalue'][:100]} | {printed.splitlines()[-1][:140] if printed else ''}"


if __name__ == "__main__":
    main()
