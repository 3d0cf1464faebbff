"""Runs the notebooks of a course, each in its own processes, and reports the cells that failed."""

from __future__ import annotations

import contextlib
import json
import os
import shutil
import sqlite3
import sys
import tempfile
import threading
import time
from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor, as_completed
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import nbformat
from nbformat.sign import NotebookNotary

import grader
from groundwork.files import json_object, write_if_changed
from interface_compiler import activation
from spinbook.build.digest import code_digest, digest, folders_digest, versions
from spinbook.build.failures import CellFailure, find_failures, find_node_errors, find_warnings
from spinbook.kernel.process import KeptProcess

#: The time limit of a notebook (s), and how much longer its process may take to report it.
DEADLINE_S = 600.0
_TO_SAY_SO_S = 20.0
#: The parts of Spinbook that a notebook's cells use.
_USED_BY_CELLS = ("chapter", "course", "graph", "kernel", "package", "interfaces")


@dataclass(frozen=True)
class ExecutionResult:
    """The result of one notebook. `file` has its outputs, even if cells failed."""

    chapter: Path
    file: Path
    failures: tuple[CellFailure, ...]
    seconds: float
    cached: bool
    warnings: tuple[CellFailure, ...] = ()
    """Cells that did not fail, but did not show what they should."""
    node_errors: tuple[CellFailure, ...] = ()
    """What went wrong in nodes, although their cells did not fail."""


@dataclass(frozen=True)
class NotebookProgress:
    """The progress of a notebook: `done` of `cells`."""

    chapter: Path
    done: int
    cells: int


@dataclass(frozen=True)
class NotebookJob:
    """One notebook to run. `chapter` is its source, for messages."""

    chapter: Path
    notebook: Path
    build_folder: Path
    deadline_s: float = DEADLINE_S

    @property
    def name(self) -> str:
        """The chapter's name; it may have dots."""
        return self.notebook.name.removesuffix(".ipynb")

    @property
    def executed(self) -> Path:
        """The path of the notebook with its outputs."""
        return self.build_folder / "executed" / self.notebook.name

    @property
    def graph(self) -> Path:
        """The path of the node graph that was recorded while it ran (spinbook.graph.model)."""
        return self.executed.with_name(f"{self.name}.graph.json")

    @property
    def record(self) -> Path:
        """The record of the last good run."""
        return self.build_folder / ".cache" / "executed" / f"{self.name}.json"

    @property
    def folder(self) -> Path:
        """The folder in which it runs."""
        return self.build_folder / "run" / self.name

    @property
    def raw(self) -> Path:
        """The path of the notebook with its outputs, as its process writes it."""
        return self.folder.with_name(f"{self.name}.ipynb")

    @property
    def raw_graph(self) -> Path:
        """The path of the node graph, as its process writes it."""
        return self.folder.with_name(f"{self.name}.graph.json")


def execute(
    jobs: Iterable[NotebookJob], at_once: int, on_progress: Callable[[NotebookProgress], None], *, again: bool = False
) -> Iterator[ExecutionResult]:
    """Run notebooks, this many at once, and yield each when it is done. A notebook whose code has not changed since a
    good run is not run, and gets that run's outputs. `again` runs it anyway.
    """
    pool = ThreadPoolExecutor(max_workers=max(1, at_once))
    given_up = threading.Event()
    try:
        running = [pool.submit(_execute_one, job, on_progress, again, given_up) for job in jobs]
        for future in as_completed(running):
            result = future.result()
            _trust(result.file)
            yield result
    finally:
        # Notebooks still run here only if the caller was interrupted: they end with it.
        given_up.set()
        pool.shutdown(wait=True, cancel_futures=True)


def _trust(file: Path) -> None:
    """Trust a notebook that ran here, as `jupyter trust` does. JupyterLab shows no SVG of others, only its description.

    Who can't write to Jupyter's folder at home reads the descriptions.
    """
    with contextlib.suppress(OSError, sqlite3.Error), NotebookNotary() as notary:
        notary.sign(nbformat.read(file, as_version=4))


def _execute_one(
    job: NotebookJob, on_progress: Callable[[NotebookProgress], None], again: bool, given_up: threading.Event
) -> ExecutionResult:
    notebook = json.loads(job.notebook.read_text(encoding="utf-8"))
    key = _key(notebook, job)
    if not again and (remembered := _remembered(job, key)) is not None:
        write_if_changed(job.executed, _with_outputs(notebook, remembered["outputs"]))
        _write_graph(job, remembered["graph"])
        return _result(job, json.loads(job.executed.read_text(encoding="utf-8")), [], 0.0, cached=True)
    started = time.monotonic()
    ended = _run(job, on_progress, given_up)
    ran = json_object(job.raw) or notebook
    failures = find_failures(job.chapter, ran, ended)
    outputs = {cell["id"]: _tidy(cell, job) for cell in ran["cells"] if cell["cell_type"] == "code"}
    write_if_changed(job.executed, _with_outputs(notebook, outputs))
    graph = job.raw_graph.read_text(encoding="utf-8") if job.raw_graph.exists() else None
    _write_graph(job, graph)
    _remove_raw(job)
    job.record.unlink(missing_ok=True)
    if not failures:
        write_if_changed(job.record, json.dumps({"key": key, "outputs": outputs, "graph": graph}))
    return _result(job, ran, failures, time.monotonic() - started)


