"""`%load_ext spinbook`: gives a notebook its commands and its own ROS domain, and ends its nodes cleanly."""

from __future__ import annotations

import atexit
import os
import sysconfig
import warnings
from collections.abc import Iterator
from types import TracebackType
from typing import Any

from IPython.display import display

from groundwork.clean_environment import without_foreign
from groundwork.plain_text import print_in_any_encoding
from spinbook.kernel import environment, magics
from spinbook.kernel import environment as domain
from spinbook.kernel.node_errors import ERROR
from spinbook.kernel.process import KeptProcess
from spinbook.kernel.session import Session
from spinbook.kernel.spin_in_cell import SpinInCell

#: The domain to share with other programs, instead of the notebook's own.
DOMAIN_VARIABLE = "SPINBOOK_DOMAIN"
#: The time in which the nodes have to end when the kernel ends (s).
_FAREWELL_S = 2.0


def load(shell: Any) -> None:
    """Set up a notebook; loading twice changes nothing."""
    if getattr(shell, "spinbook_session", None) is not None:
        return
    _leave_other_installations()
    print_in_any_encoding()  # IPython in a terminal
    if name := environment.missing_middleware(os.environ):
        warnings.warn(
            f"RMW_IMPLEMENTATION names {name}, which is not installed here; the notebook uses the default middleware.",
            stacklevel=2,
        )
        del os.environ["RMW_IMPLEMENTATION"]
    asked_for = os.environ.get(DOMAIN_VARIABLE, "")
    session = Session(domain.shared_domain(int(asked_for)) if asked_for.isdigit() else domain.claim_domain())
    shell.spinbook_session = session
    magics.register(shell, session)
    shell.events.register("pre_run_cell", lambda info: _begin_cell(session))
    shell.events.register("post_run_cell", lambda result: report_errors(session))
    shell.set_custom_exc((Exception, KeyboardInterrupt), _show_own_frames)
    session.silent.watch(shell)
    shell.events.register("pre_run_cell", SpinInCell(session.ran).before_cell)
    _find_scripts()
    atexit.register(farewell, session)


def _leave_other_installations() -> None:
    """Let everything that this notebook starts use this installation's modules and libraries, and say so."""
    before = dict(os.environ)
    clean = without_foreign(before)
    removed = {name: value for name, value in before.items() if clean.get(name) != value}
    os.environ.update(clean)
    for name in before.keys() - clean.keys():
        del os.environ[name]
    for name in removed.keys() & {"PYTHONPATH", "AMENT_PREFIX_PATH"}:
        print(f"Nodes and checks of this notebook do not use {name}={removed[name]}, which is of another installation.")


def _begin_cell(session: Session) -> None:
    session.run_here.clear()
    report_errors(session)


def report_errors(session: Session) -> None:
    """Show what has gone wrong in the notebook's nodes and threads since the last call."""
    for error in session.new_errors():
        display({"text/plain": error.in_words}, raw=True, metadata={ERROR: error.plain})


def _show_own_frames(
    shell: Any, kind: type[BaseException], error: BaseException, frames: TracebackType, tb_offset: int | None = None
) -> None:
    """Show an exception with the frames of cells only, if it has any."""
    own = None
    for frame in reversed(list(_each(frames))):
        if _is_of_cell(frame):
            own = TracebackType(own, frame.tb_frame, frame.tb_lasti, frame.tb_lineno)
    shell.showtraceback((kind, error, own or frames), tb_offset=0 if own else tb_offset)


def _each(first: TracebackType) -> Iterator[TracebackType]:
    frame: TracebackType | None = first
    while frame is not None:
        yield frame
        frame = frame.tb_next


def _is_of_cell(frame: TracebackType) -> bool:
    file = frame.tb_frame.f_code.co_filename
    return "ipykernel_" in file and "site-packages" not in file


def _find_scripts() -> None:
    """Let `!ros2` and `%%bash` find this environment's programs: the kernel may run without the environment being
    activated.
    """
    folders = os.environ.get("PATH", os.defpath).split(os.pathsep)
    if (scripts := sysconfig.get_path("scripts")) not in folders:
        os.environ["PATH"] = os.pathsep.join([*folders, scripts])


def farewell(session: Session) -> None:
    """End every node, as gently as a kernel's end allows."""
    if session.timeline is not None:
        session.timeline.close()
    processes: list[KeptProcess] = [node.process for name in session.nodes.names() if (node := session.nodes.get(name))]
    for process in processes:
        process.stop((_FAREWELL_S / 2, _FAREWELL_S / 4))
    for process in processes:
        process.wait(_FAREWELL_S)
        process.close()
