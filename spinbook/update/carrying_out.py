"""Does what was planned: first a backup, then every file, whole or not at all, and last what was handed out."""

from __future__ import annotations

import shutil
from datetime import datetime
from pathlib import Path

from spinbook.update.plan import Plan
from spinbook.written import write_if_changed

BACKUPS = "backups"


def carry_out(plan: Plan, folder: Path) -> Path | None:
    """Write everything. Returns the folder with a copy of each file that is replaced, None where none is.

    If it breaks off, the same update can be done again: what was handed out is remembered last. Raises `OSError`.
    """
    replaced = [place for place in plan.writes if (folder / place).exists()]
    backup = _new_backup(folder) if replaced else None
    for place in replaced:
        assert backup
        (backup / place).parent.mkdir(parents=True, exist_ok=True)
        shutil.copy2(folder / place, backup / place)
    for place, data in (*plan.writes.items(), *plan.base.items()):
        write_if_changed(folder / place, data)
    for place in plan.forgotten:
        (folder / place).unlink(missing_ok=True)
    return backup


def _new_backup(folder: Path) -> Path:
    stamp = datetime.now().strftime("%Y-%m-%d-%H%M%S")
    number = 1
    while True:
        backup = folder / BACKUPS / (stamp if number == 1 else f"{stamp}-{number}")
        try:
            backup.mkdir(parents=True)
            return backup
        except FileExistsError:
            number += 1