def _result(
    job: NotebookJob, ran: dict[str, Any], failures: list[CellFailure], seconds: float, *, cached: bool = False
) -> ExecutionResult:
    warnings, errors = find_warnings(job.chapter, ran), find_node_errors(job.chapter, ran)
    return ExecutionResult(job.chapter, job.executed, tuple(failures), seconds, cached, tuple(warnings), tuple(errors))


def _remove_raw(job: NotebookJob) -> None:
    for file in (job.raw, job.raw_graph):
        file.unlink(missing_ok=True)


def _run(
    job: NotebookJob, on_progress: Callable[[NotebookProgress], None], given_up: threading.Event
) -> dict[str, Any]:
    """Run the notebook's process. Returns its last report of how it ended, {} if it ended well."""
    shutil.rmtree(job.folder, ignore_errors=True)
    job.folder.mkdir(parents=True)
    _remove_raw(job)
    # The path of a socket has to be short, so the build folder is not used.
    with tempfile.TemporaryDirectory(prefix="sb-", ignore_cleanup_errors=True) as sockets:
        return _follow(job, _start(job, sockets), on_progress, given_up)


def _start(job: NotebookJob, sockets: str) -> KeptProcess:
    private = {"IPYTHONDIR": str(job.folder / ".ipython"), "ROS_LOG_DIR": str(job.folder / ".ros-log")}
    words = (str(job.notebook), str(job.raw), str(job.raw_graph), str(job.deadline_s), sockets)
    argv = [sys.executable, "-m", "spinbook.build.run_notebook", *words]
    return KeptProcess(argv, {**os.environ, **private}, job.folder)


def _follow(
    job: NotebookJob, process: KeptProcess, on_progress: Callable[[NotebookProgress], None], given_up: threading.Event
) -> dict[str, Any]:
    """Report the progress of the notebook's process until it ends, or has to be ended."""
    deadline = time.monotonic() + job.deadline_s + _TO_SAY_SO_S
    cells, done, ended, output = 0, 0, {"crashed": ""}, ""
    try:
        while True:
            for line in process.read_lines():
                if not line.startswith("{"):
                    output += f"{line}\n"
                    continue
                message = json.loads(line)
                cells = message.get("cells", cells)
                on_progress(NotebookProgress(job.chapter, message.get("done", 0), cells))
                done = message.get("done", done)
                if not {"cells", "done"} & set(message):
                    ended = message
            if process.status.exit is not None:
                return ended if ended != {"crashed": ""} else {"crashed": output}
            if time.monotonic() > deadline or given_up.is_set():
                return {"timed_out": done}
            time.sleep(0.05)
    finally:
        if process.status.running:
            process.stop((1.0, 1.0))
            process.wait(10)
        process.close()


def _key(notebook: dict[str, Any], job: NotebookJob) -> str:
    """Return what the outputs depend on: the code, not the prose around it, and the files that `%check` uses."""
    code = [(c["id"], c["source"], c["metadata"].get("tags")) for c in notebook["cells"] if c["cell_type"] == "code"]
    judged_by = ""
    if any(source.startswith("%check ") for _, source, _ in code):
        course = job.build_folder.parent
        judging = folders_digest(Path(grader.__file__).parent, ".")
        judged_by = digest(folders_digest(course, "exercises", "solutions"), judging)
    interfaces = " ".join(prefix.name for prefix in activation.active())
    return digest(repr(code), judged_by, interfaces, code_digest(*_USED_BY_CELLS), versions())


def _remembered(job: NotebookJob, key: str) -> dict[str, Any] | None:
    record = json_object(job.record)
    return record if record.get("key") == key else None


def _write_graph(job: NotebookJob, graph: str | None) -> None:
    if graph is None:
        job.graph.unlink(missing_ok=True)
    else:
        write_if_changed(job.graph, graph)


def _with_outputs(notebook: dict[str, Any], outputs: dict[str, Any]) -> str:
    for cell in notebook["cells"]:
        if cell["cell_type"] == "code" and cell["id"] in outputs:
            cell.update(outputs[cell["id"]])
    return json.dumps(notebook, ensure_ascii=False, indent=1, sort_keys=True) + "\n"


def _tidy(cell: dict[str, Any], job: NotebookJob) -> dict[str, Any]:
    """Return a cell's outputs, without the folders of the machine that made them."""
    text = json.dumps(cell["outputs"])
    for folder, name in ((job.folder, "."), (Path(sys.prefix), ".venv")):
        text = text.replace(json.dumps(f"{folder}/")[1:-1], f"{name}/")
    return {"outputs": json.loads(text), "execution_count": cell["execution_count"]}
