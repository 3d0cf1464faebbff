"""What the modules of the site import is installed with its extra, and that of the notebooks that it shows."""

from __future__ import annotations

import re
import sys
from importlib.metadata import packages_distributions
from pathlib import Path

from packaging.requirements import Requirement
from packaging.utils import canonicalize_name

if sys.version_info >= (3, 11):
    import tomllib
else:
    import tomli as tomllib

ROOT = Path(__file__).parents[3]
#: Sphinx cannot do without these.
OF_SPHINX = {"docutils", "pygments"}


def test_each_package_that_the_site_imports_is_declared() -> None:
    project = tomllib.loads((ROOT / "pyproject.toml").read_text())["project"]
    extras = project["optional-dependencies"]
    requirements = [*project["dependencies"], *extras["site"], *extras["notebooks"]]
    declared = {canonicalize_name(Requirement(line).name) for line in requirements}
    code = "\n".join(file.read_text() for file in (ROOT / "spinbook" / "site").rglob("*.py"))
    modules = set(re.findall(r"^\s*(?:from|import) (\w+)", code, re.MULTILINE)) - sys.stdlib_module_names
    installed = packages_distributions()
    packages = {canonicalize_name(name) for module in modules for name in installed.get(module, ())}

    assert "pillow" in packages
    assert packages - declared - OF_SPHINX - {"spinbook"} == set()
