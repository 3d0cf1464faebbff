"""The file of the notebook that a kernel belongs to, where the front end says."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import Any

#: Set in the kernel's environment by Jupyter's server: the notebook's path.
JUPYTER = "JPY_SESSION_NAME"
#: Set among the kernel's variables by VS Code: the notebook's path.
VS_CODE = "__vsc_ipynb_file__"


def notebook_file(variables: Mapping[str, Any], environment: Mapping[str, str]) -> Path | None:
    """The notebook's file as it was last saved, or None where that is not known (Colab, a plain terminal)."""
    for given in (variables.get(VS_CODE), environment.get(JUPYTER)):
        if isinstance(given, str) and given.endswith(".ipynb") and Path(given).is_file():
            return Path(given).resolve()
    return None
